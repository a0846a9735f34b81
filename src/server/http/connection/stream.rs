//! The bytes of a connection: a client that does not read is given up, and an answer of hyper's own becomes a problem
//! document.

use std::{
    io::{self, IoSlice},
    pin::Pin,
    task::{Context, Poll, ready},
    time::Duration,
};

use tokio::{
    io::{AsyncRead, AsyncWrite, Interest, ReadBuf},
    time::{Sleep, sleep},
};

use super::{super::limits::HEAD_LIMIT_BYTES, Stream, kernel_copy::Sending, raw};

/// A client's stream under a time limit for writing.
#[derive(Debug)]
pub(super) struct ClientStream {
    bare: Stream,
    limit: Duration,
    /// Runs while the system takes no more bytes for the client. It takes more only once a good part of those that it
    /// has were read, so a client cannot keep its connection by reading a byte now and then.
    stalled: Option<Pin<Box<Sleep>>>,
    /// What was read since the last answer, no longer than a head may be: hyper does not tell what it refuses of it.
    head: Vec<u8>,
    /// The unwritten rest of an answer that replaces one of hyper's own.
    replacement: Option<Vec<u8>>,
    /// The kernel's copy of the answer that is being written.
    sending: Sending,
}

impl ClientStream {
    /// A stream that fails once the client has read nothing for as long as `limit`.
    pub(super) fn new(bare: Stream, limit: Duration, sending: Sending) -> Self {
        Self { bare, limit, stalled: None, head: Vec::new(), replacement: None, sending }
    }

    /// The bare stream.
    pub(super) fn into_bare(self) -> Stream {
        self.bare
    }

    /// Passes on the outcome of a write, or the error that the client does not read.
    fn watch(&mut self, cx: &mut Context<'_>, wrote: Poll<io::Result<usize>>) -> Poll<io::Result<usize>> {
        if wrote.is_ready() {
            self.stalled = None;
            return wrote;
        }
        let limit = self.limit;
        ready!(self.stalled.get_or_insert_with(|| Box::pin(sleep(limit))).as_mut().poll(cx));
        tracing::debug!("a client did not read its answer within {limit:?}");
        Poll::Ready(Err(io::Error::new(io::ErrorKind::TimedOut, "the client does not read")))
    }

    /// Writes, from the kernel's copy where it has one.
    fn poll_write_bare(&mut self, cx: &mut Context<'_>, bufs: &[IoSlice<'_>]) -> Poll<io::Result<usize>> {
        // TLS encrypts the bytes before they are sent.
        if let Stream::Left(tcp) = &self.bare
            && let Some(plan) = self.sending.plan(bufs)
        {
            loop {
                ready!(tcp.poll_write_ready(cx))?;
                let wrote = tcp.try_io(Interest::WRITABLE, || plan.write(tcp));
                match wrote {
                    // The next look waits until the system takes more.
                    Err(error) if error.kind() == io::ErrorKind::WouldBlock => continue,
                    Ok(written) if plan.is_done_after(written) => self.sending.end(),
                    _ => {}
                }
                return Poll::Ready(wrote);
            }
        }
        Pin::new(&mut self.bare).poll_write_vectored(cx, bufs)
    }

    /// Writes the replacement of an answer of `length` bytes; these then count as written.
    fn poll_replacement(&mut self, cx: &mut Context<'_>, length: usize) -> Poll<io::Result<usize>> {
        while let Some(rest) = self.replacement.as_deref().filter(|rest| !rest.is_empty()) {
            let wrote = Pin::new(&mut self.bare).poll_write(cx, rest);
            match ready!(self.watch(cx, wrote))? {
                0 => return Poll::Ready(Err(io::ErrorKind::WriteZero.into())),
                written => self.replacement.iter_mut().for_each(|rest| drop(rest.drain(..written))),
            }
        }
        self.replacement = None;
        Poll::Ready(Ok(length))
    }
}

impl AsyncRead for ClientStream {
    fn poll_read(mut self: Pin<&mut Self>, cx: &mut Context<'_>, buf: &mut ReadBuf<'_>) -> Poll<io::Result<()>> {
        let before = buf.filled().len();
        ready!(Pin::new(&mut self.bare).poll_read(cx, buf))?;
        let (read, room) = (&buf.filled()[before..], HEAD_LIMIT_BYTES - self.head.len());
        self.head.extend_from_slice(&read[..read.len().min(room)]);
        Poll::Ready(Ok(()))
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
        if this.replacement.is_none()
            && let [answer] = bufs
        {
            this.replacement = raw::in_place_of(answer, &this.head);
        }
        this.head.clear();
        if this.replacement.is_some() {
            return this.poll_replacement(cx, bufs.iter().map(|buf| buf.len()).sum());
        }
        let wrote = this.poll_write_bare(cx, bufs);
        this.watch(cx, wrote)
    }

    fn is_write_vectored(&self) -> bool {
        self.bare.is_write_vectored()
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.bare).poll_flush(cx)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.bare).poll_shutdown(cx)
    }
}
