//! Serving until a shutdown.

use std::{future::Future, io, num::NonZeroU32, sync::Arc};

use axum::{
    Router,
    extract::{DefaultBodyLimit, Request, State},
    middleware::{Next, from_fn, from_fn_with_state},
    response::Response,
};
use tokio::{
    net::TcpListener,
    sync::{Semaphore, watch},
};
use tower_http::trace::{DefaultOnFailure, DefaultOnResponse, TraceLayer};
use tracing::Level;

use super::{
    access::{self, Access, Rates, WatchedTokens},
    api::{Api, ApiState, READS},
    certificates::Certificates,
    conditional, connection,
    extract::{BODY_LIMIT_BYTES, UPLOADS},
    limits::ConnectionLimits,
    origin_policy::{self, OriginPolicy},
    request_id::{self, NamedSpan},
    routes, security_fields, seen,
};
use crate::service::Service;

/// Settings of the HTTP interface.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// The limits of connections.
    pub limits: ConnectionLimits,
    /// Names and origins that are served beyond the service's own.
    pub origins: OriginPolicy,
    /// Who may call; without a token, anyone.
    pub tokens: Arc<WatchedTokens>,
    /// Requests a second of each token, and of each address without one; `None` for any number.
    pub requests_per_second: Option<NonZeroU32>,
    /// Whether clients that download a table are sent to the store of blobs, where it gives URLs for that.
    pub redirects: bool,
    /// The certificate by which it speaks TLS; `None` for bare HTTP.
    pub certificates: Option<Arc<Certificates>>,
    /// Whether only operators are answered: health, readiness, metrics and version.
    pub only_operations: bool,
}

/// Serves requests on `listener` until `shutdown` resolves. Then it accepts no more, ends event streams, gives open
/// responses the time of [`ConnectionLimits::drain`] to finish, and returns.
///
/// # Errors
/// When TLS cannot be spoken; nothing was served then.
pub async fn serve(
    listener: TcpListener,
    service: Arc<Service>,
    options: Options,
    shutdown: impl Future<Output = ()> + Send,
) -> io::Result<()> {
    let (stop, stopping) = watch::channel(false);
    let limits = Arc::new(options.limits);
    let api = ApiState {
        service,
        limits: Arc::clone(&limits),
        stopping: stopping.clone(),
        uploads: Arc::new(Semaphore::new(UPLOADS)),
        reads: Arc::new(Semaphore::new(READS)),
        redirects: options.redirects,
    };
    let tls = options.certificates.as_ref().map(Certificates::acceptor).transpose()?;
    let tokens = seen::watch(Arc::clone(&options.tokens) as _, stopping.clone());
    let certificates = async {
        if let Some(certificates) = options.certificates {
            seen::watch(certificates, stopping.clone()).await;
        }
    };
    let access = Access { tokens: options.tokens, rates: options.requests_per_second.map(Rates::new) };
    let served = connection::serve(
        listener,
        router(api.into(), options.only_operations, options.origins, access),
        tls,
        limits,
        stopping.clone(),
    );
    let stopped = async {
        shutdown.await;
        stop.send_replace(true);
    };
    tokio::join!(served, stopped, tokens, certificates);
    Ok(())
}

/// The routes with the layers that every request passes. A line for each request is logged at level `debug`: at the
/// default level the log tells of the service, not of its clients.
fn router(api: Api, only_operations: bool, origins: OriginPolicy, access: Access) -> Router {
    let trace = TraceLayer::new_for_http()
        .make_span_with(NamedSpan)
        .on_response(DefaultOnResponse::new().level(Level::DEBUG))
        .on_failure(DefaultOnFailure::new().level(Level::DEBUG));
    routes::router(only_operations)
        .fallback(routes::no_such_path)
        .layer(DefaultBodyLimit::max(BODY_LIMIT_BYTES))
        .layer(from_fn_with_state(Arc::new(Doors { origins, access }), pass))
        .layer(trace)
        .layer(from_fn(request_id::name))
        .with_state(api)
}

/// The doors that a request passes before its route: they may refuse it.
#[derive(Debug)]
struct Doors {
    origins: OriginPolicy,
    access: Access,
}

/// The layer of all doors, from the outermost to the innermost. For each request, a layer of axum clones whatever is within it, so
/// that one for each door would clone the routes as often.
async fn pass(State(doors): State<Arc<Doors>>, request: Request, next: Next) -> Response {
    let Doors { origins, access } = &*doors;
    let matched = |request| conditional::require_if_match(request, |request| next.run(request));
    let admitted = |request| access::check(access, request, matched);
    let addressed = |request| origin_policy::check(origins, request, admitted);
    security_fields::add(origins, request, addressed).await
}
