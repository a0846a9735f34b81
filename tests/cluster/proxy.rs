//! A proxy for PostgreSQL or an object store. It can cut or hold connections, or answer requests itself.

use std::{
    io::{self, BufRead as _, BufReader, Read, Write},
    net::{Ipv4Addr, Shutdown, SocketAddr, TcpListener, TcpStream},
    os::unix::net::UnixStream,
    path::PathBuf,
    sync::{
        Arc, Condvar, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
    time::Duration,
};

/// The server behind a proxy.
#[derive(Debug, Clone)]
pub(crate) enum Upstream {
    /// A Unix socket of a server.
    Unix(PathBuf),
    Tcp(SocketAddr),
}

/// How the proxy treats connections.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Link {
    Up,
    /// Each direction passes a kilobyte per tenth of a second.
    Slow,
    /// Connections are closed immediately.
    Down,
    /// Connections stay open, but no bytes pass until the mode changes.
    Held,
    /// Each HTTP request gets a response with this status.
    Answers(u16),
    /// Each HTTP request gets bytes that were never stored.
    OtherBytes,
}

/// A proxy on a local port.
pub(crate) struct Proxy {
    pub(crate) address: SocketAddr,
    state: Arc<State>,
}

struct State {
    inner: Mutex<Inner>,
    changed: Condvar,
    /// Number of closed connections, and of requests that the proxy answered itself.
    refused: AtomicUsize,
}

struct Inner {
    link: Link,
    upstream: Upstream,
    open: Vec<Stream>,
}

enum Stream {
    Unix(UnixStream),
    Tcp(TcpStream),
}

impl Stream {
    fn connect(upstream: &Upstream) -> io::Result<Self> {
        Ok(match upstream {
            Upstream::Unix(path) => Self::Unix(UnixStream::connect(path)?),
            Upstream::Tcp(address) => Self::Tcp(TcpStream::connect(address)?),
        })
    }

    fn another(&self) -> io::Result<Self> {
        Ok(match self {
            Self::Unix(stream) => Self::Unix(stream.try_clone()?),
            Self::Tcp(stream) => Self::Tcp(stream.try_clone()?),
        })
    }

    fn end(&self) {
        // The connection may have ended already.
        let _ = match self {
            Self::Unix(stream) => stream.shutdown(Shutdown::Both),
            Self::Tcp(stream) => stream.shutdown(Shutdown::Both),
        };
    }
}

impl Read for Stream {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::Unix(stream) => stream.read(bytes),
            Self::Tcp(stream) => stream.read(bytes),
        }
    }
}

