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
    /// A recipe of a figure is not valid in this version.
    #[error(transparent)]
    Recipe(#[from] RecipeError),
    /// The renderer's error.
    #[error(transparent)]
    Preview(#[from] PreviewError),
    /// The light of a model.
    #[error(transparent)]
    Light(#[from] LightError),
    /// The textures of a table.
    #[error(transparent)]
    Textures(#[from] NoTextures),
    /// The picture as a PNG.
    #[error(transparent)]
    Png(#[from] PngError),
    /// A file that cannot be written.
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
