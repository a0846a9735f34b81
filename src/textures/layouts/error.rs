//! Why a table has no textures.

use crate::texture::TextureError;
use ltcforge_fit::{BrdfKind, Layout, LobeModel};

/// Why a table has no textures of a layout.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NoTextures {
    /// A layout without textures.
    #[error("there are no textures of layout «{name}»; there are of {known}")]
    UnknownLayout {
        /// Its name.
        name: String,
        /// Those that there are.
        known: String,
    },
    /// The table has another layout, and what it stores does not tell the numbers of this one.
    #[error(
        "the table has layout {table}, so it has no textures of layout {asked}; this recipe gives one that has: {recipe}"
    )]
    OtherLayout {
        /// That of the table.
        table: Layout,
        /// The one that was asked for.
        asked: &'static str,
        /// A recipe whose table has them.
        recipe: String,
    },
    /// The table has the right layout, but not all that the textures need.
    #[error("textures of layout {asked} need {lacking}; this recipe gives a table that has them: {recipe}")]
    Lacking {
        /// The layout that was asked for.
        asked: &'static str,
        /// What the table lacks, in words.
        lacking: String,
        /// A recipe whose table has them.
        recipe: String,
    },
    /// An engine lights some scattering models with its files, most GGX alone, and the table is of another.
    #[error(
        "{engine} takes its textures for those of brdf {known}, and the table is of brdf {brdf}; its numbers in files of one's own \
         are export {layout}.ktx2.f32: --layout {layout} --container ktx2"
    )]
    OtherBrdf {
        /// The engine.
        engine: &'static str,
        /// The models that it lights.
        known: String,
        /// The scattering model of the table.
        brdf: BrdfKind,
        /// A layout of textures that the table has.
        layout: &'static str,
    },
    /// An engine lights by LTCs, and the table is of another lobe model.
    #[error(
        "{engine} takes its textures for those of LTCs, and the table has lobe {lobe}; its numbers in files of one's own \
         are export {layout}.ktx2.f32: --layout {layout} --container ktx2"
    )]
    OtherLobe {
        /// The engine.
        engine: &'static str,
        /// The lobe model of the table.
        lobe: LobeModel,
        /// A layout of textures that the table has.
        layout: &'static str,
    },
    /// A table whose axes are longer than textures.
    #[error(transparent)]
    Texture(#[from] TextureError),
}
