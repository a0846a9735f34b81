//! Game engines, with one source file per engine: the layout that it loads, the names of its files, and where to put
//! them.
//!
//! Each source file states the version of the engine whose sources we read. Other versions may differ. A new engine
//! needs a source file and a line in [`Engine`].

mod babylon;
mod bevy;
mod godot;
mod hdrp;
mod o3de;
mod playcanvas;
mod rules;
mod stock;
mod three;
mod wgpu;

use self::rules::Source;
use super::{about::About, bundle::Bundle, file::TextureFileError, texture::Texture};
use ltcforge_fit::{BrdfKind, Table, named_list};

named_list! {
    /// A renderer that has area lights by LTC tables, or can use our shader.
    pub enum Engine {
        /// three.js.
        Three = "three",
        /// Babylon.js.
        Babylon = "babylon",
        /// `PlayCanvas`.
        PlayCanvas = "playcanvas",
        /// Bevy.
        Bevy = "bevy",
        /// Godot.
        Godot = "godot",
        /// Open 3D Engine.
        O3de = "o3de",
        /// Unity's High Definition Render Pipeline.
        Hdrp = "hdrp",
        /// Your own renderer, with the shader that `ltcforge shader` writes.
        Wgpu = "wgpu",
        /// Like `wgpu`, with textures of 16 bits.
        WgpuHalf = "wgpu-half",
    }
}

impl Engine {
    /// The layout of the engine's textures. `None` if it can use the layout of any table.
    #[must_use]
    pub fn layout(self) -> Option<&'static str> {
        match self {
            Self::Three | Self::Babylon | Self::PlayCanvas | Self::Bevy => Some("ltc2017"),
            Self::Godot => Some("godot"),
            Self::O3de => Some("ltc2016"),
            Self::Hdrp => Some("hdrp"),
            Self::Wgpu | Self::WgpuHalf => None,
        }
    }

    /// The scattering models that the engine's shaders support. A model with another name is included if the formulas
    /// agree.
    #[must_use]
    pub fn brdfs(self) -> &'static [BrdfKind] {
        const HDRP: [BrdfKind; 4] =
            [BrdfKind::Ggx, BrdfKind::BurleyDiffuse, BrdfKind::Charlie, BrdfKind::CharlieNeubelt];
        if self == Self::Hdrp { &HDRP } else { &HDRP[..1] }
    }

    /// The table that the engine ships for GGX; `None` for your own renderer.
    #[must_use]
    pub fn stock(self) -> Option<Table> {
        self.layout().and_then(|_| stock::published())
    }

    /// The files that this engine loads, and their manifest. `textures` must have the engine's layout, for a table of
    /// `brdf`.
    ///
    /// # Errors
    /// A texture is missing, or has the wrong size or channels.
    pub fn bundle(self, brdf: BrdfKind, textures: &[Texture], about: &About) -> Result<Bundle, TextureFileError> {
        let bundle = match self {
            Self::Three => three::bundle,
            Self::Babylon => babylon::bundle,
            Self::PlayCanvas => playcanvas::bundle,
            Self::Bevy => bevy::bundle,
            Self::Godot => godot::bundle,
            Self::O3de => o3de::bundle,
            Self::Hdrp => hdrp::bundle,
            Self::Wgpu => wgpu::bundle,
            Self::WgpuHalf => wgpu::half_bundle,
        };
        let bundle = bundle(&Source { engine: self.name(), textures, about, brdf })?;
        Ok(bundle.with_manifest("for", self.name(), about))
    }
}

#[cfg(test)]
mod tests;
