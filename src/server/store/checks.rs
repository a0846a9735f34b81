//! What is checked each time the database is opened again while the process runs.

use std::sync::{Arc, Mutex, PoisonError};

use super::{Rows, StoreError};

type Check = Box<dyn Fn(&Arc<dyn Rows>) -> Result<(), StoreError> + Send + Sync>;

/// Checks of a database that was closed by a write error and opened again. Nobody else reads it before they are through,
/// and if one fails it stays closed.
#[derive(Clone, Default)]
pub struct Checks(Arc<Mutex<Vec<Check>>>);

impl std::fmt::Debug for Checks {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Checks").finish_non_exhaustive()
    }
}

impl Checks {
    /// Adds a check, which may mend the rows. It must not keep them.
    pub fn add(&self, check: impl Fn(&Arc<dyn Rows>) -> Result<(), StoreError> + Send + Sync + 'static) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(Box::new(check));
    }

    /// Runs all checks, in the order in which they were added.
    ///
    /// # Errors
    /// The first error of a check.
    pub fn run(&self, rows: &Arc<dyn Rows>) -> Result<(), StoreError> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).iter().try_for_each(|check| check(rows))
    }
}
