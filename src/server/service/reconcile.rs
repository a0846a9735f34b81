//! The catalogue compared with the blobs.

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
};

use jiff::Timestamp;
use serde::Serialize;

use super::{TableRow, backend::Backend, find_brdf::named_in, uses::use_of};
use crate::{
    queue::embedded::stored_jobs,
    store::{Blobs, Catalogue, Rows, StoreError, Tree},
};
use ltcforge_files::digest::Digest;

/// The changes that made the catalogue agree with the blobs.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Reconciled {
    /// Blobs that are tables and were missing in the catalogue, or in its list or its recipes.
    pub added: Vec<Digest>,
    /// Tables of the catalogue whose blob is missing. They are taken out, so that their recipes are fitted again.
    pub lost: Vec<Digest>,
    /// Tabulated BRDFs that recipes of tables and unfinished jobs name, and whose file is missing. Only their users have them.
    pub missing_brdfs: Vec<Digest>,
}

/// On a full disk the catalogue stays as it is, and is mended later.
pub(super) fn unless_full(written: Result<(), StoreError>) -> Result<(), StoreError> {
    if matches!(written, Err(StoreError::DiskFull)) { Ok(()) } else { written }
}

/// Makes the catalogue agree with the blobs, both ways, and logs every difference.
pub(super) fn reconcile(
    rows: &Arc<dyn Rows>,
    blobs: &dyn Blobs,
    backend: &dyn Backend,
) -> Result<Reconciled, StoreError> {
    let catalogue = Catalogue::new(Arc::clone(rows));
    let stored: BTreeMap<Digest, Timestamp> =
        blobs.list()?.into_iter().map(|blob| (blob.digest, blob.stored_at)).collect();
    let complete: BTreeSet<Digest> = catalogue.complete()?;
    let (recipes, jobs) = (catalogue.recipes()?, stored_jobs(rows.as_ref())?);
    let unfinished = jobs.iter().map(|stored| &stored.job).filter(|job| !job.state.name().is_final());
    let recipes = recipes.iter().chain(unfinished.map(|job| &job.recipe));
    let named: BTreeSet<Digest> = recipes.filter_map(|recipe| named_in(recipe)).collect();
    let mut done = Reconciled::default();
    for (digest, stored_at) in stored.iter().filter(|(digest, _)| !complete.contains(*digest)) {
        let bytes = match blobs.get(*digest) {
            Ok(Some(bytes)) => bytes,
            // The store has moved it to quarantine and logged it.
            Ok(None) | Err(StoreError::Corrupt { .. }) => continue,
            Err(error) => return Err(error),
        };
        let Some((recipe, recipe_digest)) = backend.recognise(&bytes) else { continue };
        // Of a table that was removed the last step is still to be done.
        if use_of(rows.as_ref(), *digest)?.and_then(|row| row.removed).is_some_and(|removed| removed.has_file) {
            continue;
        }
        let created_at = catalogue.table(*digest)?.map_or(*stored_at, |row| row.created_at);
        let row = TableRow { digest: *digest, recipe_digest, bytes: bytes.len() as u64, created_at };
        let mut batch = Catalogue::entry(&row, &recipe)?;
        batch.remove(Tree::Uses, *digest.as_bytes());
        unless_full(rows.commit(&batch))?;
        done.added.push(*digest);
    }
    for digest in complete.iter().filter(|digest| !stored.contains_key(*digest)) {
        tracing::error!(table = %digest, "the file of a table is missing; it is taken out of the catalogue");
        unless_full(catalogue.forget(*digest).map(drop))?;
        done.lost.push(*digest);
    }
    done.missing_brdfs = named.into_iter().filter(|digest| !stored.contains_key(digest)).collect();
    for brdf in &done.missing_brdfs {
        tracing::error!(%brdf, "the file of a tabulated BRDF is missing, and recipes name it; send it to /v1/brdfs again");
    }
    if !done.added.is_empty() {
        tracing::warn!(
            tables = done.added.len(),
            "tables were missing in the catalogue; it was completed from the blobs"
        );
    }
    Ok(done)
}
