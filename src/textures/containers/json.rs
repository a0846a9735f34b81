//! JSON: the sizes, channels and numbers of each texture.

use serde_json::{Value, json};

use super::rules::Stored;
use crate::{about::About, digits::shortest};

/// A document with all textures. Each number has the fewest digits that read back as the stored number. For 16 bits,
/// this is the stored half.
pub(super) fn text(textures: &[Stored<'_>], about: &About) -> String {
    let texts: Vec<String> = textures.iter().map(texture).collect();
    let uniform = about.uniform_json().map_or_else(String::new, |words| format!("\"ltc_table\": {words},\n"));
    let about = json!(about.lines());
    format!("{{\"about\": {about},\n{uniform}\"textures\": [{}]}}\n", texts.join(",\n"))
}

/// A texture as JSON text. A JSON value would print its numbers with other digits.
fn texture(stored: &Stored<'_>) -> String {
    let numbers = stored.rows(|x| shortest(x, stored.rounded.precision));
    let head = head(stored).to_string();
    let head = head.strip_suffix('}').unwrap_or(&head);
    format!("{head},\"texels\":[\n{}\n]}}", numbers.trim_end().trim_end_matches(','))
}

/// The description of a texture.
pub(super) fn head(stored: &Stored<'_>) -> Value {
    let texture = stored.texture;
    let number = stored.rounded.either("float32", "float16");
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
