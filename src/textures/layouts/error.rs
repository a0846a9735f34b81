//! Errors of textures of a layout.

use crate::texture::TextureError;
use ltcforge_fit::{BrdfKind, Layout, LobeModel};

/// The table has no textures of a layout.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NoTextures {
    /// The layout has no textures.
    #[error("layout «{name}» has no textures; layouts with textures: {known}")]
    UnknownLayout {
        /// The name that was given.
        name: String,
        /// The known names.
        known: String,
    },
    /// The table has another layout, whose numbers do not determine these textures.
    #[error(
        "a table of layout {table} has no textures of layout {asked}; this recipe gives a table that has them: {recipe}"
    )]
    OtherLayout {
        /// The layout of the table.
        table: Layout,
        /// The requested layout.
        asked: &'static str,
        /// A recipe whose table has them.
        recipe: String,
    },
    /// The table has the right layout, but lacks something that the textures need.
    #[error("textures of layout {asked} need {lacking}; this recipe gives a table that has them: {recipe}")]
    Lacking {
        /// The requested layout.
        asked: &'static str,
        /// A description of the missing part.
        lacking: String,
        /// A recipe whose table has them.
        recipe: String,
    },
    /// The engine's shader has the formulas of some scattering models, mostly GGX only, and the table is of another
    /// model.
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
        /// A layout of textures that the table has.
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
        /// A layout of textures that the table has.
        layout: &'static str,
    },
    /// The axes of the table are longer than textures can be.
    #[error(transparent)]
    Texture(#[from] TextureError),
}
