//! Files of one export, and a manifest that describes them.

use serde_json::{Value, json};

use super::{about::About, file::TextureFile, rounding::RoundingError};
use ltcforge_files::digest::Digest;

/// The name of the manifest.
pub const MANIFEST: &str = "ltcforge.json";

/// The files of an export.
#[derive(Debug, Clone, PartialEq)]
pub struct Bundle {
    /// The files. The last is the manifest.
    pub files: Vec<TextureFile>,
    /// Instructions, one sentence each.
    pub steps: Vec<String>,
}

impl Bundle {
    /// Adds a manifest `ltcforge.json` to the files. It has the export's `key` and `name` (such as `for` and an
    /// engine), facts about the table, its recipe, the steps, and for each file its size in bytes, its SHA-256 and its
    /// rounding errors.
    pub(super) fn with_manifest(mut self, key: &str, name: &str, about: &About) -> Self {
        let entry = |file: &TextureFile| json!({ "path": file.path, "bytes": file.bytes.len(), "sha256": Digest::of(&file.bytes).hex(), "rounding": file.rounding });
        let files: Vec<_> = self.files.iter().map(entry).collect();
        let mut document = json!({ key: name, "about": about.lines(), "files": files, "steps": self.steps });
        // The canonical text is valid JSON.
        if let Some(recipe) = about.recipe().and_then(|text| serde_json::from_str::<Value>(text).ok()) {
            document["recipe"] = recipe;
        }
        let bytes = format!("{document:#}\n").into_bytes();
        self.files.push(TextureFile { path: MANIFEST.to_owned(), bytes, rounding: RoundingError::default() });
        self
    }
}
