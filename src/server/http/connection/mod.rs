//! Connections: accepted up to the limits, served under time limits, drained at the end.
//!
//! Invariant: no client keeps a connection by doing nothing. Each wait for a client has a time limit, but for the next
//! event of a stream, which does not depend on the client.

mod kernel_copy;
mod open;
mod raw;
mod stream;
#[cfg(test)]
mod tests;

use std::{
    convert::Infallible,
    io,
    net::{IpAddr, SocketAddr},
    sync::Arc,
    time::{Duration, Instant},
};

use axum::{Router, extract::Request};
use hyper::{
    body::Incoming,
    server::conn::http1,
    service::{Service as _, service_fn},
};
use hyper_util::{
    rt::{TokioIo, TokioTimer},
    service::TowerToHyperService,
};
use tokio::{
    io::{AsyncReadExt as _, AsyncWriteExt as _},
    net::{TcpListener, TcpStream},
    sync::watch,
    task::JoinSet,
    time::{sleep, timeout},
};
use tokio_rustls::{TlsAcceptor, server::TlsStream};
use tokio_util::either::Either;

pub(super) use self::kernel_copy::LEAST_BYTES;
use self::{
    kernel_copy::{KernelCopies, Sending},
    open::{OpenConnections, Token, network},
    stream::ClientStream,
};
use super::{
    extract::slow,
    kind::ProblemKind,
    limits::{ConnectionLimits, HEAD_LIMIT_BYTES},
    problem::Problem,
};

/// Connections beyond the limits that are told so at the same time; further ones are closed without an answer.
const REFUSALS: usize = 16;

/// How long the service goes on reading after its last answer, so that the client gets to read it: closing a TCP
/// connection with unread bytes resets it, and the answer is lost.
const LINGER: Duration = Duration::from_secs(1);

/// The most bytes that it then reads.
const LINGER_BYTES: usize = 4 * 1024 * 1024;

/// Bytes that the system holds for a client without having sent them.
#[cfg(target_os = "linux")]
const UNSENT_BYTES: u32 = 128 * 1024;

/// How long nothing is accepted after an error such as the lack of a file descriptor.
const ACCEPT_PAUSE: Duration = Duration::from_millis(100);

/// How often the log may say that connections are refused.
const WARNING_INTERVAL: Duration = Duration::from_secs(60);

/// The address at which a client has reached the service.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct LocalAddress(pub(super) SocketAddr);

/// What is read from and written to: bare, or by TLS.
type Stream = Either<TcpStream, Box<TlsStream<TcpStream>>>;

/// The address that a client has, as connections from it are counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct RemoteAddress(pub(super) IpAddr);

/// Serves `app` on `listener` until `stopping` becomes true, then gives open answers the time of `limits.drain`.
pub(super) async fn serve(
    listener: TcpListener,
    app: Router,
    tls: Option<TlsAcceptor>,
    limits: Arc<ConnectionLimits>,
    stopping: watch::Receiver<bool>,
) {
    let mut open = OpenConnections::new(&limits);
    let copies = Arc::new(KernelCopies::default());
    let mut warnings = Warnings::default();
    let (mut tasks, mut refusals) = (JoinSet::new(), JoinSet::new());
    loop {
        let accepted = tokio::select! {
            accepted = listener.accept() => accepted,
            () = stopped(stopping.clone()) => break,
            Some(_) = tasks.join_next() => continue,
            Some(_) = refusals.join_next() => continue,
        };
        let (tcp, remote) = match accepted {
            Ok(accepted) => accepted,
            Err(error) => {
                after_accept_error(&error, &mut warnings).await;
                continue;
            }
        };
        match open.admit(remote.ip()) {
            Ok(token) => {
                let app = (app.clone(), Arc::clone(&copies));
                let served = connection(tcp, app, tls.clone(), Arc::clone(&limits), stopping.clone(), token);
                tasks.spawn(served);
            }
            Err(too_many) => {
                warnings.warn(&format!("connections are refused: {too_many:?}"));
                // A client of TLS could not read it.
                if tls.is_none() && refusals.len() < REFUSALS {
                    refusals.spawn(tell(Stream::Left(tcp), too_many.into()));
                }
            }
        }
    }
    drop(listener);
    let ended = async { while tasks.join_next().await.is_some() || refusals.join_next().await.is_some() {} };
    let drained = timeout(limits.drain, ended).await;
    if drained.is_err() {
        tracing::warn!("connections still open after {:?} were closed", limits.drain);
    }
}

/// Resolves when the service is told to stop, or when nobody is left to tell it.
async fn stopped(mut stopping: watch::Receiver<bool>) {
    let _ = stopping.wait_for(|stopping| *stopping).await;
}

/// Logs the error and waits, since a lack of file descriptors lasts a while; not for a client that has gone again.
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
            tracing::warn!("{text}; further ones are not logged for {WARNING_INTERVAL:?}");
        }
    }
}