impl Write for Stream {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Unix(stream) => stream.write(bytes),
            Self::Tcp(stream) => stream.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl State {
    fn lock(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn serve(self: &Arc<Self>, client: Stream) -> io::Result<()> {
        let (link, upstream) = {
            let inner = self.lock();
            (inner.link, inner.upstream.clone())
        };
        match link {
            Link::Down => {
                self.refused.fetch_add(1, Ordering::Relaxed);
                client.end();
            }
            Link::Up | Link::Slow | Link::Held => {
                let server = Stream::connect(&upstream)?;
                self.lock().open.extend([client.another()?, server.another()?]);
                let (here, there) = (client.another()?, server.another()?);
                let state = Arc::clone(self);
                thread::spawn(move || state.copy(there, here));
                self.copy(client, server);
            }
            Link::Answers(status) => {
                self.lock().open.push(client.another()?);
                while let Some(_method) = read_request(&client)? {
                    self.refused.fetch_add(1, Ordering::Relaxed);
                    answer(client.another()?, status, b"<Error><Code>Test</Code></Error>")?;
                }
            }
            Link::OtherBytes => {
                self.lock().open.push(client.another()?);
                while let Some(_method) = read_request(&client)? {
                    self.refused.fetch_add(1, Ordering::Relaxed);
                    answer(client.another()?, 200, b"not what was stored")?;
                }
            }
        }
        Ok(())
    }

    /// Copies bytes until one side closes. Waits while the link is held.
    fn copy(&self, mut from: Stream, mut to: Stream) {
        let mut bytes = vec![0; 1 << 16];
        while let Ok(count @ 1..) = from.read(&mut bytes) {
            let held = |inner: &mut Inner| inner.link == Link::Held;
            drop(self.changed.wait_while(self.lock(), held).unwrap_or_else(PoisonError::into_inner));
            let is_slow = self.lock().link == Link::Slow;
            let written = bytes[..count].chunks(if is_slow { 1000 } else { count }).try_for_each(|piece| {
                if is_slow {
                    thread::sleep(Duration::from_millis(100));
                }
                to.write_all(piece)
            });
            if written.is_err() {
                break;
            }
        }
        from.end();
        to.end();
    }
}

/// Reads a request up to the end of its body, and returns its method. `None` at the end of the connection.
fn read_request(client: &Stream) -> io::Result<Option<String>> {
    let mut reader = BufReader::with_capacity(1, client.another()?);
    let (mut first, mut length) = (String::new(), 0);
    if reader.read_line(&mut first)? == 0 {
        return Ok(None);
    }
    loop {
        let mut line = String::new();
        if reader.read_line(&mut line)? == 0 {
            return Ok(None);
        }
        if line.trim().is_empty() {
            break;
        }
        if let Some((name, value)) = line.split_once(':')
            && name.eq_ignore_ascii_case("content-length")
        {
            length = value.trim().parse().unwrap_or(0);
        }
    }
    io::copy(&mut reader.take(length), &mut io::sink())?;
    Ok(first.split(' ').next().map(str::to_owned))
}

fn answer(mut client: Stream, status: u16, body: &[u8]) -> io::Result<()> {
    let head = format!(
        "HTTP/1.1 {status} Test\r\ncontent-type: application/xml\r\ncontent-length: {}\r\netag: \"x\"\r\n\
        last-modified: Thu, 01 Jan 2026 00:00:00 GMT\r\n\r\n",
        body.len()
    );
    client.write_all(&[head.as_bytes(), body].concat())
}

impl Proxy {
    pub(crate) fn start(upstream: Upstream) -> Self {
        Self::start_on(Ipv4Addr::LOCALHOST, upstream)
    }

    /// A proxy on the given local address.
    pub(crate) fn start_on(address: Ipv4Addr, upstream: Upstream) -> Self {
        let listener = TcpListener::bind((address, 0)).expect("a port");
        let address = listener.local_addr().expect("its address");
        let inner = Mutex::new(Inner { link: Link::Up, upstream, open: vec![] });
        let state = Arc::new(State { inner, changed: Condvar::new(), refused: AtomicUsize::new(0) });
        let accepting = Arc::clone(&state);
        thread::spawn(move || {
            for client in listener.incoming().map_while(Result::ok) {
                let state = Arc::clone(&accepting);
                // Failing connections are expected.
                thread::spawn(move || drop(state.serve(Stream::Tcp(client))));
            }
        });
        Self { address, state }
    }

    /// Changes the mode of the link. Open connections continue if it is up, slow or held. Otherwise they are closed.
    pub(crate) fn set(&self, link: Link) {
        let mut inner = self.state.lock();
        let was = std::mem::replace(&mut inner.link, link);
        let passes = |link| matches!(link, Link::Up | Link::Slow | Link::Held);
        if !(passes(was) && passes(link)) {
            inner.open.drain(..).for_each(|stream| stream.end());
        }
        drop(inner);
        self.state.changed.notify_all();
    }

    /// Changes the server behind the proxy.
    pub(crate) fn lead_to(&self, upstream: Upstream) {
        let mut inner = self.state.lock();
        inner.upstream = upstream;
        inner.open.drain(..).for_each(|stream| stream.end());
    }

    /// The number of connections that were closed at once, and of requests that the proxy answered itself.
    pub(crate) fn refused(&self) -> usize {
        self.state.refused.load(Ordering::Relaxed)
    }
}
