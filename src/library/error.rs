//! The error of the library.

use std::{io, path::PathBuf};

use ltcforge_files::{container::TableFileError, recipe_document::RecipeError, tabulated::TabulatedError};
use ltcforge_light::LightError;

/// Why a call of the library failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A recipe has faults; all of them are listed.
    #[error(transparent)]
    Recipe(#[from] RecipeError),
    /// The progress callback stopped the fit.
    #[error("the fit was stopped")]
    Stopped,
    /// No threads could be started.
    #[error("no threads for the fit: {0}")]
    Threads(String),
    /// Bytes are not a tabulated BRDF; all faults are listed.
    #[error(transparent)]
    Tabulated(#[from] TabulatedError),
    /// Bytes are not a table.
    #[error(transparent)]
    Table(#[from] TableFileError),
    /// A light is invalid, or its reflection cannot be computed.
    #[error(transparent)]
    Light(#[from] LightError),
    /// A file cannot be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// Bytes are not a picture of a light.
    #[cfg(feature = "textures")]
    #[error(transparent)]
    Picture(#[from] ltcforge_textures::LightFileError),
    /// A shader cannot be translated.
    #[cfg(feature = "shaders")]
    #[error(transparent)]
    Shader(#[from] ltcforge_translate::PortError),
}
