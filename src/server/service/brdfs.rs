//! The files of tabulated BRDFs. They are blobs beside those of tables, named by their digests alike.

use serde::Serialize;

use super::{Service, ServiceError};
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
    /// Nodes of alpha, `theta_o`, `theta_i` and phi.
    pub shape: [usize; 4],
    /// The most that it reflects of even light.
    pub albedo: f64,
    /// How far it is from reciprocity.
    pub asymmetry: Option<Asymmetry>,
}

/// Why a file was not stored.
#[derive(Debug, thiserror::Error)]
pub enum StoreBrdfError {
    /// It is no tabulated BRDF; all faults are listed.
    #[error(transparent)]
    Faults(#[from] TabulatedError),
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
        shape: data.map(|data| data.axes().lengths()).unwrap_or_default(),
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
        let was_there = blobs.contains(digest).map_err(ServiceError::from)?;
        blobs.put(bytes).map_err(ServiceError::from)?;
        Ok((stored(bytes, &file), was_there))
    }
}
