//! The check of a database and a store of blobs that processes share, while they work.
//!
//! Invariant: nothing is written, be it a migration or a file of a cache. A file is stored before the rows that name it, and removed
//! after them; so rows are read before the store is listed, and a disagreement of rows and store counts if a second look finds it
//! too.

use std::{collections::BTreeSet, sync::Arc};

use rayon::iter::{IntoParallelRefIterator as _, ParallelIterator as _};
use serde::Serialize;

use super::{
    Config, OpenError, Removal, Shared, find_brdf::used_brdfs, open::limits, pins::pinned, sweep, sweep::JOBS_AT_ONCE,
};
use crate::{
    queue::{
        JobId, JobState, Queue as _, StateName,
        postgres::{PostgresQueue, Process},
    },
    store::{Blobs as _, Catalogue, ObjectBlobs, PostgresRows, StoreError, pair},
};
use ltcforge_files::digest::Digest;
use ltcforge_fit::FITTER_VERSION;

/// Blobs that are hashed at the same time. Each is in memory as a whole.
const READS_AT_ONCE: usize = 8;

/// The findings of [`check_shared`].
#[derive(Debug, Serialize)]
pub struct SharedReport {
    /// Tables of the catalogue whose bytes have their digest.
    pub tables: usize,
    /// Other blobs whose bytes have theirs: tabulated BRDFs, light textures, and what was stored within a day.
    pub files: usize,
    /// Blobs that the store gives other bytes for.
    pub damaged: BTreeSet<Digest>,
    /// Where rows and blobs disagree.
    #[serde(flatten)]
    pub disagreements: Disagreements,
    /// Jobs that are done and whose table was removed since.
    pub jobs_without_table: BTreeSet<JobId>,
    /// Blobs that `gc` would remove, because nothing refers to them.
    pub orphans: usize,
    /// Their bytes.
    pub orphan_bytes: u64,
}

/// Where the rows of the database and the blobs of the store disagree.
#[derive(Debug, Default, PartialEq, Eq, Serialize)]
pub struct Disagreements {
    /// Tables of the catalogue without a blob.
    pub missing_tables: BTreeSet<Digest>,
    /// Tabulated BRDFs without a blob that recipes of tables and unfinished jobs name.
    pub missing_brdfs: BTreeSet<Digest>,
    /// Tables of the catalogue of whose rows one is unreadable or missing: their own, their recipe's, the one by age.
    pub incomplete_tables: BTreeSet<Digest>,
    /// Tables that have a pin and are not in the catalogue.
    pub pinned_unknown: BTreeSet<Digest>,
    /// Unfinished jobs that no worker would ever end.
    pub stuck_jobs: BTreeSet<JobId>,
    /// Whether the number of tables that `/metrics` tells is another than that of the rows.
    pub is_miscounted: bool,
}

impl Disagreements {
    /// Those that are in both.
    fn and(&self, other: &Self) -> Self {
        Self {
            missing_tables: &self.missing_tables & &other.missing_tables,
            missing_brdfs: &self.missing_brdfs & &other.missing_brdfs,
            incomplete_tables: &self.incomplete_tables & &other.incomplete_tables,
            pinned_unknown: &self.pinned_unknown & &other.pinned_unknown,
            stuck_jobs: &self.stuck_jobs & &other.stuck_jobs,
            is_miscounted: self.is_miscounted && other.is_miscounted,
        }
    }
}

impl SharedReport {
    /// Whether nothing is wrong.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        self.damaged.is_empty() && self.disagreements == Disagreements::default()
    }
}

/// The rows and the blobs that are looked at.
struct Looked {
    queue: PostgresQueue,
    rows: Arc<PostgresRows>,
    catalogue: Catalogue,
    blobs: Arc<ObjectBlobs>,
}

/// How the store answers for a blob.
enum Hashed {
    Sound,
    Damaged,
    /// It was removed since it was listed.
    Gone,
}

impl Looked {
    /// The tables of the catalogue, whatever is left of their rows.
    fn tables(&self) -> Result<BTreeSet<Digest>, StoreError> {
        let keys = self.catalogue.keys()?.into_iter();
        Ok(keys.filter_map(|key| Some(Digest::from_bytes(key.try_into().ok()?))).collect())
    }

