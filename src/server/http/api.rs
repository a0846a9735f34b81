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

/// Maximum number of files that are read at the same time. A table can take 100 MB.
pub(super) const READS: usize = 4;
/// Maximum number of scenes and BRDFs that are received and decoded at the same time.
pub(super) const UPLOADS: usize = 2;
/// Maximum number of open event streams.
pub(super) const EVENT_STREAMS: usize = 1024;

/// The state of the router. Each request clones it several times.
#[derive(Debug, Clone)]
pub(super) struct Api(Arc<ApiState>);

/// The shared state.
#[derive(Debug)]
pub(super) struct ApiState {
    pub(super) service: Arc<Service>,
    /// Time limit for the body of a request.
    pub(super) client: Duration,
    pub(super) tokens: Arc<TokenFile>,
    /// Becomes true when the server stops. Open event streams then end.
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
    /// Like [`Self::call`], for calls that read a whole file. At most [`READS`] of them run at the same time. A call
    /// stops waiting for its turn if its client disconnects.
    pub(super) async fn read<T, E>(
        &self,
        use_case: impl FnOnce(&Service) -> Result<T, E> + Send + 'static,
    ) -> Result<T, Problem>
    where
        T: Send + 'static,
        E: Into<Problem> + Send + 'static,
    {
        // The semaphore is never closed. The call keeps its permit until it ends, even if the client disconnects.
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
        // tokio panics if it has no blocking thread and the system cannot start one.
        let spawn = AssertUnwindSafe(|| tokio::task::spawn_blocking(move || use_case(&service)));
        let Ok(spawned) = catch_unwind(spawn) else {
            return Err(error::lacking("the machine cannot start another thread; try again later".to_owned()));
        };
        match spawned.await {
            Ok(result) => result.map_err(Into::into),
            Err(panicked) => Err(error::internal(&panicked)),
        }
    }
}
