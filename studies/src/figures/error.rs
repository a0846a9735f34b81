//! The errors of figures.

use std::{io, path::PathBuf};

use ltcforge::{
    LightError,
    files::recipe_document::RecipeError,
    textures::NoTextures,
    view::{picture::PngError, preview::PreviewError},
};

/// The reason that a figure could not be drawn.
#[derive(Debug, thiserror::Error)]
pub enum FigureError {
    /// The recipe of a figure is invalid in this version.
    #[error(transparent)]
    Recipe(#[from] RecipeError),
    /// The renderer failed.
    #[error(transparent)]
    Preview(#[from] PreviewError),
    /// The light of a model could not be computed.
    #[error(transparent)]
    Light(#[from] LightError),
    /// A table has no textures of the requested layout.
    #[error(transparent)]
    Textures(#[from] NoTextures),
    /// The picture could not be written as PNG.
    #[error(transparent)]
    Png(#[from] PngError),
    /// A file could not be written.
    #[error("{}: {source}", .path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// The fit was stopped.
    #[error("the fit was stopped")]
    Stopped,
}
