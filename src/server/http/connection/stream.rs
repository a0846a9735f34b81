//! The bytes of a connection: a client that does not read is given up, and an answer of hyper's own becomes a problem
//! document.

use std::{
    io::{self, IoSlice},
    pin::Pin,
    task::{Context, Poll, ready},
    time::Duration,
};

use tokio::{
    io::{AsyncRead, AsyncWrite, ReadBuf},
    net::TcpStream,
    time::{Instant, Sleep, sleep},
};

use super::raw;

/// Bytes that a client has to read within the time limit. Fewer count as none: a client that reads a byte now and then
/// would otherwise keep its connection for ever.
const STEP_BYTES: usize = 16 * 1024;

/// A client's TCP stream under a time limit for writing.
#[derive(Debug)]
pub(super) struct ClientStream {
    tcp: TcpStream,
    stall: Stall,
    /// What is still to be written in place of an answer of hyper's own.
    replacement: Option<Vec<u8>>,
}

/// The watch over a client that does not read.
#[derive(Debug)]
struct Stall {
    limit: Duration,
    timer: Option<Pin<Box<Sleep>>>,
    is_running: bool,
    /// Bytes written since it runs.
    written: usize,
}

impl ClientStream {
    /// A stream that fails once the client has read too little for as long as `limit`.
    pub(super) fn new(tcp: TcpStream, limit: Duration) -> Self {
        let stall = Stall { limit, timer: None, is_running: false, written: 0 };
        Self { tcp, stall, replacement: None }
    }

    /// The bare stream.
    pub(super) fn into_tcp(self) -> TcpStream {
        self.tcp
    }

    /// Writes what replaces an answer of `length` bytes; these then count as written.
    fn poll_replacement(&mut self, cx: &mut Context<'_>, length: usize) -> Poll<io::Result<usize>> {
        while let Some(rest) = self.replacement.as_mut().filter(|rest| !rest.is_empty()) {
            let wrote = Pin::new(&mut self.tcp).poll_write(cx, rest);
            match ready!(self.stall.watch(cx, wrote, rest.len()))? {
                0 => return Poll::Ready(Err(io::ErrorKind::WriteZero.into())),
                written => drop(rest.drain(..written)),
            }
        }
        self.replacement = None;
        Poll::Ready(Ok(length))
    }
}

impl Stall {
    /// Passes on the outcome of a write of `offered` bytes, or the error that the client has read too little.
    fn watch(
        &mut self,
        cx: &mut Context<'_>,
        wrote: Poll<io::Result<usize>>,
        offered: usize,
    ) -> Poll<io::Result<usize>> {
        match &wrote {
            Poll::Ready(Ok(written)) => {
                self.written += written;
                if *written == offered || self.written >= STEP_BYTES {
                    self.is_running = false;
                }
                wrote
            }
            Poll::Ready(Err(_)) => wrote,
            Poll::Pending if self.poll_timer(cx).is_ready() => {
                tracing::debug!("a client did not read its answer within {:?}", self.limit);
                Poll::Ready(Err(io::Error::new(io::ErrorKind::TimedOut, "the client does not read")))
            }
            Poll::Pending => Poll::Pending,
        }
    }

    fn poll_timer(&mut self, cx: &mut Context<'_>) -> Poll<()> {
        let limit = self.limit;
        let timer = self.timer.get_or_insert_with(|| Box::pin(sleep(limit)));
        if !self.is_running {
            self.is_running = true;
            self.written = 0;
            timer.as_mut().reset(Instant::now() + limit);
        }
        timer.as_mut().poll(cx)
    }
}

impl AsyncRead for ClientStream {
    fn poll_read(mut self: Pin<&mut Self>, cx: &mut Context<'_>, buf: &mut ReadBuf<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.tcp).poll_read(cx, buf)
    }
}

impl AsyncWrite for ClientStream {
    fn poll_write(self: Pin<&mut Self>, cx: &mut Context<'_>, buf: &[u8]) -> Poll<io::Result<usize>> {
        self.poll_write_vectored(cx, &[IoSlice::new(buf)])
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        bufs: &[IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        let this = &mut *self;
        let offered = bufs.iter().map(|buf| buf.len()).sum();
        if this.replacement.is_none()
            && let [answer] = bufs
        {
            this.replacement = raw::in_place_of(answer);
        }
        if this.replacement.is_some() {
            return this.poll_replacement(cx, offered);
        }
        let wrote = Pin::new(&mut this.tcp).poll_write_vectored(cx, bufs);
        this.stall.watch(cx, wrote, offered)
    }

    fn is_write_vectored(&self) -> bool {
        self.tcp.is_write_vectored()
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.tcp).poll_flush(cx)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.tcp).poll_shutdown(cx)
    }
}
