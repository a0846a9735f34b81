//! Connections: accepted up to the limits, served under time limits, drained at the end.
//!
//! Invariant: no client keeps a connection by doing nothing. Each wait for a client has a time limit, but for the next
//! event of a stream, which does not depend on the client.

mod open;
mod raw;
mod stream;
#[cfg(test)]
mod tests;

use std::{
    io,
    net::SocketAddr,
    sync::Arc,
    time::{Duration, Instant},
};

use axum::{Router, extract::Request};
use hyper::{body::Incoming, server::conn::http1, service::Service};
use hyper_util::{
    rt::{TokioIo, TokioTimer},
    service::TowerToHyperService,
};
use tokio::{
    io::{AsyncReadExt as _, AsyncWriteExt as _},
    net::{TcpListener, TcpStream},
    sync::{Semaphore, watch},
    task::JoinSet,
    time::{sleep, timeout},
};

use self::{
    open::{Admitted, OpenConnections, TooMany},
    stream::ClientStream,
};
use super::{
    extract::slow,
    kind::ProblemKind,
    limits::{ConnectionLimits, HEAD_LIMIT_BYTES},
    problem::Problem,
};

/// Connections beyond the limits that are told so at the same time; others are closed without an answer.
const REFUSALS: usize = 16;

/// How long the service goes on reading after its last answer, so that the client gets to read it: a TCP connection
/// that is closed with unread bytes is reset, and the answer lost.
const LINGER: Duration = Duration::from_secs(1);

/// Bytes that it reads then.
const LINGER_BYTES: usize = 4 * 1024 * 1024;

/// How long nothing is accepted after an error such as the lack of a file descriptor.
const ACCEPT_PAUSE: Duration = Duration::from_millis(100);

/// How often the log may say that connections are refused.
const WARNING_INTERVAL: Duration = Duration::from_secs(60);

/// The address at which a client has reached the service.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct LocalAddress(pub(super) SocketAddr);

/// Serves `app` on `listener` until `stopping` becomes true, then gives open answers the time of `limits.drain`.
pub(super) async fn serve(
    listener: TcpListener,
    app: Router,
    limits: Arc<ConnectionLimits>,
    stopping: watch::Receiver<bool>,
) {
    let open = OpenConnections::new(&limits);
    let refusals = Arc::new(Semaphore::new(REFUSALS));
    let mut warnings = Warnings::default();
    let mut tasks = JoinSet::new();
    loop {
        let accepted = tokio::select! {
            accepted = listener.accept() => accepted,
            () = stopped(stopping.clone()) => break,
            Some(_) = tasks.join_next() => continue,
        };
        let (tcp, remote) = match accepted {
            Ok(accepted) => accepted,
            Err(error) => {
                after_accept_error(&error, &mut warnings).await;
                continue;
            }
        };
        match open.admit(remote.ip()) {
            Ok(admitted) => {
                let connection = Connection { admitted, app: app.clone(), limits: Arc::clone(&limits) };
                tasks.spawn(connection.run(tcp, stopping.clone()));
            }
            Err(too_many) => {
                warnings.warn(&format!("connections are refused: {too_many:?}"));
                if let Ok(permit) = Arc::clone(&refusals).try_acquire_owned() {
                    tasks.spawn(async move {
                        refuse(tcp, too_many).await;
                        drop(permit);
                    });
                }
            }
        }
    }
    drop(listener);
    let drained = timeout(limits.drain, async { while tasks.join_next().await.is_some() {} }).await;
    if drained.is_err() {
        tracing::warn!("connections still open after {:?} were closed", limits.drain);
    }
}

/// Resolves when the service is told to stop, or when nobody is left to tell it.
async fn stopped(mut stopping: watch::Receiver<bool>) {
    let _ = stopping.wait_for(|stopping| *stopping).await;
}

/// A client that has gone again is its own affair. Any other error, such as a lack of file descriptors, lasts a while.
async fn after_accept_error(error: &io::Error, warnings: &mut Warnings) {
    let is_of_client = matches!(
        error.kind(),
        io::ErrorKind::ConnectionAborted | io::ErrorKind::ConnectionRefused | io::ErrorKind::ConnectionReset
    );
    if !is_of_client {
        warnings.warn(&format!("a connection cannot be accepted: {error}"));
        sleep(ACCEPT_PAUSE).await;
    }
}

