//! The files of tabulated BRDFs. They are blobs beside those of tables, named by their digests alike.

use std::sync::PoisonError;

use serde::Serialize;

use super::{FileKind, FileRow, Page, Service, ServiceError, TableCursor, find_brdf::used_brdfs};
use crate::store::StoreError;
use ltcforge_files::{
    digest::Digest,
    tabulated::{TabulatedError, decode},
};
use ltcforge_fit::{Asymmetry, TabulatedFile};

/// A stored file: its digest, its size and its contents in brief.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StoredBrdf {
    /// Its digest, which recipes name.
    pub digest: Digest,
    /// Its size.
    pub bytes: usize,
    /// Nodes of alpha, `theta_o`, `theta_i` and phi; of an anisotropic one those of ratio after alpha, and of `phi_o` after
    /// `theta_o`.
    pub shape: Vec<usize>,
    /// The most that it reflects of even light.
    pub albedo: f64,
    /// How far it is from reciprocity.
    pub asymmetry: Option<Asymmetry>,
}

/// Why a file was not deleted.
#[derive(Debug, thiserror::Error)]
pub enum DeleteBrdfError {
    /// It is not stored.
    #[error("no BRDF with the digest {0} is stored")]
    Unknown(Digest),
    /// It is needed.
    #[error("the recipe of a table, or of a job that waits or runs, names {0}")]
    InUse(Digest),
    /// The store failed.
    #[error(transparent)]
    Store(#[from] ServiceError),
}

impl From<StoreError> for DeleteBrdfError {
    fn from(error: StoreError) -> Self {
        Self::Store(error.into())
    }
}

/// Why a file was not stored.
#[derive(Debug, thiserror::Error)]
pub enum StoreBrdfError {
    /// It is no tabulated BRDF; all faults are listed.
    #[error(transparent)]
    Faults(#[from] TabulatedError),
    /// As many are stored as may be.
    #[error(
        "{0} BRDFs are stored, as many as the service keeps; DELETE /v1/brdfs/{{digest}} removes one that nothing names, and \
         `--brdf-limit` of the service raises the limit"
    )]
    TooMany(usize),
    /// The service is stopping, or the store failed.
    #[error(transparent)]
    Store(#[from] ServiceError),
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
    /// Stores the file of a tabulated BRDF, and tells whether it was there before. It is durable when this returns.
    ///
    /// # Errors
    /// See [`StoreBrdfError`]; a file with faults is not stored.
    pub fn store_brdf(&self, bytes: &[u8]) -> Result<(StoredBrdf, bool), StoreBrdfError> {
        if self.is_stopping() {
            return Err(ServiceError::Stopping.into());
        }
        let file = decode(bytes)?;
        let blobs = &self.state.tables.store.blobs;
        let digest = Digest::from_bytes(*file.digest());
        let _storing = self.state.storing.lock().unwrap_or_else(PoisonError::into_inner);
        let _naming = self.state.naming.read().unwrap_or_else(PoisonError::into_inner);
        let was_there = blobs.contains(digest).map_err(ServiceError::from)?;
        let limit = self.state.config.brdf_limit;
        if !was_there && self.stored_files(FileKind::Brdf).map_err(ServiceError::from)?.len() >= limit {
            return Err(StoreBrdfError::TooMany(limit));
        }
        blobs.put(bytes).map_err(ServiceError::from)?;
        self.state.tables.uses.note(digest);
        Ok((stored(bytes, &file), was_there))
    }

    /// Stored files, newest first.
    ///
    /// # Errors
    /// When the store fails.
    pub fn brdfs(&self, cursor: Option<&TableCursor>, limit: usize) -> Result<Page<FileRow>, ServiceError> {
        self.files(FileKind::Brdf, cursor, limit)
    }

    /// Deletes a stored file that no recipe of a table, or of a job that waits or runs, names.
    ///
    /// # Errors
    /// See [`DeleteBrdfError`]; then nothing has changed.
    pub fn delete_brdf(&self, digest: Digest) -> Result<(), DeleteBrdfError> {
        let state = &self.state;
        let _deleting = state.naming.write().unwrap_or_else(PoisonError::into_inner);
        let blobs = &state.tables.store.blobs;
        let is_used =
            || Ok::<_, StoreError>(used_brdfs(&state.tables.catalogue, state.queue.as_ref())?.contains(&digest));
        if state.tables.length(FileKind::Brdf, digest)?.is_none() {
            return Err(DeleteBrdfError::Unknown(digest));
        }
        if is_used()? {
            return Err(DeleteBrdfError::InUse(digest));
        }
        // Another process may make a job of it meanwhile, and then keeps the file too.
        let bytes = if state.queue.is_local() { None } else { blobs.get(digest)? };
        blobs.delete(digest)?;
        state.backend.forget_files();
        match bytes {
            Some(bytes) if is_used()? => {
                blobs.put(&bytes)?;
                Err(DeleteBrdfError::InUse(digest))
            }
            _ => Ok(()),
        }
    }
}
