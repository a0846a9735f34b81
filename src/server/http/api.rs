//! The state that the handlers share.

use std::{
    ops::Deref,
    panic::{AssertUnwindSafe, catch_unwind},
    sync::Arc,
};

use tokio::sync::{Semaphore, watch};

use super::{error, limits::ConnectionLimits, problem::Problem};
use crate::service::Service;

/// The state of the router. Each request clones it several times.
#[derive(Debug, Clone)]
pub(super) struct Api(Arc<ApiState>);

/// The state itself, of which there is one.
#[derive(Debug)]
pub(super) struct ApiState {
    pub(super) service: Arc<Service>,
    pub(super) limits: Arc<ConnectionLimits>,
    /// Becomes true when the server stops; open event streams then end.
    pub(super) stopping: watch::Receiver<bool>,
    /// Files of BRDFs that may be received at once.
    pub(super) uploads: Arc<Semaphore>,
    /// Files that may be read whole at once.
    pub(super) reads: Arc<Semaphore>,
    /// Whether downloads are answered with URLs of the store of blobs.
    pub(super) redirects: bool,
}

/// Files that are read whole at once. A table takes up to some 100 MB where it comes from a store elsewhere or is decoded.
pub(super) const READS: usize = 4;

impl Deref for Api {
    type Target = ApiState;

    fn deref(&self) -> &ApiState {
        &self.0
    }
}

impl From<ApiState> for Api {
    fn from(state: ApiState) -> Self {
        Self(Arc::new(state))
    }
}

impl Api {
    /// As [`Self::call`], for a call that reads a file whole: a few do at once, and a client that leaves ends its wait.
    pub(super) async fn read<T, E>(
        &self,
        use_case: impl FnOnce(&Service) -> Result<T, E> + Send + 'static,
    ) -> Result<T, Problem>
    where
        T: Send + 'static,
        E: Into<Problem> + Send + 'static,
    {
        // The semaphore is never closed. The call has its place until it ends, even if the client has left.
        let room = Arc::clone(&self.reads).acquire_owned().await.ok();
        let in_room = move |service: &Service| {
            let read = use_case(service);
            drop(room);
            read
        };
        self.call(in_room).await
    }

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
