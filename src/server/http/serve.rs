//! Serving until a shutdown.

use std::{future::Future, io, sync::Arc, time::Duration};

use axum::{Router, extract::DefaultBodyLimit};
use tokio::{net::TcpListener, sync::watch};
use tower_http::trace::{DefaultMakeSpan, DefaultOnResponse, TraceLayer};
use tracing::Level;

use super::{api::Api, extract::BODY_LIMIT_BYTES, routes};
use crate::server::service::Service;

/// How long open responses may take to finish once the service is told to stop.
const DRAIN: Duration = Duration::from_secs(10);

/// Serves requests on `listener` until `shutdown` resolves. Then it accepts no more, ends event streams, gives open
/// responses ten seconds to finish, and returns.
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
        // The sender lives in the server's future, so an error means that the server has ended already.
        let _ = stopped.wait_for(|stopping| *stopping).await;
        tokio::time::sleep(DRAIN).await;
    };
    tokio::select! {
        served = server => served,
        () = drained => {
            tracing::warn!("connections still open after {DRAIN:?} were closed");
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
