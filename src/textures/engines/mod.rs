//! Game engines, one file each: the layout that an engine loads, the files and their names, and where they go.
//!
//! An engine's expectations were read in its sources, in the version that its file names; a new version may differ. A
//! new engine needs a file and a line in [`Engine`].

mod babylon;
mod bevy;
mod godot;
mod hdrp;
mod o3de;
mod playcanvas;
mod rules;
mod three;
mod wgpu;

pub(crate) use self::rules::{EngineRules, Source};
use super::{about::About, bundle::Bundle, file::TextureFileError, texture::Texture};
use ltcforge_fit::{BrdfKind, ShaderAxes, named_list};

named_list! {
    /// A renderer that has area lights by LTC tables, or that takes ours.
    pub enum Engine: EngineRules {
        /// three.js.
        Three = "three" => three::Three,
        /// Babylon.js.
        Babylon = "babylon" => babylon::Babylon,
        /// `PlayCanvas`.
        PlayCanvas = "playcanvas" => playcanvas::PlayCanvas,
        /// Bevy.
        Bevy = "bevy" => bevy::Bevy,
        /// Godot.
        Godot = "godot" => godot::Godot,
        /// Open 3D Engine.
        O3de = "o3de" => o3de::O3de,
        /// Unity's High Definition Render Pipeline.
        Hdrp = "hdrp" => hdrp::Hdrp,
        /// A renderer of one's own with the shader that `ltcforge shader` writes.
        Wgpu = "wgpu" => wgpu::Wgpu,
    }
}

impl Engine {
    /// The layout of its textures; `None` for that of the table.
    #[must_use]
    pub fn layout(self) -> Option<&'static str> {
        self.rules().layout()
    }

    /// The scattering models whose textures it lights with.
    #[must_use]
    pub fn brdfs(self) -> &'static [BrdfKind] {
        self.rules().brdfs()
    }

    /// The files that this engine loads, made of textures of its layout of a table of `brdf`, and their manifest.
    ///
    /// # Errors
    /// When a texture is missing, or its size or channels are not those of the engine.
    pub fn bundle(
        self,
        brdf: BrdfKind,
        textures: &[Texture],
        axes: &ShaderAxes,
        about: &About,
    ) -> Result<Bundle, TextureFileError> {
        let bundle = self.rules().bundle(&Source { engine: self.name(), textures, axes, about, brdf })?;
        Ok(bundle.with_manifest("for", self.name(), about))
    }
}

#[cfg(test)]
mod tests;
