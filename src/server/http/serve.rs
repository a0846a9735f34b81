//! Serves requests until shutdown.

use std::{future::Future, io, net::SocketAddr, sync::Arc, time::Duration};

use axum::{Router, middleware::from_fn_with_state};
use axum_server::{Handle, Server, accept::NoDelayAcceptor, tls_rustls::RustlsAcceptor};
use hyper_util::rt::TokioTimer;
use tokio::{
    net::TcpListener,
    sync::{Semaphore, watch},
    time::timeout,
};

use super::{
    api::{Api, ApiState, EVENT_STREAMS, READS, UPLOADS},
    doors::{self, Doors},
    origins::Origins,
    routes,
    tls::Certificate,
    tokens::TokenFile,
};
use crate::service::Service;

/// Maximum size of a request's head: request line and header fields.
const HEAD_LIMIT_BYTES: usize = 128 << 10;

/// Time for open responses to finish once the service stops.
const DRAIN: Duration = Duration::from_secs(10);

/// Interval between checks whether the token, certificate and key files have changed.
const LOOK: Duration = Duration::from_secs(1);

/// Settings of the HTTP interface.
#[derive(Debug, Clone)]
pub struct Options {
    /// Maximum number of concurrent requests, not counting event streams.
    pub requests: usize,
    /// Time limit for the head of a request, and for its body.
    pub client: Duration,
    /// Allowed host names and origins in addition to the service's own.
    pub origins: Origins,
    /// The tokens of callers. Without tokens, anyone may call.
    pub tokens: Arc<TokenFile>,
    /// The certificate for TLS; `None` for HTTP.
    pub certificate: Option<Arc<Certificate>>,
    /// Whether only the paths for operators are served: health, readiness, metrics and version.
    pub only_operations: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            requests: 256,
            client: Duration::from_secs(30),
            origins: Origins::default(),
            tokens: Arc::default(),
            certificate: None,
            only_operations: false,
        }
    }
}

/// Serves requests on `listener` until `shutdown` resolves. Then it accepts no more connections, ends event streams,
/// waits up to [`DRAIN`] for open responses, and returns.
///
/// # Errors
/// When the listener fails.
pub async fn serve(
    listener: TcpListener,
    service: Arc<Service>,
    options: Options,
    shutdown: impl Future<Output = ()> + Send,
) -> io::Result<()> {
    let (stop, mut stopping) = watch::channel(false);
    let Options { requests, client, origins, tokens, certificate, only_operations } = options;
    let api = Api::from(ApiState {
        service,
        client,
        tokens: Arc::clone(&tokens),
        stopping: stopping.clone(),
        uploads: Arc::new(Semaphore::new(UPLOADS)),
        reads: Arc::new(Semaphore::new(READS)),
        streams: Arc::new(Semaphore::new(EVENT_STREAMS)),
    });
    let doors = Doors { origins, tokens: Arc::clone(&tokens), requests: Semaphore::new(requests), limit: requests };
    let app = router(api, only_operations, doors).into_make_service();
    let handle = Handle::<SocketAddr>::new();
    let mut server = Server::<SocketAddr>::from_listener(listener).handle(handle.clone()).http1_only();
    let mut http = server.http_builder().http1();
    http.timer(TokioTimer::new()).header_read_timeout(client).max_buf_size(HEAD_LIMIT_BYTES);
    let served = async {
        match &certificate {
            None => server.acceptor(NoDelayAcceptor::new()).serve(app).await,
            Some(certificate) => {
                let tls = RustlsAcceptor::new(certificate.config.clone()).acceptor(NoDelayAcceptor::new());
                server.acceptor(tls).serve(app).await
            }
        }
    };
    let stopped = async {
        shutdown.await;
        stop.send_replace(true);
        handle.graceful_shutdown(Some(DRAIN));
    };
    let look = async {
        while timeout(LOOK, stopping.wait_for(|stopping| *stopping)).await.is_err() {
            let (tokens, certificate) = (Arc::clone(&tokens), certificate.clone());
            let look = move || {
                tokens.look();
                if let Some(certificate) = &certificate {
                    certificate.look();
                }
            };
            // If this check fails, the next one follows anyway.
            let _ = tokio::task::spawn_blocking(look).await;
        }
    };
    tokio::join!(served, stopped, look).0
}

fn router(api: Api, only_operations: bool, doors: Doors) -> Router {
    routes::router(only_operations)
        .fallback(routes::no_such_path)
        .layer(from_fn_with_state(Arc::new(doors), doors::pass))
        .with_state(api)
}
