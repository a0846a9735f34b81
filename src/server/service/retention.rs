//! Keeping the store within its size: what was used longest ago goes first, and what is needed stays.
//!
//! One list decides: the files of the store, each with its last use. Stays: a table with a pin; a tabulated BRDF that the recipe of
//! a table, or of a job that waits or runs, names; and what was used or stored so lately that a client may be about to
//! fetch it, or another process has not told of its use yet. That may be more than the size allows.

use std::{
    cmp::Reverse,
    collections::{BTreeMap, HashMap},
    fmt,
    sync::{PoisonError, atomic::Ordering},
    time::{Duration, Instant},
};

use jiff::{SignedDuration, Timestamp};
use serde::Serialize;

use super::{
    FileKind, RemovalReason,
    find_brdf::{named_in, named_in_unfinished, used_brdfs},
    pins::pinned,
    state::ServiceState,
    tables::Tables,
    uses::{FLUSH, UseRow},
};
use crate::{
    queue::Queue,
    store::{Batch, StoreError, Tree},
};
use ltcforge_files::digest::Digest;

/// From one look at the store to the next; the first is at the start.
const LOOK: Duration = Duration::from_secs(600);

/// Removed tables that requests are told of, at most; those that were removed first are forgotten.
const MOST_REMOVED: usize = 10_000;

/// A file that goes.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Going {
    /// Its digest.
    pub digest: Digest,
    /// Its size.
    pub bytes: u64,
    /// When it was last used, or stored.
    pub used_at: Timestamp,
    /// Why it goes.
    pub reason: GoingReason,
}

/// Why a file goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum GoingReason {
    /// It is a table that was removed, and the process ended before its file was.
    Removed,
    /// The store is larger than it may be, and this was used longest ago.
    StoreBytes,
    /// Nothing has referred to it for a day; in a store that processes share.
    Orphan,
}

impl GoingReason {
    /// In words.
    #[must_use]
    pub fn text(self) -> &'static str {
        match self {
            Self::Removed => "its table was removed",
            Self::StoreBytes => "used longest ago, and the store is larger than --store-bytes",
            Self::Orphan => "nothing refers to it",
        }
    }
}

/// Why files stay although the store is larger than it may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum KeptReason {
    /// They are tables with a pin.
    Pin,
    /// They are tabulated BRDFs that the recipes of jobs name that wait or run.
    Job,
    /// They are tabulated BRDFs that the recipes of tables name.
    Table,
    /// They were used or stored lately.
    Recent,
}

impl KeptReason {
    /// In words.
    #[must_use]
    pub fn text(self) -> &'static str {
        match self {
            Self::Pin => "pinned",
            Self::Job => "tabulated BRDFs that recipes of unfinished jobs name",
            Self::Table => "tabulated BRDFs that recipes of tables name",
            Self::Recent => "used or stored lately",
        }
    }
}

/// Files that stay for one reason.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Kept {
    /// The reason; of several, the one that is listed first.
    pub reason: KeptReason,
    /// How many files.
    pub files: usize,
    /// Their bytes.
    pub bytes: u64,
}

impl fmt::Display for Kept {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} bytes in {} files stay: {}", self.bytes, self.files, self.reason.text())
    }
}

/// What goes, and what the store has then.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Plan {
    /// Files of the store.
    pub(super) files: usize,
    /// Their bytes.
    pub(super) bytes: u64,
    /// Those that go, first the one that goes first.
    pub(super) going: Vec<Going>,
    /// What keeps the others, where they are more than the store may have.
    pub(super) kept: Vec<Kept>,
}

impl Plan {
    /// The bytes that stay.
    pub(super) fn bytes_left(&self) -> u64 {
        self.bytes - self.going.iter().map(|going| going.bytes).sum::<u64>()
    }
}

