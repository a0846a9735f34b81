//! Copies of files in the kernel's memory, which it sends without copying their bytes for each client.
//!
//! Invariant: what is sent of a copy has the bytes that hyper was given. A copy is made of them and sealed, and stands for
//! them where a slice of them is written: the same address, not merely an equal length.

use std::{
    fs::File,
    io::{self, IoSlice},
    os::fd::AsFd,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use axum::http::Extensions;
use quick_cache::sync::Cache;

use self::system::{sealed, send, send_later};
use super::super::file::InMemory;
use ltcforge_files::digest::Digest;

/// The least bytes of an answer for which the second call into the kernel is worth it.
pub(in crate::http) const LEAST_BYTES: u64 = 64 * 1024;

/// Copies, each with a file descriptor and the bytes of a file that is kept in memory.
const COPIES: usize = 32;

/// The copies that were used last.
#[derive(Debug)]
pub(super) struct KernelCopies(Cache<Digest, Arc<File>>);

impl Default for KernelCopies {
    fn default() -> Self {
        Self(Cache::new(COPIES))
    }
}

impl KernelCopies {
    /// The copy of the file in memory that an answer sends; `None` if it sends no such file, or the system has no room for a copy.
    fn of(&self, answer: &Extensions) -> Option<KernelCopy> {
        let InMemory { digest, bytes } = answer.get()?;
        let copy = self.0.get_or_insert_with(digest, || sealed(bytes).map(Arc::new)).ok()?;
        Some(KernelCopy { bytes: Arc::clone(bytes), copy })
    }
}

/// Bytes in memory, and their copy.
#[derive(Debug)]
struct KernelCopy {
    bytes: Arc<Vec<u8>>,
    copy: Arc<File>,
}

impl KernelCopy {
    /// Where `part` begins if it is a part of these very bytes.
    fn offset_of(&self, part: &[u8]) -> Option<u64> {
        let (whole, part) = (self.bytes.as_ptr_range(), part.as_ptr_range());
        let is_within = whole.start <= part.start && part.start < part.end && part.end <= whole.end;
        is_within.then(|| (part.start.addr() - whole.start.addr()) as u64)
    }
}

/// The copy of which an answer is sent, where there is one; a connection writes one answer after the other.
#[derive(Debug, Clone, Default)]
pub(super) struct Sending(Arc<Mutex<Option<KernelCopy>>>);

impl Sending {
    /// Takes the copy of an answer that is to be written next.
    pub(super) fn begin(&self, copies: &KernelCopies, answer: &Extensions) {
        *self.lock() = copies.of(answer);
    }

    /// Forgets it, so that an idle connection keeps no file.
    pub(super) fn end(&self) {
        *self.lock() = None;
    }

    /// How to begin writing `parts`, if the copy has one of them.
    pub(super) fn plan<'a>(&self, parts: &'a [IoSlice<'a>]) -> Option<Plan<'a>> {
        let sending = self.lock();
        let KernelCopy { copy, .. } = sending.as_ref()?;
        let offset_of = |part: &IoSlice<'_>| sending.as_ref()?.offset_of(part);
        let (place, offset) = parts.iter().enumerate().find_map(|(place, part)| Some((place, offset_of(part)?)))?;
        let before = &parts[..place];
        Some(if before.iter().all(|part| part.is_empty()) {
            Plan::Copied { copy: Arc::clone(copy), offset, length: parts[place].len() }
        } else {
            Plan::Before(before)
        })
    }

    fn lock(&self) -> MutexGuard<'_, Option<KernelCopy>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The beginning of what hyper wants written.
#[derive(Debug)]
pub(super) enum Plan<'a> {
    /// The parts before the copied bytes: the head of an answer.
    Before(&'a [IoSlice<'a>]),
    /// Bytes of the copy.
    Copied { copy: Arc<File>, offset: u64, length: usize },
}

impl Plan<'_> {
    /// Writes some of it to a socket that does not block, and tells how many bytes.
    pub(super) fn write(&self, socket: impl AsFd) -> io::Result<usize> {
        match self {
            Self::Before(parts) => send_later(socket, parts),
            Self::Copied { copy, offset, length } => send(socket, copy, *offset, *length),
        }
    }

    /// Whether these were the last bytes of the copy that hyper has to write.
    pub(super) fn is_done_after(&self, written: usize) -> bool {
        matches!(self, Self::Copied { length, .. } if written == *length)
    }
}

/// The calls of Linux.
#[cfg(target_os = "linux")]
mod system {
    use std::io::Write as _;

    use rustix::{
        fs::{MemfdFlags, SealFlags, fcntl_add_seals, memfd_create, sendfile},
        net::{SendAncillaryBuffer, SendFlags, sendmsg},
    };

    use super::{AsFd, File, IoSlice, io};

    /// A file in the kernel's memory that nobody can change.
    pub(super) fn sealed(bytes: &[u8]) -> io::Result<File> {
        let mut file = File::from(memfd_create("ltcforge", MemfdFlags::CLOEXEC | MemfdFlags::ALLOW_SEALING)?);
        file.write_all(bytes)?;
        fcntl_add_seals(&file, SealFlags::WRITE | SealFlags::SHRINK | SealFlags::GROW | SealFlags::SEAL)?;
        Ok(file)
    }

