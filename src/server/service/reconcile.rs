//! The catalogue compared with the blobs, and the check of a whole data folder.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
    sync::Arc,
};

use jiff::Timestamp;
use serde::Serialize;

use super::{
    OpenError, TableRow,
    engine::{Engine, FitEngine},
};
use crate::{
    files::digest::Digest,
    server::store::{Blobs, Catalogue, Findings, Rows, Store, StoreError},
};

/// What was done to make the catalogue and the blobs agree.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Reconciled {
    /// Blobs that are tables and were missing in the catalogue, or in its list or its recipes.
    pub added: Vec<Digest>,
    /// Tables of the catalogue whose blob is missing. They are taken out, so that their recipes are fitted again.
    pub lost: Vec<Digest>,
}

/// What [`check`] found in a data folder.
#[derive(Debug, Serialize)]
pub struct CheckReport {
    /// What was wrong with the database and the journal.
    pub store: Findings,
    /// What was wrong with the catalogue.
    pub catalogue: Reconciled,
    /// Tables whose bytes have their digest.
    pub tables: usize,
    /// Files whose bytes do not have the digest of their name; they were moved to quarantine.
    pub damaged_tables: Vec<Digest>,
}

impl CheckReport {
    /// Whether nothing was wrong.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        let Self { store, catalogue, damaged_tables, .. } = self;
        *store == Findings::default() && *catalogue == Reconciled::default() && damaged_tables.is_empty()
    }
}

/// Checks everything in the data folder and mends what it can: reads every row, compares the database with the journal
/// of jobs and the catalogue with the blobs, and hashes every blob.
///
/// # Errors
/// When the folder is in use, not usable, or of a later version.
pub fn check(folder: &Path) -> Result<CheckReport, OpenError> {
    let of = |error: StoreError| OpenError::of(folder, error.into());
    let store = Store::open(folder).map_err(|error| OpenError::of(folder, error))?;
    let (mut tables, mut damaged_tables) = (0, Vec::new());
    for blob in store.blobs.list().map_err(of)? {
        match store.blobs.get(blob.digest) {
            Ok(bytes) => tables += usize::from(bytes.is_some()),
            Err(StoreError::Corrupt { expected, .. }) => damaged_tables.push(expected),
            Err(error) => return Err(of(error)),
        }
    }
    let catalogue = reconcile(&store.rows, store.blobs.as_ref(), &FitEngine::default()).map_err(of)?;
    Ok(CheckReport { store: store.found, catalogue, tables, damaged_tables })
}

/// Makes the catalogue agree with the blobs, both ways, and logs every difference.
pub(super) fn reconcile(
    rows: &Arc<dyn Rows>,
    blobs: &dyn Blobs,
    engine: &dyn Engine,
) -> Result<Reconciled, StoreError> {
    let catalogue = Catalogue::new(Arc::clone(rows));
    let stored: BTreeMap<Digest, Timestamp> =
        blobs.list()?.into_iter().map(|blob| (blob.digest, blob.stored_at)).collect();
    let complete: BTreeSet<Digest> = catalogue.complete()?;
    let mut done = Reconciled::default();
    for (digest, stored_at) in stored.iter().filter(|(digest, _)| !complete.contains(*digest)) {
        let bytes = match blobs.get(*digest) {
            Ok(Some(bytes)) => bytes,
            // The store has moved it to quarantine and logged it.
            Ok(None) | Err(StoreError::Corrupt { .. }) => continue,
            Err(error) => return Err(error),
        };
        let Some((recipe, recipe_digest)) = engine.recognise(&bytes) else { continue };
        let created_at = catalogue.table(*digest)?.map_or(*stored_at, |row| row.created_at);
        let row = TableRow { digest: *digest, recipe_digest, bytes: bytes.len() as u64, created_at };
        rows.commit(&Catalogue::entry(&row, &recipe)?)?;
        done.added.push(*digest);
    }
    for digest in complete.iter().filter(|digest| !stored.contains_key(*digest)) {
        tracing::error!(table = %digest, "the file of a table is missing; it is taken out of the catalogue");
        catalogue.forget(*digest)?;
        done.lost.push(*digest);
    }
    let dangling = catalogue.dangling()?;
    if !dangling.is_empty() {
        rows.commit(&dangling)?;
    }
    if !done.added.is_empty() {
        tracing::warn!(
            tables = done.added.len(),
            "tables were missing in the catalogue; it was completed from the blobs"
        );
    }
    Ok(done)
}
