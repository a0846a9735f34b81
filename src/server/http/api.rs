//! The state that the handlers share.

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    sync::Arc,
};

use tokio::sync::{Semaphore, watch};

use super::{error, limits::ConnectionLimits, problem::Problem};
use crate::service::Service;

/// The state of the router.
#[derive(Debug, Clone)]
pub(super) struct Api {
    pub(super) service: Arc<Service>,
    pub(super) limits: Arc<ConnectionLimits>,
    /// Becomes true when the server stops; open event streams then end.
    pub(super) stopping: watch::Receiver<bool>,
    /// Files of BRDFs that may be received at once.
    pub(super) uploads: Arc<Semaphore>,
    /// Whether downloads are answered with URLs of the store of blobs.
    pub(super) redirects: bool,
}

impl Api {
    /// Runs a call into the service on a blocking thread.
    pub(super) async fn call<T, E>(
        &self,
        use_case: impl FnOnce(&Service) -> Result<T, E> + Send + 'static,
    ) -> Result<T, Problem>
    where
        T: Send + 'static,
        E: Into<Problem> + Send + 'static,
    {
        let service = Arc::clone(&self.service);
        // tokio panics if it has no blocking thread at all and the system gives it none.
        let spawn = AssertUnwindSafe(|| tokio::task::spawn_blocking(move || use_case(&service)));
        let Ok(spawned) = catch_unwind(spawn) else {
            return Err(error::lacking("the machine has no thread to spare".to_owned()));
        };
        match spawned.await {
            Ok(result) => result.map_err(Into::into),
            Err(panicked) => Err(error::internal(&panicked)),
        }
    }
}
