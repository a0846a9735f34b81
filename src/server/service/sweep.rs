//! `gc`: what goes from a store, of one service or of many, told or removed.

use std::{collections::BTreeSet, sync::Arc};

use jiff::{SignedDuration, Timestamp};
use serde::Serialize;

use super::{
    Config, Going, GoingReason, Kept, OpenError, Shared,
    backend::FitBackend,
    find_brdf::{named_in, used_brdfs},
    light_textures::LIGHT_TEXTURE_START,
    open::limits,
    reconcile::reconcile,
    tables::Tables,
};
use crate::{
    queue::{
        Queue,
        embedded::{Clock, EmbeddedQueue},
        postgres::{PostgresQueue, Process},
    },
    store::{Access, BlobInfo, Blobs as _, DryRun, PostgresRows, Store, StoreError, pair},
};
use ltcforge_files::digest::Digest;
use ltcforge_fit::FITTER_VERSION;
use ltcforge_textures::is_light_texture;

/// How long a blob without a row is kept: its row may be about to be written.
const ORPHAN_AGE: SignedDuration = SignedDuration::from_hours(24);

/// Jobs of a page.
pub(super) const JOBS_AT_ONCE: usize = 256;

/// What [`sweep`] and [`sweep_folder`] may remove.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Removal {
    /// Nothing: they only tell.
    Nothing,
    /// All that goes, unless orphans are most of the blobs.
    Going,
    /// All that goes, even if orphans are most of the blobs.
    EvenMost,
}

/// What was found and done.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Swept {
    /// Files of the store.
    pub files: usize,
    /// Their bytes.
    pub bytes: u64,
    /// Those that go.
    pub going: Vec<Going>,
    /// What keeps the others, where they are more than the store may have.
    pub kept: Vec<Kept>,
    /// Number of files that were removed.
    pub removed: usize,
}

/// The tabulated BRDFs that are named by recipes of jobs submitted `since`, whatever their state is now.
fn brdfs_named_since(queue: &dyn Queue, since: Timestamp) -> Result<BTreeSet<Digest>, StoreError> {
    let (mut named, mut before) = (BTreeSet::new(), None);
    loop {
        let (jobs, next) = queue.list(None, before, JOBS_AT_ONCE)?;
        let is_earlier = jobs.iter().any(|job| job.created_at < since);
        named.extend(jobs.iter().filter_map(|job| named_in(&job.recipe)));
        match next {
            Some(next) if !is_earlier => before = Some(next),
            _ => return Ok(named),
        }
    }
}

/// The time since which a use keeps a file.
fn recently(config: &Config, now: Timestamp) -> Timestamp {
    let unused_for = SignedDuration::try_from(config.unused_for).unwrap_or(SignedDuration::MAX);
    now.checked_sub(unused_for).unwrap_or(Timestamp::UNIX_EPOCH)
}

/// Finds what goes from a store that processes share: orphans, which are blobs older than a day that are not tables of the catalogue, not
/// named by a recipe in use and no light textures; and what is beyond `config.store_bytes`. Removes it as `removal` says.
///
/// # Errors
/// When the database or the blob store cannot be used, or do not know each other, or most of the blobs are orphans.
pub fn sweep(config: &Config, shared: &Shared, removal: Removal) -> Result<Swept, OpenError> {
    let access = if removal == Removal::Nothing { Access::Read } else { Access::Write };
    let (database, blobs) = shared.connect(config, access)?;
    database.without_limit();
    pair(&database, &blobs, None)?;
    let process = Process { name: "gc".to_owned(), fitter: FITTER_VERSION };
    let queue = PostgresQueue::open(Arc::clone(&database), limits(config), process).map_err(OpenError::Shared)?;
    let tables = Tables::new(Store::shared(Arc::clone(&blobs) as _, Arc::new(PostgresRows::new(database))));
    let catalogue = &tables.catalogue;
    let began = queue.now();
    let brdfs = used_brdfs(catalogue, &queue).map_err(OpenError::Shared)?;
    let is_known = |digest: Digest| -> Result<bool, StoreError> {
        Ok(brdfs.contains(&digest)
            || blobs.part(digest, 0, LIGHT_TEXTURE_START)?.is_some_and(|start| is_light_texture(&start))
            || catalogue.table(digest)?.is_some()
            || brdfs_named_since(&queue, began)?.contains(&digest))
    };
    let before = Timestamp::now().checked_sub(ORPHAN_AGE).unwrap_or(Timestamp::UNIX_EPOCH);
    let is_orphan = |blob: &BlobInfo| Ok(blob.stored_at < before && !is_known(blob.digest)?);
    let (all, mut orphans) = (blobs.list().map_err(OpenError::Shared)?, Vec::new());
    for blob in &all {
        if is_orphan(blob).map_err(OpenError::Shared)? {
            orphans.push(blob);
        }
    }
    if removal == Removal::Going && orphans.len() > all.len() / 2 {
        return Err(OpenError::MostAreOrphans { orphans: orphans.len(), blobs: all.len() });
    }
    let found = orphans.iter().map(|blob| Going {
        digest: blob.digest,
        bytes: blob.bytes,
        used_at: blob.stored_at,
        reason: GoingReason::Orphan,
    });
    let plan = tables.plan(&queue, config.store_bytes, recently(config, began), found.collect());
    let plan = plan.map_err(OpenError::Shared)?;
    let mut removed = 0;
    for going in plan.going.iter().filter(|_| removal != Removal::Nothing) {
        let orphan = orphans.iter().find(|orphan| orphan.digest == going.digest);
        let is_removed = match orphan {
            Some(orphan) => blobs.remove(orphan, &is_known),
            None => tables.remove(&queue, going, began),
        };
        removed += usize::from(is_removed.map_err(OpenError::Shared)?);
    }
    Ok(Swept { files: plan.files, bytes: plan.bytes, going: plan.going, kept: plan.kept, removed })
}

/// Finds what goes from the data folder of a service that is not running: what is beyond `config.store_bytes`, and files of tables
/// that were removed. Removes it as `removal` says; otherwise it works on a copy and changes nothing.
///
/// # Errors
/// When the folder has no store, is in use, not usable, or of a later version.
pub fn sweep_folder(config: &Config, removal: Removal) -> Result<Swept, OpenError> {
    let folder = &config.data_dir;
    let of = |error: StoreError| OpenError::of(folder, error.into());
    let copy = DryRun::of(folder).map_err(|error| OpenError::of(folder, error))?;
    let copy = copy.ok_or_else(|| OpenError::NoStore(folder.clone()))?;
    let store = match removal {
        Removal::Nothing => Store::open(copy.folder()),
        Removal::Going | Removal::EvenMost => {
            drop(copy);
            Store::open(folder)
        }
    };
    let store = store.map_err(|error| OpenError::of(folder, error))?;
    reconcile(&store.rows, store.blobs.as_ref(), &FitBackend::new(None)).map_err(of)?;
    let queue = EmbeddedQueue::open(Arc::clone(&store.rows), limits(config), Clock::system()).map_err(of)?;
    let (tables, now) = (Tables::new(store), queue.now());
    let plan = tables.plan(&queue, config.store_bytes, recently(config, now), Vec::new()).map_err(of)?;
    let mut removed = 0;
    for going in plan.going.iter().filter(|_| removal != Removal::Nothing) {
        removed += usize::from(tables.remove(&queue, going, now).map_err(of)?);
    }
    // What was staged is written.
    tables.store.rows.commit(&crate::store::Batch::default()).map_err(of)?;
    Ok(Swept { files: plan.files, bytes: plan.bytes, going: plan.going, kept: plan.kept, removed })
}
