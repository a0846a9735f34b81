//! The interface of a layout of textures.

use super::error::NoTextures;
use crate::texture::{Texture, TextureError};
use ltcforge_fit::{Layout, Table};

/// What the coordinate of a texture is, along one of its axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TextureAxis {
    /// `x`, `y`, `z` or `layer`.
    pub axis: &'static str,
    /// What it is of, as a formula.
    pub coordinate: &'static str,
}

/// One of the textures of a layout.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TexturesOf {
    /// Its name.
    pub name: &'static str,
    /// What the numbers of a texel are.
    pub channels: &'static [&'static str],
    /// What the channels mean.
    pub meaning: &'static str,
}

/// A layout of textures, for people and for what writes them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TextureSampling {
    /// The layout of the tables that have these textures.
    pub table: Layout,
    /// The axes, and where their texels are.
    pub axes: &'static [TextureAxis],
    /// The textures, in the order in which they are given.
    pub textures: &'static [TexturesOf],
    /// How the matrix is scaled.
    pub normalisation: &'static str,
    /// A recipe whose table has these textures.
    pub recipe: &'static str,
}

/// A layout as an item of [`super::TextureLayout`].
pub(crate) trait TextureRules: Sync {
    /// What the layout is.
    fn sampling(&self) -> TextureSampling;

    /// What the table lacks, of those of the right layout.
    fn lacks(&self, table: &Table) -> Option<String>;

    /// The numbers of a texel: entry and texture.
    fn textures(&self, table: &Table) -> Result<Vec<Texture>, NoTextures>;
}

/// A texture of a layout, made of the numbers of its texels in their order.
pub(super) fn made(
    of: &TexturesOf,
    sides: [usize; 3],
    layers: usize,
    texels: Vec<f32>,
) -> Result<Texture, TextureError> {
    let side = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    Texture::new(of.name, sides.map(side), side(layers), of.channels, texels)
}