impl Tables {
    /// What goes so that the store has at most `store_bytes`; `None` for any number. What was used since `recently` stays, but for
    /// `orphans`, which go anyway.
    pub(super) fn plan(
        &self,
        queue: &dyn Queue,
        store_bytes: Option<u64>,
        recently: Timestamp,
        orphans: Vec<Going>,
    ) -> Result<Plan, StoreError> {
        let (uses, mut blobs) = (self.all_uses()?, self.store.blobs.list()?);
        let bytes = blobs.iter().map(|blob| blob.bytes).sum();
        let mut plan = Plan { files: blobs.len(), bytes, going: orphans, kept: Vec::new() };
        let mut stays = Vec::new();
        blobs.retain(|blob| plan.going.iter().all(|orphan| orphan.digest != blob.digest));
        for blob in blobs {
            let row = uses.get(&blob.digest);
            let used_at = row.map_or(blob.stored_at, |row| row.used_at.max(blob.stored_at));
            let is_removed = row.and_then(|row| row.removed.as_ref()).is_some_and(|removed| removed.has_file);
            let going = |reason| Going { digest: blob.digest, bytes: blob.bytes, used_at, reason };
            if is_removed && self.catalogue.table(blob.digest)?.is_none() {
                plan.going.push(going(GoingReason::Removed));
            } else {
                stays.push(going(GoingReason::StoreBytes));
            }
        }
        let Some(limit) = store_bytes.filter(|limit| plan.bytes_left() > *limit) else { return Ok(plan) };
        let pinned = pinned(self.store.rows.as_ref())?;
        let may_go = |file: &Going| file.used_at < recently && !pinned.contains(&file.digest);
        let (mut stays, kept): (Vec<_>, Vec<_>) = stays.into_iter().partition(may_go);
        stays.sort_by_key(|file| (file.used_at, file.digest));
        // How many recipes name each BRDF.
        let mut named: BTreeMap<Digest, usize> = BTreeMap::new();
        let (of_tables, of_jobs) = (self.catalogue.recipes()?, named_in_unfinished(queue)?);
        for brdf in of_tables.iter().filter_map(|recipe| named_in(recipe)).chain(of_jobs.iter().copied()) {
            *named.entry(brdf).or_default() += 1;
        }
        // A BRDF may go once the last table that names it goes, and was perhaps used before it.
        while plan.bytes_left() > limit
            && let Some(next) = stays.iter().position(|file| named.get(&file.digest).is_none_or(|count| *count == 0))
        {
            let file = stays.remove(next);
            let row = self.catalogue.table(file.digest)?;
            let recipe = row.map(|row| self.catalogue.recipe(row.recipe_digest)).transpose()?.flatten();
            if let Some(count) = recipe.and_then(|(recipe, _)| named_in(&recipe)).and_then(|brdf| named.get_mut(&brdf))
            {
                *count = count.saturating_sub(1);
            }
            plan.going.push(file);
        }
        if plan.bytes_left() > limit {
            let mut sums: BTreeMap<KeptReason, (usize, u64)> = BTreeMap::new();
            for file in stays.iter().chain(&kept) {
                let reason = match file.digest {
                    digest if pinned.contains(&digest) => KeptReason::Pin,
                    digest if of_jobs.contains(&digest) => KeptReason::Job,
                    digest if named.get(&digest).is_some_and(|count| *count > 0) => KeptReason::Table,
                    _ => KeptReason::Recent,
                };
                let (files, bytes) = sums.entry(reason).or_default();
                (*files, *bytes) = (*files + 1, *bytes + file.bytes);
            }
            plan.kept = sums.into_iter().map(|(reason, (files, bytes))| Kept { reason, files, bytes }).collect();
        }
        Ok(plan)
    }

    /// Removes a file that goes; tells whether it did: a table may have been pinned, a BRDF named since. Nobody in this process
    /// pins, submits or stores meanwhile.
    pub(super) fn remove(&self, queue: &dyn Queue, going: &Going, at: Timestamp) -> Result<bool, StoreError> {
        let digest = going.digest;
        if self.catalogue.table(digest)?.is_some() {
            return self.remove_table(digest, RemovalReason::StoreBytes, at);
        }
        if let Some(mut row) = self.use_of(digest)?.filter(|row| row.removed.is_some()) {
            return self.remove_file(digest, &mut row).map(|()| true);
        }
        let is_picture = self.length(FileKind::LightTexture, digest)?.is_some();
        let is_known = |digest: Digest| {
            Ok(!is_picture
                && (self.catalogue.table(digest)?.is_some() || used_brdfs(&self.catalogue, queue)?.contains(&digest)))
        };
        if is_known(digest)? {
            return Ok(false);
        }
        self.store.blobs.delete_unless(digest, &is_known)?;
        let mut batch = Batch::default();
        batch.remove(Tree::Uses, *digest.as_bytes());
        self.store.rows.stage(&batch)?;
        Ok(true)
    }

