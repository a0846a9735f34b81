//! The interface of a layout of textures.

use super::error::NoTextures;
use crate::texture::{Texture, TextureError};
use ltcforge_fit::{BrdfKind, Layout, Table};

/// The coordinate along one axis of a texture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TextureAxis {
    /// `x`, `y`, `z` or `layer`.
    pub axis: &'static str,
    /// The coordinate, as a formula.
    pub coordinate: &'static str,
}

/// One of the textures of a layout.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TexturesOf {
    /// Its name.
    pub name: &'static str,
    /// The names of a texel's numbers.
    pub channels: &'static [&'static str],
    /// The meaning of the channels.
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
    /// The description of the layout.
    fn sampling(&self) -> TextureSampling;

    /// The parts that a table of the right layout lacks; `None` if it has all.
    fn lacks(&self, _: &Table) -> Option<String> {
        None
    }

    /// Whether a recipe of this scattering model gives a table that has them, if the table's layout takes the model.
    fn takes(&self, _: BrdfKind) -> bool {
        true
    }

    /// Whether its readers know a second lobe.
    fn takes_two_lobes(&self) -> bool {
        false
    }

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
