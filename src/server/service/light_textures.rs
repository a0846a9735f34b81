//! Prefiltered pictures of lights. They are blobs beside those of tables, in KTX2, named by their digests alike. No recipe
//! names one, so that only those who sent it know whether it is needed.

use std::sync::PoisonError;

use serde::Serialize;

use super::{FileKind, FileRow, Page, Service, ServiceError, TableCursor};
use crate::store::StoreError;
use ltcforge_files::digest::Digest;
use ltcforge_textures::{
    LightSize, LightTexels, LightTexture, LightTextureError, LightTextureOptions, TextureContainer, TransferFunction,
    light_texture,
};

/// Most pixels of a picture that is sent, and most texels that are made of it: some 300 MB of memory.
pub const LIGHT_TEXTURE_PIXELS: u64 = 1 << 22;

/// The bytes at the start of a file that tell a light texture.
pub(super) const LIGHT_TEXTURE_START: usize = 16;

/// What to make of a picture that is sent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightTextureRequest {
    /// The light on which texels are square; `None` where they are already.
    pub light: Option<LightSize>,
    /// What its numbers stand for; `None` for what it says.
    pub transfer: Option<TransferFunction>,
    /// How texels are stored.
    pub texels: LightTexels,
    /// Whether the file is compressed.
    pub zstd: bool,
}

/// A stored file: its digest, its size and its contents in brief.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StoredLightTexture {
    /// Its digest.
    pub digest: Digest,
    /// Its size.
    pub bytes: usize,
    /// What was made of which picture.
    #[serde(flatten)]
    pub texture: LightTexture,
}

/// Why a picture was not stored.
#[derive(Debug, thiserror::Error)]
pub enum StoreLightTextureError {
    /// It is no picture of a light, or too large.
    #[error(transparent)]
    Picture(#[from] LightTextureError),
    /// As many are stored as may be.
    #[error(
        "{0} light textures are stored, as many as the service keeps; DELETE /v1/light-textures/{{digest}} removes one, and \
         `--light-texture-limit` of the service raises the limit"
    )]
    TooMany(usize),
    /// The service is stopping, or the store failed.
    #[error(transparent)]
    Store(#[from] ServiceError),
}

/// Why a file was not deleted.
#[derive(Debug, thiserror::Error)]
pub enum DeleteLightTextureError {
    /// It is not stored.
    #[error("no light texture with the digest {0} is stored")]
    Unknown(Digest),
    /// The store failed.
    #[error(transparent)]
    Store(#[from] ServiceError),
}

impl From<StoreError> for DeleteLightTextureError {
    fn from(error: StoreError) -> Self {
        Self::Store(error.into())
    }
}

impl Service {
    /// Prefilters a picture and stores the file, and tells whether it was there before. It is durable when this returns.
    ///
    /// # Errors
    /// See [`StoreLightTextureError`]; then nothing is stored.
    pub fn store_light_texture(
        &self,
        picture: &[u8],
        request: LightTextureRequest,
    ) -> Result<(StoredLightTexture, bool), StoreLightTextureError> {
        if self.is_stopping() {
            return Err(ServiceError::Stopping.into());
        }
        let LightTextureRequest { light, transfer, texels, zstd } = request;
        let container = if zstd { TextureContainer::Ktx2Zstd } else { TextureContainer::Ktx2 };
        let options = LightTextureOptions { light, transfer, container, texels, most_pixels: LIGHT_TEXTURE_PIXELS };
        let mut texture = self.state.measuring_pool.install(|| light_texture(picture, "light", &options))?;
        // KTX2 holds all levels in one file.
        let bytes = std::mem::take(&mut texture.files).into_iter().flat_map(|file| file.bytes).collect::<Vec<u8>>();
        let blobs = &self.state.tables.store.blobs;
        let digest = Digest::of(&bytes);
        let _storing = self.state.storing.lock().unwrap_or_else(PoisonError::into_inner);
        let _naming = self.state.naming.read().unwrap_or_else(PoisonError::into_inner);
        let was_there = blobs.contains(digest).map_err(ServiceError::from)?;
        let limit = self.state.config.light_texture_limit;
        if !was_there && self.stored_files(FileKind::LightTexture).map_err(ServiceError::from)?.len() >= limit {
            return Err(StoreLightTextureError::TooMany(limit));
        }
        blobs.put(&bytes).map_err(ServiceError::from)?;
        self.state.tables.uses.note(digest);
        Ok((StoredLightTexture { digest, bytes: bytes.len(), texture }, was_there))
    }

    /// Stored files, newest first.
    ///
    /// # Errors
    /// When the store fails.
    pub fn light_textures(&self, cursor: Option<&TableCursor>, limit: usize) -> Result<Page<FileRow>, ServiceError> {
        self.files(FileKind::LightTexture, cursor, limit)
    }

    /// Deletes a stored file.
    ///
    /// # Errors
    /// See [`DeleteLightTextureError`].
    pub fn delete_light_texture(&self, digest: Digest) -> Result<(), DeleteLightTextureError> {
        let tables = &self.state.tables;
        if tables.length(FileKind::LightTexture, digest)?.is_none() {
            return Err(DeleteLightTextureError::Unknown(digest));
        }
        tables.store.blobs.delete(digest)?;
        Ok(())
    }
}
