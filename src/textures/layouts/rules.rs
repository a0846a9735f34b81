//! The interface of a texture layout.

use super::error::NoTextures;
use crate::texture::{Texture, TextureError};
use ltcforge_fit::{BrdfKind, Layout, Table};

/// The coordinate along one axis of a texture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TextureAxis {
    /// `x`, `y`, `z` or `layer`.
    pub axis: &'static str,
    /// The coordinate as a formula.
    pub coordinate: &'static str,
}

/// One of the textures of a layout.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TexturesOf {
    /// The name of the texture.
    pub name: &'static str,
    /// The names of a texel's channels.
    pub channels: &'static [&'static str],
    /// The meaning of the channels.
    pub meaning: &'static str,
}

/// The description of a texture layout, for people and for code that writes files.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TextureSampling {
    /// The layout of the tables that have these textures.
    pub table: Layout,
    /// The axes of the textures, with the coordinates of their texels.
    pub axes: &'static [TextureAxis],
    /// The textures, in order.
    pub textures: &'static [TexturesOf],
    /// The scale of the matrix.
    pub normalisation: &'static str,
    /// A recipe for a table with these textures.
    pub recipe: &'static str,
}

/// The rules of an item of [`super::TextureLayout`].
pub(crate) trait TextureRules: Sync {
    /// The description of the layout.
    fn sampling(&self) -> TextureSampling;

    /// The parts that a table of the right layout lacks. `None` if it lacks nothing.
    fn lacks(&self, _: &Table) -> Option<String> {
        None
    }

    /// Whether a table for this scattering model can have these textures, if the table layout supports the model.
    fn takes(&self, _: BrdfKind) -> bool {
        true
    }

    /// Whether the shader of `ltcforge shader` reads these textures. Only these can store a second lobe.
    fn is_for_shader(&self) -> bool {
        false
    }

    /// The textures of a table.
    fn textures(&self, table: &Table) -> Result<Vec<Texture>, NoTextures>;
}

/// A texture, from the numbers of its texels in order.
pub(super) fn made(
    of: &TexturesOf,
    sides: [usize; 3],
    layers: usize,
    texels: Vec<f32>,
) -> Result<Texture, TextureError> {
    let side = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    Texture::new(of.name, sides.map(side), side(layers), of.channels, texels)
}
