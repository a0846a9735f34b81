//! Which files of blobs had the bytes of their digests when they were last hashed, and the bytes of short ones.
//!
//! Invariant: what is remembered counts only while the file's [`Stamp`] is the same. Everything here can be forgotten: the
//! file is hashed again then.

use std::{fs::Metadata, os::unix::fs::MetadataExt as _, sync::Arc, time::SystemTime};

use quick_cache::{Weighter, sync::Cache};

use super::{Checked, SHORT_BYTES};
use ltcforge_files::digest::Digest;

/// Files that are remembered, of some 150 bytes each.
const FILES: usize = 1 << 16;

/// Bytes of short files that are kept in memory.
const KEPT_BYTES: u64 = 32 << 20;

/// How many short files the cache expects. For more than 62 it would divide its bytes among several parts, and a file of
/// a mebibyte would fit into none.
const KEPT_FILES: usize = 32;

/// The age from which a stamp counts, in seconds. A file system may give one time to all changes within some milliseconds,
/// FAT within two seconds: a change soon after the hash could leave the stamp as it was.
const SETTLED_SECONDS: i64 = 3;

/// What differs once a file was written, replaced or renamed over. Programs can set the time of modification as they like,
/// but not the time of change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Stamp {
    device: u64,
    inode: u64,
    pub(super) length: u64,
    modified: (i64, i64),
    changed: (i64, i64),
}

impl Stamp {
    /// The stamp of a file with such metadata.
    pub(super) fn of(file: &Metadata) -> Self {
        Self {
            device: file.dev(),
            inode: file.ino(),
            length: file.len(),
            modified: (file.mtime(), file.mtime_nsec()),
            changed: (file.ctime(), file.ctime_nsec()),
        }
    }

    /// Whether every later change leaves another stamp.
    fn is_settled(&self) -> bool {
        let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
        now.is_ok_and(|now| {
            self.changed.0.max(self.modified.0).saturating_add(SETTLED_SECONDS) < now.as_secs().cast_signed()
        })
    }
}

/// Counts the bytes of a file.
#[derive(Debug, Clone)]
struct Bytes;

impl Weighter<Digest, Arc<Vec<u8>>> for Bytes {
    fn weight(&self, _key: &Digest, bytes: &Arc<Vec<u8>>) -> u64 {
        bytes.len().max(1) as u64
    }
}

/// The files that were hashed.
#[derive(Debug)]
pub(super) struct Verified {
    stamps: Cache<Digest, Stamp>,
    kept: Cache<Digest, Arc<Vec<u8>>, Bytes>,
}

impl Default for Verified {
    fn default() -> Self {
        Self { stamps: Cache::new(FILES), kept: Cache::with_weighter(KEPT_FILES, KEPT_BYTES, Bytes) }
    }
}

impl Verified {
    /// Whether the file with this stamp is the one that was hashed.
    pub(super) fn is_known(&self, digest: Digest, stamp: &Stamp) -> bool {
        self.stamps.get(&digest).as_ref() == Some(stamp)
    }

    /// The blob in a file with this stamp, if none of its bytes must be read for that.
    pub(super) fn get(&self, digest: Digest, stamp: &Stamp) -> Option<Checked> {
        if !self.is_known(digest, stamp) {
            return None;
        }
        if stamp.length > SHORT_BYTES {
            return Some(Checked::Long(stamp.length));
        }
        self.kept.get(&digest).map(Checked::Bytes)
    }

    /// Remembers a file that has the bytes of its digest. `stamp` was taken before they were read, so that a change
    /// meanwhile leaves another one.
    pub(super) fn remember(&self, digest: Digest, stamp: Stamp) {
        if stamp.is_settled() {
            self.stamps.insert(digest, stamp);
        }
    }

    /// Keeps the bytes of a short blob.
    pub(super) fn keep(&self, digest: Digest, bytes: &Arc<Vec<u8>>) {
        if bytes.len() as u64 <= SHORT_BYTES {
            self.kept.insert(digest, Arc::clone(bytes));
        }
    }

    /// Forgets a file.
    pub(super) fn forget(&self, digest: Digest) {
        self.stamps.remove(&digest);
        self.kept.remove(&digest);
    }
}
