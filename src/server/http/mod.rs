//! The HTTP interface: routes, conditional downloads, event streams, problem documents.
//!
//! Invariant: `http` holds no logic that [`crate::server::service`] could hold; it translates. Every call into the service
//! runs on a blocking thread, so a slow disk never holds up another connection.

mod conditional;
mod error;
mod events;
mod extract;
mod jobs;
mod operations;
mod pictures;
mod problem;
mod range;
mod routes;
mod tables;
mod views;

use std::{future::Future, io, sync::Arc, time::Duration};

use axum::{Router, extract::DefaultBodyLimit};
use tokio::{net::TcpListener, sync::watch};
use tower_http::trace::{DefaultMakeSpan, DefaultOnResponse, TraceLayer};
use tracing::Level;

pub use routes::{ROUTES, Route};

use crate::server::service::Service;
use problem::Problem;

/// Longest request body. A recipe takes less than one kilobyte.
pub const BODY_LIMIT_BYTES: usize = 64 * 1024;

/// How long responses under way may take to finish once the service is told to stop.
const DRAIN: Duration = Duration::from_secs(10);

/// What the handlers share.
#[derive(Debug, Clone)]
struct Api {
    service: Arc<Service>,
    /// Becomes true when the server stops: open event streams end then.
    stopping: watch::Receiver<bool>,
}

impl Api {
    /// Runs a call into the service on a blocking thread.
    async fn call<T, E>(&self, use_case: impl FnOnce(&Service) -> Result<T, E> + Send + 'static) -> Result<T, Problem>
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

/// Answers requests on `listener` until `shutdown` resolves; then takes no more, ends event streams, lets the
/// responses under way finish within ten seconds and returns.
///
/// # Errors
/// When the listener fails.
pub async fn serve(
    listener: TcpListener,
    service: Arc<Service>,
    shutdown: impl Future<Output = ()> + Send + 'static,
) -> io::Result<()> {
    let (stop, stopping) = watch::channel(false);
    let mut stopped = stopping.clone();
    let app = router(Api { service, stopping });
    let server = axum::serve(listener, app).with_graceful_shutdown(async move {
        shutdown.await;
        stop.send_replace(true);
    });
    let drained = async move {
        // The sender lives in the server's own future, so an error means that the server is gone already.
        let _ = stopped.wait_for(|stopping| *stopping).await;
        tokio::time::sleep(DRAIN).await;
    };
    tokio::select! {
        served = server => served,
        () = drained => {
            tracing::warn!("connections still open after {DRAIN:?} were cut");
            Ok(())
        }
    }
}

fn router(api: Api) -> Router {
    let trace = TraceLayer::new_for_http()
        .make_span_with(DefaultMakeSpan::new().level(Level::INFO))
        .on_response(DefaultOnResponse::new().level(Level::INFO));
    routes::router()
        .fallback(routes::no_such_path)
        .layer(DefaultBodyLimit::max(BODY_LIMIT_BYTES))
        .layer(trace)
        .with_state(api)
}
