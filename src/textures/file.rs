//! Files that contain textures.

use std::{ffi::OsStr, path::Path};

use super::{rounding::RoundingError, texture::TextureError};
use ltcforge_files::compact::COMPACT_MAGIC;

/// A file that contains textures.
#[derive(Debug, Clone, PartialEq)]
pub struct TextureFile {
    /// The path within the destination folder, with `/` as separator.
    pub path: String,
    /// The bytes of the file.
    pub bytes: Vec<u8>,
    /// The rounding errors.
    pub rounding: RoundingError,
}

impl TextureFile {
    /// Whether the given bytes look like another version of this file. For a JSON file they must be JSON, and for other
    /// text they must be text. For a format without a magic number, they must have the same length as the file. For
    /// other formats, they must start with the same bytes.
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

/// The textures cannot be written as files.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum TextureFileError {
    /// A texture is inconsistent.
    #[error(transparent)]
    Texture(#[from] TextureError),
    /// The list of textures is empty.
    #[error("no texture was given; a file needs one or more")]
    Empty,
    /// Two textures have the same name.
    #[error("two textures are named «{name}»; each needs a different name")]
    SameName {
        /// The name.
        name: String,
    },
    /// The format cannot store a texture.
    #[error("«{name}»: {field} is {value}; {container} allows {allowed}")]
    Unsupported {
        /// The name of the texture.
        name: String,
        /// The unsupported property.
        field: &'static str,
        /// The value of the property.
        value: String,
        /// The format.
        container: &'static str,
        /// The allowed values.
        allowed: String,
    },
    /// A texture that an engine needs is missing.
    #[error("{engine} needs a texture «{name}» with {wanted}, but the table gives {found}")]
    Missing {
        /// The engine.
        engine: &'static str,
        /// The name of the texture.
        name: &'static str,
        /// The required texture.
        wanted: String,
        /// The textures of the table.
        found: String,
    },
    /// The crate for the format returned an error.
    #[error("{container}: {reason}")]
    Refused {
        /// The format.
        container: &'static str,
        /// The message of the crate.
        reason: String,
    },
}
