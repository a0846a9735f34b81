//! JSON: each texture's sizes, channels and numbers.

use serde_json::{Value, json};

use super::rules::{ContainerRules, Stored, Written, one_of_all};
use crate::{about::About, digits::shortest, file::TextureFileError};
use ltcforge_fit::Precision;

/// One document with all textures. Numbers have the shortest digits from which the stored number comes back, for 16
/// bits the stored half.
pub(super) struct Json;

impl ContainerRules for Json {
    fn files(&self, stem: &str, textures: &[Stored<'_>], about: &About) -> Result<Vec<Written>, TextureFileError> {
        let texts: Vec<String> = textures.iter().map(texture).collect();
        let about = json!(about.lines());
        let text = format!("{{\"about\": {about},\n\"textures\": [{}]}}\n", texts.join(",\n"));
        Ok(one_of_all(stem, "json", text.into_bytes(), textures))
    }
}

/// The numbers are text already: a value would print them in digits of its own.
fn texture(stored: &Stored<'_>) -> String {
    let numbers = stored.rows(|i| shortest(stored.rounded.numbers[i], stored.rounded.precision));
    let head = head(stored).to_string();
    let head = head.strip_suffix('}').unwrap_or(&head);
    format!("{head},\"texels\":[\n{}\n]}}", numbers.trim_end().trim_end_matches(','))
}

/// The description of a texture.
pub(super) fn head(stored: &Stored<'_>) -> Value {
    let texture = stored.texture;
    let number = match stored.rounded.precision {
        Precision::F32 => "float32",
        Precision::F16 => "float16",
    };
    json!({
        "name": texture.name,
        "width": texture.width,
        "height": texture.height,
        "depth": texture.depth,
        "layers": texture.layers,
        "channels": texture.channels,
        "number": number,
        "order": "channel fastest, then x, y, z, layer",
        "rounding": stored.rounded.error,
    })
}
