//! Uploaded tabulated BRDFs. They are the only files that the service cannot compute again.

use std::{cmp::Reverse, sync::PoisonError};

use jiff::Timestamp;
use serde::Serialize;

use super::{
    DeleteError, FileKind, FileRow, Page, Service, ServiceError, TableCursor,
    catalogue::{Catalogue, age_key},
};
use crate::{queue::StateName, store::StoreError};
use ltcforge_files::{
    digest::Digest,
    hex::to_hex,
    tabulated::{TabulatedError, decode},
};
use ltcforge_fit::{Asymmetry, TabulatedFile};

/// A stored BRDF: digest, size, and a summary.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StoredBrdf {
    /// The digest of the file. Recipes contain it.
    pub digest: Digest,
    /// The size of the file.
    pub bytes: usize,
    /// Number of nodes of each axis: alpha, `theta_o`, `theta_i` and phi, or for an anisotropic BRDF alpha, ratio,
    /// `theta_o`, `phi_o`, `theta_i` and phi.
    pub shape: Vec<usize>,
    /// The largest directional albedo, which is the fraction of uniform light that the surface reflects.
    pub albedo: f64,
    /// The deviation from reciprocity.
    pub asymmetry: Option<Asymmetry>,
}

/// Why a file was not stored.
#[derive(Debug, thiserror::Error)]
pub enum StoreBrdfError {
    /// The file is not a valid tabulated BRDF. All faults are listed.
    #[error(transparent)]
    Faults(#[from] TabulatedError),
    /// The limit of stored BRDFs is reached. The number is the limit.
    #[error(
        "{0} BRDFs are stored, which is the limit; delete unused ones with DELETE /v1/brdfs/{{digest}}, or raise \
         `--brdf-limit`"
    )]
    TooMany(usize),
    /// The service is stopping, or the store failed.
    #[error(transparent)]
    Store(#[from] ServiceError),
}

impl From<StoreError> for StoreBrdfError {
    fn from(error: StoreError) -> Self {
        Self::Store(error.into())
    }
}

fn stored(bytes: &[u8], file: &TabulatedFile) -> StoredBrdf {
    let data = file.data();
    let albedos = data.map(|data| data.albedos()).unwrap_or_default();
    StoredBrdf {
        digest: Digest::from_bytes(*file.digest()),
        bytes: bytes.len(),
        shape: data.map(|data| data.axes().shape()).unwrap_or_default(),
        albedo: albedos.iter().copied().fold(0.0, f64::max),
        asymmetry: data.and_then(|data| data.asymmetry()),
    }
}

impl Service {
    /// Stores the file of a tabulated BRDF durably. Returns whether it was stored before.
    ///
    /// # Errors
    /// See [`StoreBrdfError`]. A file with faults is not stored.
    pub fn store_brdf(&self, bytes: &[u8]) -> Result<(StoredBrdf, bool), StoreBrdfError> {
        if self.is_stopping() {
            return Err(ServiceError::Stopping.into());
        }
        let file = decode(bytes)?;
        let files = &self.state.files;
        let digest = Digest::from_bytes(*file.digest());
        let _storing = self.state.storing.lock().unwrap_or_else(PoisonError::into_inner);
        let _naming = self.state.naming.read().unwrap_or_else(PoisonError::into_inner);
        let was_there = files.contains(digest)?;
        let limit = self.state.config.brdf_limit;
        if !was_there && files.catalogue.brdfs()?.len() >= limit {
            return Err(StoreBrdfError::TooMany(limit));
        }
        files.blobs.put(bytes)?;
        if !was_there {
            let row = FileRow { digest, bytes: bytes.len() as u64, created_at: Timestamp::now() };
            files.catalogue.rows.commit(&Catalogue::brdf_entry(&row)?)?;
        }
        Ok((stored(bytes, &file), was_there))
    }

    /// Stored BRDFs, newest first.
    ///
    /// # Errors
    /// When the store fails.
    pub fn brdfs(&self, cursor: Option<&TableCursor>, limit: usize) -> Result<Page<FileRow>, ServiceError> {
        let mut rows: Vec<_> = self.state.files.catalogue.brdfs()?;
        let key = |row: &FileRow| age_key(row.created_at, row.digest);
        rows.retain(|row| cursor.is_none_or(|cursor| key(row) < cursor.0));
        rows.sort_by_key(|row| Reverse(key(row)));
        let is_last = rows.len() <= limit;
        rows.truncate(limit);
        let next = rows.last().filter(|_| !is_last).map(|row| to_hex(&key(row)));
        Ok(Page { items: rows, next })
    }

    /// Deletes a BRDF, unless the recipe of a table or of a queued or running job contains its digest.
    ///
    /// # Errors
    /// See [`DeleteError`]. After an error nothing has changed.
    pub fn delete_brdf(&self, digest: Digest) -> Result<(), DeleteError> {
        let state = &self.state;
        let _alone = state.naming.write().unwrap_or_else(PoisonError::into_inner);
        if state.files.read(FileKind::Brdf, digest)?.is_none() {
            return Err(DeleteError::UnknownBrdf(digest));
        }
        // In a cluster, a restored database can be older than the files.
        if !(state.is_complete && state.files.list_new_files()?.0) {
            return Err(DeleteError::Incomplete(digest));
        }
        // The only digests in a canonical recipe are digests of BRDFs.
        let named = digest.to_string();
        let mut recipes = state.files.catalogue.recipes()?;
        for unfinished in [StateName::Queued, StateName::Running] {
            let (jobs, _) = state.queue.list(Some(unfinished), None, usize::MAX >> 1)?;
            recipes.extend(jobs.into_iter().map(|job| job.recipe));
        }
        if recipes.iter().any(|recipe| recipe.contains(&named)) {
            return Err(DeleteError::InUse(digest));
        }
        state.files.delete(digest)?;
        state.fitter.forget_brdfs();
        Ok(())
    }
}
