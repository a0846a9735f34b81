//! What engines load, one file each: which layout, which files under which names, and where they go.
//!
//! What an engine expects was read in its sources, in the version that its file names; a new version may differ. A new
//! engine needs a file and a line in [`Engine`].

mod babylon;
mod bevy;
mod godot;
mod hdrp;
mod o3de;
mod playcanvas;
mod rules;
mod three;
mod wgpu;

use serde_json::json;

pub use self::rules::Bundle;
pub(crate) use self::rules::{EngineRules, Source};
use super::{
    about::About,
    file::{TextureFile, TextureFileError},
    rounding::RoundingError,
    texture::Texture,
};
use crate::{
    files::digest::Digest,
    fit::{PerAxis, named_list::named_list},
};

named_list! {
    /// A renderer that has area lights by LTC tables, or that takes ours.
    pub enum Engine: EngineRules {
        /// three.js.
        Three = "three" => three::Rules,
        /// Babylon.js.
        Babylon = "babylon" => babylon::Rules,
        /// `PlayCanvas`.
        PlayCanvas = "playcanvas" => playcanvas::Rules,
        /// Bevy.
        Bevy = "bevy" => bevy::Rules,
        /// Godot.
        Godot = "godot" => godot::Rules,
        /// Open 3D Engine.
        O3de = "o3de" => o3de::Rules,
        /// Unity's High Definition Render Pipeline.
        Hdrp = "hdrp" => hdrp::Rules,
        /// A renderer of one's own with the shader that `ltcforge shader` writes.
        Wgpu = "wgpu" => wgpu::Rules,
    }
}

/// A file beside an engine's own that tells what they are.
const MANIFEST: &str = "ltcforge.json";

impl Engine {
    /// The layout of its textures; `None` for that of the table.
    #[must_use]
    pub fn layout(self) -> Option<&'static str> {
        self.rules().layout()
    }

    /// The files that this engine loads, made of textures of its layout.
    ///
    /// # Errors
    /// When a texture is missing, or its size or channels are not those of the engine.
    pub fn bundle(
        self,
        textures: &[Texture],
        axes: &PerAxis<Vec<f64>>,
        about: &About,
    ) -> Result<Bundle, TextureFileError> {
        let mut bundle = self.rules().bundle(&Source { engine: self.name(), textures, axes, about })?;
        let manifest = manifest(self, &bundle, about);
        bundle.files.push(manifest);
        Ok(bundle)
    }
}

/// The digest, size and rounding of each file.
fn manifest(engine: Engine, bundle: &Bundle, about: &About) -> TextureFile {
    let entry = |file: &TextureFile| json!({ "path": file.path, "bytes": file.bytes.len(), "sha256": Digest::of(&file.bytes).hex(), "rounding": file.rounding });
    let files: Vec<_> = bundle.files.iter().map(entry).collect();
    let document = json!({ "for": engine, "about": about.lines(), "files": files, "steps": bundle.steps });
    let bytes = format!("{document:#}\n").into_bytes();
    TextureFile { path: MANIFEST.to_owned(), bytes, rounding: RoundingError::default() }
}

#[cfg(test)]
mod tests;
