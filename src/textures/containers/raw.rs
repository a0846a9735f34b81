//! Only the numbers, little-endian, and a JSON document that describes them.

use serde_json::json;

use super::{json::head, rules::Stored};
use crate::{about::About, file::TextureFile, rounding::RoundingError};
use ltcforge_files::digest::Digest;

/// `NAME.bin` and `NAME.json` for each texture.
pub(super) fn files(textures: &[Stored<'_>], about: &About) -> Vec<TextureFile> {
    let files = textures.iter().flat_map(|stored| {
        let bytes = stored.rounded.little_endian();
        let file = format!("{}.bin", stored.texture.name);
        let mut document = head(stored);
        document["file"] = json!(file);
        document["bytes"] = json!(bytes.len());
        document["sha256"] = json!(Digest::of(&bytes).hex());
        document["byte_order"] = json!("little-endian");
        document["about"] = json!(about.lines());
        if let Some(words) = about.uniform_json() {
            document["ltc_table"] = words;
        }
        let text = format!("{document:#}\n");
        let path = format!("{}.json", stored.texture.name);
        let numbers = TextureFile { path: file, bytes, rounding: stored.rounded.error };
        // The JSON document contains no rounded numbers.
        [numbers, TextureFile { path, bytes: text.into_bytes(), rounding: RoundingError::default() }]
    });
    files.collect()
}
