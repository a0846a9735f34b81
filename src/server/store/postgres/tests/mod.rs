//! Databases of tests.

use std::sync::Arc;

use super::Database;

pub(crate) mod throwaway;

/// An empty database with the current schema; `None`, with a message, where PostgreSQL is not installed.
pub(crate) fn database() -> Option<Arc<Database>> {
    Some(Database::open(&throwaway::empty_database()?).unwrap())
}
