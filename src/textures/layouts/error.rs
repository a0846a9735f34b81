//! Errors of texture layouts.

use crate::texture::TextureError;
use ltcforge_fit::{BrdfKind, Layout, LobeModel};

/// The table has no textures of this layout.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NoTextures {
    /// The layout has no textures.
    #[error("layout «{name}» has no textures; layouts with textures: {known}")]
    UnknownLayout {
        /// The given name.
        name: String,
        /// The known names.
        known: String,
    },
    /// The table has another layout, whose numbers do not determine these textures.
    #[error(
        "a table of layout {table} has no textures of layout {asked}; this recipe gives a table with these textures: {recipe}"
    )]
    OtherLayout {
        /// The layout of the table.
        table: Layout,
        /// The requested layout.
        asked: &'static str,
        /// A recipe for a table with these textures.
        recipe: String,
    },
    /// The table has the right layout, but lacks something that the textures need.
    #[error("textures of layout {asked} need {lacking}; this recipe gives a table with these textures: {recipe}")]
    Lacking {
        /// The requested layout.
        asked: &'static str,
        /// A description of the missing part.
        lacking: String,
        /// A recipe for a table with these textures.
        recipe: String,
    },
    /// The engine's shader has the formulas of some scattering models, in most engines only those of GGX, and the table
    /// is for another model.
    #[error(
        "{engine} needs textures of brdf {known}, but the table is of brdf {brdf}; to export its numbers for other uses, \
         choose --layout {layout} --container ktx2 (export {layout}.ktx2.f32)"
    )]
    OtherBrdf {
        /// The engine.
        engine: &'static str,
        /// The models that the engine supports.
        known: String,
        /// The scattering model of the table.
        brdf: BrdfKind,
        /// A texture layout that the table supports.
        layout: &'static str,
    },
    /// The engine uses LTCs, and the table has another lobe model.
    #[error(
        "{engine} needs textures of LTCs, but the table has lobe {lobe}; to export its numbers for other uses, \
         choose --layout {layout} --container ktx2 (export {layout}.ktx2.f32)"
    )]
    OtherLobe {
        /// The engine.
        engine: &'static str,
        /// The lobe model of the table.
        lobe: LobeModel,
        /// A texture layout that the table supports.
        layout: &'static str,
    },
    /// The axes of the table exceed the size limit of textures.
    #[error(transparent)]
    Texture(#[from] TextureError),
}
