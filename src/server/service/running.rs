//! The leased tasks of this process.

use std::sync::atomic::{AtomicBool, AtomicU64};

/// A leased task of this process.
#[derive(Debug, Default)]
pub(super) struct Running {
    pub(super) entries_done: AtomicU64,
    /// The lease is no longer current: the job was cancelled, or the lease expired.
    pub(super) is_stale: AtomicBool,
}