    /// One look at rows and blobs.
    fn disagreements(&self) -> Result<Disagreements, StoreError> {
        let pinned = pinned(self.rows.as_ref())?;
        let (tables, complete) = (self.tables()?, self.catalogue.complete()?);
        let brdfs = used_brdfs(&self.catalogue, &self.queue)?;
        let stored: BTreeSet<Digest> = self.blobs.list()?.into_iter().map(|blob| blob.digest).collect();
        Ok(Disagreements {
            missing_tables: &tables - &stored,
            missing_brdfs: &brdfs - &stored,
            incomplete_tables: &tables - &complete,
            pinned_unknown: &pinned - &tables,
            stuck_jobs: self.queue.stuck()?,
            is_miscounted: !self.rows.totals_agree()?,
        })
    }

    /// The jobs that are done and whose table is not in the catalogue.
    fn jobs_without_table(&self) -> Result<BTreeSet<JobId>, StoreError> {
        let (mut without, mut before) = (BTreeSet::new(), None);
        loop {
            let (jobs, next) = self.queue.list(Some(StateName::Done), before, JOBS_AT_ONCE)?;
            for job in jobs {
                if let JobState::Done { table } = job.state
                    && self.catalogue.table(table)?.is_none()
                {
                    without.insert(job.id);
                }
            }
            match next {
                Some(next) => before = Some(next),
                None => return Ok(without),
            }
        }
    }

    /// Reads and hashes blobs.
    fn hash(&self, digests: &[Digest]) -> Result<Vec<(Digest, Hashed)>, OpenError> {
        let hash = |digest: &Digest| match self.blobs.get(*digest) {
            Ok(Some(_)) => Ok((*digest, Hashed::Sound)),
            Ok(None) => Ok((*digest, Hashed::Gone)),
            Err(StoreError::OtherBytes(_)) => Ok((*digest, Hashed::Damaged)),
            Err(error) => Err(OpenError::Shared(error)),
        };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(READS_AT_ONCE).build();
        let pool = pool.map_err(|error| OpenError::Shared(StoreError::Unavailable(error.to_string())))?;
        pool.install(|| digests.par_iter().map(hash).collect())
    }
}

/// Checks a database and a store of blobs, which processes may be using, and changes nothing: every blob is hashed but those
/// that `gc` would remove, and rows and blobs are held to each other.
///
/// # Errors
/// When the database or the blob store cannot be used, do not know each other, or have not the schema of this program.
pub fn check_shared(config: &Config, shared: &Shared) -> Result<SharedReport, OpenError> {
    let shared = Shared { cache_bytes: 0, ..shared.clone() };
    let (database, blobs) = shared.connect_unchanged(config)?;
    database.without_limit();
    pair(&database, &blobs, None)?;
    let going = sweep(&Config { store_bytes: None, ..config.clone() }, &shared, Removal::Nothing)?.going;
    let process = Process { name: "fsck".to_owned(), fitter: FITTER_VERSION };
    let queue = PostgresQueue::open(Arc::clone(&database), limits(config), process).map_err(OpenError::Shared)?;
    let rows = Arc::new(PostgresRows::new(database));
    let looked = Looked { queue, catalogue: Catalogue::new(Arc::clone(&rows) as _), rows, blobs };

    let listed = looked.blobs.list().map_err(OpenError::Shared)?.into_iter().map(|blob| blob.digest);
    let orphans: BTreeSet<Digest> = going.iter().map(|going| going.digest).collect();
    let hashed = looked.hash(&listed.filter(|digest| !orphans.contains(digest)).collect::<Vec<_>>())?;
    let rest = (|| {
        let mut disagreements = looked.disagreements()?;
        if disagreements != Disagreements::default() {
            disagreements = disagreements.and(&looked.disagreements()?);
        }
        Ok((disagreements, looked.jobs_without_table()?, looked.tables()?))
    })();
    let (disagreements, jobs_without_table, known) = rest.map_err(OpenError::Shared)?;
    let mut report = SharedReport {
        tables: 0,
        files: 0,
        damaged: BTreeSet::new(),
        disagreements,
        jobs_without_table,
        orphans: going.len(),
        orphan_bytes: going.iter().map(|going| going.bytes).sum(),
    };
    for (digest, hashed) in hashed {
        match hashed {
            Hashed::Sound if known.contains(&digest) => report.tables += 1,
            Hashed::Sound => report.files += 1,
            Hashed::Damaged => drop(report.damaged.insert(digest)),
            Hashed::Gone => {}
        }
    }
    Ok(report)
}
