//! The check of a whole data folder.

use std::path::Path;

use serde::Serialize;

use super::{OpenError, Reconciled, engine::FitEngine, reconcile::reconcile};
use crate::{
    queue::embedded::{self, ReconciledJobs},
    store::{Findings, Rehearsal, Store, StoreError},
};
use ltcforge_files::{digest::Digest, tabulated};

/// What [`check`] found in a data folder.
#[derive(Debug, Serialize)]
pub struct CheckReport {
    /// What is wrong with the database and the journal.
    pub store: Findings,
    /// What is wrong with the list of jobs.
    pub jobs: ReconciledJobs,
    /// What is wrong with the catalogue.
    pub catalogue: Reconciled,
    /// Tables whose bytes have their digest.
    pub tables: usize,
    /// Files whose bytes do not have the digest of their name.
    pub damaged_tables: Vec<Digest>,
}

impl CheckReport {
    /// Whether nothing is wrong.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        let Self { store, jobs, catalogue, damaged_tables, .. } = self;
        *store == Findings::default()
            && *jobs == ReconciledJobs::default()
            && *catalogue == Reconciled::default()
            && damaged_tables.is_empty()
    }

    /// Ids of all jobs that are lost, in order.
    #[must_use]
    pub fn lost_jobs(&self) -> Vec<String> {
        let mut lost = [self.store.lost_jobs.as_slice(), &self.jobs.lost].concat();
        lost.sort();
        lost.dedup();
        lost
    }
}

/// Checks everything in a data folder and changes nothing in it: a start is rehearsed on a copy of the database and the
/// journal, and every blob is hashed.
///
/// # Errors
/// When the folder has no store, is in use, not usable, or of a later version.
pub fn check(folder: &Path) -> Result<CheckReport, OpenError> {
    let of = |error: StoreError| OpenError::of(folder, error.into());
    let copy = Rehearsal::of(folder).map_err(|error| OpenError::of(folder, error))?;
    let copy = copy.ok_or_else(|| OpenError::NoStore(folder.to_owned()))?;
    let store = Store::open(copy.folder()).map_err(|error| OpenError::of(folder, error))?;
    let (mut tables, mut damaged_tables) = (0, Vec::new());
    for blob in store.blobs.list().map_err(of)? {
        match store.blobs.get(blob.digest) {
            // The files of tabulated BRDFs lie beside them.
            Ok(bytes) => tables += usize::from(bytes.is_some_and(|bytes| tabulated::decode(&bytes).is_err())),
            Err(StoreError::Corrupt { expected, .. }) => damaged_tables.push(expected),
            Err(error) => return Err(of(error)),
        }
    }
    let jobs = embedded::reconcile(store.rows.as_ref()).map_err(of)?;
    let mut catalogue = reconcile(&store.rows, store.blobs.as_ref(), &FitEngine::default()).map_err(of)?;
    // Their file is there.
    catalogue.lost.retain(|digest| !damaged_tables.contains(digest));
    Ok(CheckReport { store: store.found, jobs, catalogue, tables, damaged_tables })
}
