//! Files that were made of textures.

use std::{ffi::OsStr, path::Path};

use super::{rounding::RoundingError, texture::TextureError};
use ltcforge_files::compact::COMPACT_MAGIC;

/// A file that was made of textures.
#[derive(Debug, Clone, PartialEq)]
pub struct TextureFile {
    /// Its path within the folder that it is written to, with `/` between names.
    pub path: String,
    /// Its bytes.
    pub bytes: Vec<u8>,
    /// The changes by rounding.
    pub rounding: RoundingError,
}

impl TextureFile {
    /// Whether bytes may be another version of this file: a text too, or bytes that begin alike, or that are as many
    /// where a format has no beginning of its own.
    #[must_use]
    pub fn resembles(&self, bytes: &[u8]) -> bool {
        let is_json = |bytes: &[u8]| serde_json::from_slice::<serde::de::IgnoredAny>(bytes).is_ok();
        let is_text = |bytes: &[u8]| !bytes.contains(&0) && str::from_utf8(bytes).is_ok();
        match Path::new(&self.path).extension().and_then(OsStr::to_str) {
            Some("json") => is_json(bytes),
            Some("bin") => self.bytes.len() == bytes.len(),
            _ if is_text(&self.bytes) && self.bytes != COMPACT_MAGIC => !bytes.is_empty() && is_text(bytes),
            _ => bytes.starts_with(&self.bytes[..self.bytes.len().min(4)]),
        }
    }
}

/// Why textures are no file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum TextureFileError {
    /// A texture that contradicts itself.
    #[error(transparent)]
    Texture(#[from] TextureError),
    /// No texture at all.
    #[error("no texture was given; a file needs one or more")]
    Empty,
    /// Two textures of one name.
    #[error("two textures are named «{name}»; each needs a name of its own")]
    SameName {
        /// The name.
        name: String,
    },
    /// A texture that the format cannot hold.
    #[error("«{name}»: {field} is {value}; {container} allows {allowed}")]
    Unsupported {
        /// The texture.
        name: String,
        /// The property that does not fit.
        field: &'static str,
        /// Its value.
        value: String,
        /// The format.
        container: &'static str,
        /// The values that the format allows.
        allowed: String,
    },
    /// An engine needs a texture that is not there.
    #[error("{engine} needs a texture «{name}» of {wanted}; there are {found}")]
    Missing {
        /// The engine.
        engine: &'static str,
        /// The texture's name.
        name: &'static str,
        /// The texture that the engine needs.
        wanted: String,
        /// The textures that there are.
        found: String,
    },
    /// The crate that writes the format refuses.
    #[error("{container}: {reason}")]
    Refused {
        /// The format.
        container: &'static str,
        /// Its reason.
        reason: String,
    },
}
