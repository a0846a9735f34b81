//! Keeps the store within `--store-bytes`.
//!
//! Only tables are evicted, because a table can be fitted again from its recipe, but a BRDF cannot.
//! Invariant: nothing is deleted while the state is known to be incomplete. If a start was not clean, nothing is
//! evicted until the next clean start.

use std::{
    collections::HashMap,
    sync::{PoisonError, atomic::Ordering},
};

use jiff::{SignedDuration, Timestamp};

use super::state::State;
use crate::store::{BlobInfo, StoreError};

/// A table that was used within this time is never evicted, because clients may still download the table of a job that
/// has just ended.
const GRACE: SignedDuration = SignedDuration::from_secs(600);

impl State {
    /// Deletes the least recently used tables until the files fit into `--store-bytes`.
    pub(super) fn evict(&self) {
        let Some(limit) = self.config.store_bytes.filter(|_| self.is_complete) else { return };
        if let Err(error) = self.evict_above(limit, Timestamp::now()) {
            tracing::error!(%error, "could not reduce the store to --store-bytes");
        }
    }

    pub(super) fn evict_above(&self, limit: u64, now: Timestamp) -> Result<(), StoreError> {
        self.files.record_uses();
        let mut blobs: HashMap<_, _> = self.files.blobs.list()?.into_iter().map(|blob| (blob.digest, blob)).collect();
        let mut bytes: u64 = blobs.values().map(|blob| blob.bytes).sum();
        let mut tables: Vec<BlobInfo> =
            self.files.catalogue.tables()?.iter().filter_map(|row| blobs.remove(&row.digest)).collect();
        tables.sort_by_key(|blob| blob.used_at);
        for table in tables {
            let is_recent = now.duration_since(table.used_at) < GRACE;
            if bytes <= limit || is_recent {
                break;
            }
            let _alone = self.naming.write().unwrap_or_else(PoisonError::into_inner);
            self.files.delete(table.digest)?;
            self.exports.forget(table.digest);
            self.files_removed.fetch_add(1, Ordering::Relaxed);
            bytes = bytes.saturating_sub(table.bytes);
            tracing::info!(table = %table.digest, used_at = %table.used_at, "evicted the table, because the store was above --store-bytes");
        }
        Ok(())
    }
}
