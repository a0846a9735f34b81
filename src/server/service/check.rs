//! The check of a whole data folder.

use std::path::Path;

use serde::Serialize;

use super::{OpenError, Reconciled, backend::FitBackend, reconcile::reconcile};
use crate::store::{Damage, DryRun, Store, StoreError};
use ltcforge_files::{digest::Digest, tabulated};
use ltcforge_textures::is_light_texture;

/// The findings of [`check`] in a data folder.
#[derive(Debug, Serialize)]
pub struct CheckReport {
    /// Damage of the database and the journal.
    pub store: Damage,
    /// Differences between the catalogue and the tables.
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
        let Self { store, catalogue, damaged_tables, .. } = self;
        *store == Damage::default() && *catalogue == Reconciled::default() && damaged_tables.is_empty()
    }
}

/// Checks everything in a data folder and changes nothing in it: a start is tried on a copy of the database and the
/// journal, and every blob is hashed.
///
/// # Errors
/// When the folder has no store, is in use, not usable, or of a later version.
pub fn check(folder: &Path) -> Result<CheckReport, OpenError> {
    let of = |error: StoreError| OpenError::of(folder, error.into());
    let copy = DryRun::of(folder).map_err(|error| OpenError::of(folder, error))?;
    let copy = copy.ok_or_else(|| OpenError::NoStore(folder.to_owned()))?;
    let store = Store::open(copy.folder()).map_err(|error| OpenError::of(folder, error))?;
    let (mut tables, mut damaged_tables) = (0, Vec::new());
    for blob in store.blobs.list().map_err(of)? {
        match store.blobs.get(blob.digest) {
            // Files that users sent lie beside them.
            Ok(bytes) => {
                let is_table = |bytes: &[u8]| !is_light_texture(bytes) && tabulated::decode(bytes).is_err();
                tables += usize::from(bytes.is_some_and(|bytes| is_table(&bytes)));
            }
            Err(StoreError::Corrupt { expected, .. }) => damaged_tables.push(expected),
            Err(error) => return Err(of(error)),
        }
    }
    let mut catalogue = reconcile(&store.rows, store.blobs.as_ref(), &FitBackend::new(None)).map_err(of)?;
    // The files of damaged tables are not missing.
    for missing in [&mut catalogue.lost, &mut catalogue.missing_brdfs] {
        missing.retain(|digest| !damaged_tables.contains(digest));
    }
    Ok(CheckReport { store: store.damage, catalogue, tables, damaged_tables })
}
