//! The state that the handlers share.

use std::{
    ops::Deref,
    panic::{AssertUnwindSafe, catch_unwind},
    sync::Arc,
    time::Duration,
};

use tokio::sync::{Semaphore, watch};

use super::{error, problem::Problem, tokens::TokenFile};
use crate::service::Service;

/// Files that are read whole at once. A table takes up to 100 MB.
pub(super) const READS: usize = 4;
/// Scenes and files of BRDFs that are received and decoded at once.
pub(super) const UPLOADS: usize = 2;
/// Event streams that may be open.
pub(super) const EVENT_STREAMS: usize = 1024;

/// The state of the router. Each request clones it several times.
#[derive(Debug, Clone)]
pub(super) struct Api(Arc<ApiState>);

/// The state itself.
#[derive(Debug)]
pub(super) struct ApiState {
    pub(super) service: Arc<Service>,
    /// How long a client may take for a body.
    pub(super) client: Duration,
    pub(super) tokens: Arc<TokenFile>,
    /// Becomes true when the server stops; open event streams then end.
    pub(super) stopping: watch::Receiver<bool>,
    pub(super) uploads: Arc<Semaphore>,
    pub(super) reads: Arc<Semaphore>,
    pub(super) streams: Arc<Semaphore>,
}

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
