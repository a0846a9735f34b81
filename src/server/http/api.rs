//! What the handlers share.

use std::sync::Arc;

use tokio::sync::watch;

use super::{error, limits::ConnectionLimits, problem::Problem};
use crate::server::service::Service;

/// The state of the router.
#[derive(Debug, Clone)]
pub(super) struct Api {
    pub(super) service: Arc<Service>,
    pub(super) limits: Arc<ConnectionLimits>,
    /// Becomes true when the server stops; open event streams then end.
    pub(super) stopping: watch::Receiver<bool>,
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
        match tokio::task::spawn_blocking(move || use_case(&service)).await {
            Ok(result) => result.map_err(Into::into),
            Err(panicked) => Err(error::internal(&panicked)),
        }
    }
}