    /// Forgets what is no longer told of removed tables.
    fn forget_removed(&self, uses: &HashMap<Digest, UseRow>) -> Result<(), StoreError> {
        let at = |row: &UseRow| row.removed.as_ref().map(|removed| Reverse(removed.at));
        let mut removed: Vec<_> = uses.iter().filter_map(|(digest, row)| Some((at(row)?, *digest))).collect();
        removed.sort_unstable();
        let mut batch = Batch::default();
        for (_, digest) in removed.iter().skip(MOST_REMOVED) {
            batch.remove(Tree::Uses, *digest.as_bytes());
        }
        if batch.is_empty() { Ok(()) } else { self.store.rows.stage(&batch).map(drop) }
    }
}

impl ServiceState {
    /// Writes uses down and keeps the store within its size until the service is stopped.
    pub(super) fn retain(&self) {
        let mut next = Instant::now();
        loop {
            if next <= Instant::now() {
                match self.look() {
                    Ok(()) => next = Instant::now() + LOOK,
                    Err(error) => {
                        tracing::warn!(%error, "the store was not kept within its size; it is tried again in a minute");
                    }
                }
            }
            let goes_on = self.wait_until(Instant::now() + FLUSH);
            if let Err(error) = self.write_uses() {
                tracing::warn!(%error, "uses of files were not written");
            }
            if !goes_on {
                break;
            }
        }
    }

    /// Writes the uses since the last time. A table that another process has removed is dropped from this one's cache and
    /// memory, from where it was sent.
    pub(super) fn write_uses(&self) -> Result<(), StoreError> {
        let uses = self.tables.uses.take();
        if uses.is_empty() {
            return Ok(());
        }
        let now = self.queue.now();
        let written = (|| {
            let mut batch = Batch::default();
            for (digest, at) in &uses {
                let is_removed = self.tables.use_of(*digest)?.is_some_and(|row| row.removed.is_some());
                if is_removed && self.tables.catalogue.table(*digest)?.is_none() {
                    self.tables.store.blobs.drop_copy(*digest);
                    self.exports.forget(*digest);
                    continue;
                }
                let ago = SignedDuration::try_from(at.elapsed()).unwrap_or_default();
                let used_at = now.checked_sub(ago).unwrap_or(now);
                UseRow { used_at, removed: None }.put(&mut batch, *digest)?;
            }
            // It is durable with the next commit.
            self.tables.store.rows.stage(&batch).map(drop)
        })();
        if written.is_err() {
            self.tables.uses.put_back(uses);
        }
        written
    }

    /// Completes removals that were interrupted, and removes what is too much.
    pub(super) fn look(&self) -> Result<(), StoreError> {
        let (now, uses) = (self.queue.now(), self.tables.all_uses()?);
        self.tables.forget_removed(&uses)?;
        for (digest, mut row) in uses {
            if row.removed.as_ref().is_some_and(|removed| removed.has_file) {
                let _alone = self.naming.write().unwrap_or_else(PoisonError::into_inner);
                self.tables.remove_file(digest, &mut row)?;
            }
        }
        let Some(limit) = self.config.store_bytes else { return Ok(()) };
        let unused_for = SignedDuration::try_from(self.config.unused_for).unwrap_or(SignedDuration::MAX);
        let recently = now.checked_sub(unused_for).unwrap_or(Timestamp::UNIX_EPOCH);
        let plan = self.tables.plan(self.queue.as_ref(), Some(limit), recently, Vec::new())?;
        let (mut files, mut bytes) = (0_u64, 0);
        for going in &plan.going {
            if self.is_stopping() {
                break;
            }
            if self.remove_unless_used(going, now)? {
                self.exports.forget(going.digest);
                (files, bytes) = (files + 1, bytes + going.bytes);
                self.files_removed.fetch_add(1, Ordering::Relaxed);
            }
        }
        if files > 0 {
            self.backend.forget_files();
            tracing::info!(files, bytes, "files that were used longest ago were removed: the store has a limit");
        }
        if plan.bytes_left() > limit {
            let kept: Vec<String> = plan.kept.iter().map(Kept::to_string).collect();
            let bytes = plan.bytes_left();
            tracing::warn!(bytes, limit, "the store is larger than --store-bytes: {}", kept.join("; "));
        }
        Ok(())
    }

    /// Removes a file that goes, unless it was asked for since it was chosen; tells whether it did.
    pub(super) fn remove_unless_used(&self, going: &Going, at: Timestamp) -> Result<bool, StoreError> {
        let _alone = self.naming.write().unwrap_or_else(PoisonError::into_inner);
        Ok(!self.tables.uses.has(going.digest) && self.tables.remove(self.queue.as_ref(), going, at)?)
    }
}