    /// Gives `parts` to the system, which sends them together with what follows.
    pub(super) fn send_later(socket: impl AsFd, parts: &[IoSlice<'_>]) -> io::Result<usize> {
        let flags = SendFlags::MORE | SendFlags::NOSIGNAL;
        Ok(sendmsg(socket, parts, &mut SendAncillaryBuffer::default(), flags)?)
    }

    /// Sends bytes of a file.
    pub(super) fn send(socket: impl AsFd, file: &File, mut offset: u64, length: usize) -> io::Result<usize> {
        Ok(sendfile(socket, file, Some(&mut offset), length)?)
    }
}

/// Elsewhere nothing is copied, and so nothing sent of a copy.
#[cfg(not(target_os = "linux"))]
mod system {
    use super::{AsFd, File, IoSlice, io};

    pub(super) fn sealed(_bytes: &[u8]) -> io::Result<File> {
        Err(io::ErrorKind::Unsupported.into())
    }

    pub(super) fn send_later(_socket: impl AsFd, _parts: &[IoSlice<'_>]) -> io::Result<usize> {
        Err(io::ErrorKind::Unsupported.into())
    }

    pub(super) fn send(_socket: impl AsFd, _file: &File, _offset: u64, _length: usize) -> io::Result<usize> {
        Err(io::ErrorKind::Unsupported.into())
    }
}

#[cfg(test)]
mod tests {
    use std::{io::Write as _, time::Duration};

    use tokio::{
        io::{AsyncReadExt as _, AsyncWriteExt as _},
        net::{TcpListener, TcpStream},
    };

    use super::{
        super::{Stream, stream::ClientStream},
        *,
    };

    /// An answer with `bytes` in memory, of which the kernel is made to believe that they are `copied`.
    fn sending(bytes: &Arc<Vec<u8>>, copied: &[u8]) -> Sending {
        let (copies, digest) = (KernelCopies::default(), Digest::of(bytes));
        copies.0.insert(digest, Arc::new(sealed(copied).expect("room for a copy")));
        let mut answer = Extensions::new();
        answer.insert(InMemory { digest, bytes: Arc::clone(bytes) });
        let sending = Sending::default();
        sending.begin(&copies, &answer);
        sending
    }

    #[tokio::test]
    async fn the_kernel_sends_its_copy_after_the_head() {
        // More than the system takes at once.
        let bytes: Arc<Vec<u8>> = Arc::new(vec![0; 9_000_000]);
        let copied: Vec<u8> = (0..bytes.len()).map(|place| (place >> 12) as u8 | 1).collect();
        let sending = sending(&bytes, &copied);
        let listener = TcpListener::bind("127.0.0.1:0").await.expect("a port");
        let mut client = TcpStream::connect(listener.local_addr().expect("an address")).await.expect("a connection");
        let (server, _) = listener.accept().await.expect("a client");
        let mut stream = ClientStream::new(Stream::Left(server), Duration::from_secs(60), sending.clone());
        let write = async {
            let (mut head, mut rest) = (&b"head"[..], &bytes[1000..]);
            while !rest.is_empty() {
                let written = stream.write_vectored(&[IoSlice::new(head), IoSlice::new(rest)]).await.expect("a client");
                let of_head = written.min(head.len());
                (head, rest) = (&head[of_head..], &rest[written - of_head..]);
            }
            stream.shutdown().await.expect("a client");
        };
        let mut read = Vec::new();
        let ((), received) = tokio::join!(write, client.read_to_end(&mut read));
        assert_eq!(received.expect("an answer"), 4 + copied.len() - 1000);
        assert!(read.starts_with(b"head") && read[4..] == copied[1000..], "other bytes than the copy's");
        assert!(sending.lock().is_none(), "an idle connection keeps the file");
    }

    #[test]
    fn only_the_same_memory_stands_for_the_copy() {
        let bytes = Arc::new(vec![1; 100]);
        let sending = sending(&bytes, &bytes);
        let (equal, head) = (bytes.to_vec(), [0; 10]);
        let plan = |parts: &[&[u8]]| {
            let parts: Vec<IoSlice<'_>> = parts.iter().map(|part| IoSlice::new(part)).collect();
            sending.plan(&parts).map(|plan| match plan {
                Plan::Before(parts) => (parts.len(), 0, 0),
                Plan::Copied { offset, length, .. } => (0, offset, length),
            })
        };
        assert_eq!(plan(&[&head, &bytes]), Some((1, 0, 0)));
        assert_eq!(plan(&[&bytes]), Some((0, 0, 100)));
        assert_eq!(plan(&[&[], &bytes[1..]]), Some((0, 1, 99)), "there is nothing before it");
        assert_eq!(plan(&[&bytes[20..50], &head]), Some((0, 20, 30)));
        for others in [&[&equal[..]][..], &[&head], &[&head, &equal], &[&bytes[..0]], &[]] {
            assert_eq!(plan(others), None);
        }
    }

    #[test]
    fn nobody_changes_a_copy() {
        let copy = sealed(b"table").expect("room for a copy");
        assert!((&copy).write_all(b"x").is_err() && copy.set_len(2).is_err());
    }
}
