//! Databases of tests.

use std::sync::Arc;

use super::{Database, throwaway};

/// An empty database with the current schema; `None`, told loudly, where PostgreSQL is not installed.
pub(crate) fn database() -> Option<Arc<Database>> {
    Some(Database::open(&throwaway::empty_database()?).unwrap())
}