/// Serves the requests of a connection until the client or the service ends it. It counts as open until then.
async fn connection(
    tcp: TcpStream,
    (app, copies): (Router, Arc<KernelCopies>),
    tls: Option<TlsAcceptor>,
    limits: Arc<ConnectionLimits>,
    stopping: watch::Receiver<bool>,
    token: Token,
) {
    let Ok(local) = tcp.local_addr().map(LocalAddress) else { return };
    let Ok(remote) = tcp.peer_addr().map(|address| RemoteAddress(network(address.ip()))) else { return };
    // Answers are written whole, so there is nothing to gather. A socket that refuses still works.
    let _ = tcp.set_nodelay(true);
    // Otherwise the system takes megabytes for a client and then nothing until it has read a third of them, as if a slow
    // one did not read.
    #[cfg(target_os = "linux")]
    let _ = socket2::SockRef::from(&tcp).set_tcp_notsent_lowat(UNSENT_BYTES);
    let Some(stream) = begun(tcp, tls, limits.client).await else { return };
    let mut builder = http1::Builder::new();
    builder.timer(TokioTimer::new()).header_read_timeout(limits.client);
    // The buffer may grow a little beyond its limit; the head may not.
    builder.max_buf_size(HEAD_LIMIT_BYTES).max_header_size(HEAD_LIMIT_BYTES);
    let app = TowerToHyperService::new(app);
    let sending = Sending::default();
    let begins = sending.clone();
    let service = service_fn(move |mut request: Request<Incoming>| {
        request.extensions_mut().insert(local);
        request.extensions_mut().insert(remote);
        let (answer, begins, copies) = (app.call(request), begins.clone(), Arc::clone(&copies));
        async move {
            let answer = answer.await?;
            begins.begin(&copies, answer.extensions());
            Ok::<_, Infallible>(answer)
        }
    });
    let stream = TokioIo::new(ClientStream::new(stream, limits.client, sending));
    let mut connection = builder.serve_connection(stream, service);
    let ended = tokio::select! {
        ended = &mut connection => ended,
        () = stopped(stopping.clone()) => {
            std::pin::Pin::new(&mut connection).graceful_shutdown();
            (&mut connection).await
        }
    };
    let http1::Parts { io, read_buf, .. } = connection.into_parts();
    let stream = io.into_inner().into_bare();
    tokio::select! {
        () = close(stream, ended, !read_buf.is_empty(), limits.client) => {}
        () = stopped(stopping) => {}
    }
    drop(token);
}

/// A connection once TLS has begun on it, where it does; `None` if the client did not begin it within `limit`.
async fn begun(tcp: TcpStream, tls: Option<TlsAcceptor>, limit: Duration) -> Option<Stream> {
    let Some(tls) = tls else { return Some(Stream::Left(tcp)) };
    match timeout(limit, tls.accept(tcp)).await {
        Ok(Ok(stream)) => Some(Stream::Right(Box::new(stream))),
        Ok(Err(error)) => {
            tracing::debug!("a connection did not begin TLS: {error}");
            None
        }
        Err(_) => {
            tracing::debug!("a connection did not begin TLS within {limit:?}");
            None
        }
    }
}

/// Ends a connection so that the client gets to read the last answer, if there is one.
async fn close(stream: Stream, ended: hyper::Result<()>, has_begun_head: bool, limit: Duration) {
    match ended {
        Ok(()) => linger(stream).await,
        Err(error) if error.is_timeout() && has_begun_head => {
            tell(stream, Problem::new(ProblemKind::SlowRequest, slow("head", limit))).await;
        }
        Err(error) if error.is_parse_version_h2() => {
            let detail = "the connection begins with the preface of HTTP/2, and the service speaks HTTP/1.1";
            tell(stream, Problem::new(ProblemKind::BadRequest, detail)).await;
        }
        Err(error) if error.is_parse() => linger(stream).await,
        Err(error) => tracing::debug!("a connection was given up: {error}"),
    }
}

/// Answers a connection that is not served, or no longer.
async fn tell(mut stream: Stream, problem: Problem) {
    let told = timeout(LINGER, async {
        stream.write_all(&raw::answer(&problem)).await?;
        stream.shutdown().await
    });
    if let Ok(Ok(())) = told.await {
        linger(stream).await;
    }
}

/// Reads until the client closes its side too, within bounds.
async fn linger(mut stream: Stream) {
    let read = async {
        let mut sink = vec![0; 16 * 1024];
        let mut total = 0;
        while total < LINGER_BYTES {
            match stream.read(&mut sink).await {
                Ok(0) | Err(_) => return,
                Ok(read) => total += read,
            }
        }
    };
    // The connection is closed after that, whether or not the client has closed its side.
    let _ = timeout(LINGER, read).await;
}
