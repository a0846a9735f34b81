//! Opening the queue.

use std::{fmt, sync::Arc, thread};

use super::{
    listen,
    shared::{Process, Shared},
};
use crate::{
    queue::Limits,
    store::{Database, StoreError},
};

/// Jobs that any number of processes share.
pub struct PostgresQueue {
    pub(super) shared: Arc<Shared>,
    tasks: Vec<tokio::task::JoinHandle<()>>,
}

impl fmt::Debug for PostgresQueue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PostgresQueue").field("database", &self.shared.database).finish_non_exhaustive()
    }
}

impl Drop for PostgresQueue {
    fn drop(&mut self) {
        self.tasks.iter().for_each(tokio::task::JoinHandle::abort);
        self.shared.end();
    }
}

impl PostgresQueue {
    /// The queue in `database`.
    ///
    /// # Errors
    /// When the database fails.
    pub fn open(database: Arc<Database>, limits: Limits, process: Process) -> Result<Self, StoreError> {
        let mut queue = Self { shared: Arc::new(Shared::new(database, limits, process, false)), tasks: vec![] };
        let runtime = queue.shared.database.runtime();
        let (listening, renewing) = (Arc::clone(&queue.shared), Arc::clone(&queue.shared));
        let tasks = vec![runtime.spawn(async move { listen::listen(&listening).await })];
        queue.tasks = tasks;
        let renewer = thread::Builder::new().name("renew".to_owned()).spawn(move || renewing.renew_for_ever());
        renewer.map_err(|error| StoreError::Unavailable(format!("no thread for renewing leases: {error}")))?;
        queue.shared.keep_house();
        Ok(queue)
    }

    /// As [`Self::open`], for a database whose clock a test sets.
    #[cfg(test)]
    pub(in crate::queue) fn open_eager(database: Arc<Database>, limits: Limits) -> Self {
        let process = Process { name: "test".to_owned(), fitter: 1 };
        let shared = Arc::new(Shared::new(database, limits, process, true));
        shared.keep_house();
        Self { shared, tasks: vec![] }
    }
}