/// Warnings that clients cause, so that a flood of them does not become a flood in the log.
#[derive(Debug, Default)]
struct Warnings {
    last: Option<Instant>,
}

impl Warnings {
    fn warn(&mut self, text: &str) {
        if self.last.is_none_or(|last| last.elapsed() >= WARNING_INTERVAL) {
            self.last = Some(Instant::now());
            tracing::warn!("{text}; no more is said of this for {WARNING_INTERVAL:?}");
        }
    }
}

/// What one connection needs.
struct Connection {
    admitted: Admitted,
    app: Router,
    limits: Arc<ConnectionLimits>,
}

impl Connection {
    /// Serves requests until the client or the service ends the connection.
    async fn run(self, tcp: TcpStream, stopping: watch::Receiver<bool>) {
        let Self { admitted, app, limits } = self;
        let Ok(local) = tcp.local_addr() else { return };
        // Answers are written whole, so there is nothing to gather. A socket that refuses still works.
        let _ = tcp.set_nodelay(true);
        let mut builder = http1::Builder::new();
        builder.timer(TokioTimer::new()).header_read_timeout(limits.head);
        // The buffer may grow a little beyond its limit; the head may not.
        builder.max_buf_size(HEAD_LIMIT_BYTES).max_header_size(HEAD_LIMIT_BYTES);
        let service = WithAddress { app: TowerToHyperService::new(app), local: LocalAddress(local) };
        let stream = TokioIo::new(ClientStream::new(tcp, limits.stall));
        let mut connection = builder.serve_connection(stream, service);
        let ended = tokio::select! {
            ended = &mut connection => ended,
            () = stopped(stopping.clone()) => {
                std::pin::Pin::new(&mut connection).graceful_shutdown();
                (&mut connection).await
            }
        };
        let http1::Parts { io, read_buf, .. } = connection.into_parts();
        let tcp = io.into_inner().into_tcp();
        tokio::select! {
            () = close(tcp, ended, !read_buf.is_empty(), limits.head) => {}
            () = stopped(stopping) => {}
        }
        drop(admitted);
    }
}

/// Ends a connection so that the client gets to read the last answer, if there is one.
async fn close(tcp: TcpStream, ended: hyper::Result<()>, has_begun_head: bool, limit: Duration) {
    match ended {
        Ok(()) => linger(tcp).await,
        Err(error) if error.is_timeout() && has_begun_head => {
            tell(tcp, Problem::new(ProblemKind::SlowRequest, slow("head", limit))).await;
        }
        Err(error) if error.is_parse_version_h2() => {
            let detail = "the connection begins with the preface of HTTP/2, and the service speaks HTTP/1.1";
            tell(tcp, Problem::new(ProblemKind::BadRequest, detail)).await;
        }
        Err(error) if error.is_parse() => linger(tcp).await,
        Err(error) => tracing::debug!("a connection was given up: {error}"),
    }
}

/// Tells a client why its connection is not served.
async fn refuse(tcp: TcpStream, too_many: TooMany) {
    tell(tcp, too_many.into()).await;
}

async fn tell(mut tcp: TcpStream, problem: Problem) {
    let told = timeout(LINGER, async {
        tcp.write_all(&raw::answer(problem)).await?;
        tcp.shutdown().await
    });
    if let Ok(Ok(())) = told.await {
        linger(tcp).await;
    }
}

/// Reads until the client closes its side too, within bounds.
async fn linger(mut tcp: TcpStream) {
    let read = async {
        let mut sink = vec![0; 16 * 1024];
        let mut total = 0;
        while total < LINGER_BYTES {
            match tcp.read(&mut sink).await {
                Ok(0) | Err(_) => return,
                Ok(read) => total += read,
            }
        }
    };
    // Whether or not the client has closed its side: this was the last that is done for it.
    let _ = timeout(LINGER, read).await;
}

/// Hands each request to the router, with the address at which it arrived.
struct WithAddress {
    app: TowerToHyperService<Router>,
    local: LocalAddress,
}

impl Service<Request<Incoming>> for WithAddress {
    type Response = <TowerToHyperService<Router> as Service<Request<Incoming>>>::Response;
    type Error = <TowerToHyperService<Router> as Service<Request<Incoming>>>::Error;
    type Future = <TowerToHyperService<Router> as Service<Request<Incoming>>>::Future;

    fn call(&self, mut request: Request<Incoming>) -> Self::Future {
        request.extensions_mut().insert(self.local);
        self.app.call(request)
    }
}
