//! Why a figure could not be drawn.

use crate::preview::PreviewError;
use ltcforge_files::recipe_document::RecipeError;
use ltcforge_textures::NoTextures;

/// Why a figure could not be drawn.
#[derive(Debug, thiserror::Error)]
pub enum FigureError {
    /// A recipe of a figure is not one of this version.
    #[error(transparent)]
    Recipe(#[from] RecipeError),
    /// The renderer's error.
    #[error(transparent)]
    Preview(#[from] PreviewError),
    /// The textures of a table.
    #[error(transparent)]
    Textures(#[from] NoTextures),
    /// The fit was stopped.
    #[error("the fit was stopped")]
    Stopped,
}
