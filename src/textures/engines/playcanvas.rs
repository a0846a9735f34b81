//! `PlayCanvas` 2.23.3 (npm).
//!
//! `app.setAreaLightLuts(m1, m2)` takes two arrays of 64 x 64 x 4 numbers and rounds each number to the nearest half
//! (`AreaLightLuts.set`, `FloatPacking.float2Half`). Therefore the numbers in the file are already halves, with the few
//! digits that halves need. The shader samples at max((1 - gloss)^2, 0.001) and sqrt(1 - cos theta), with a constant
//! for half a texel of a 64 x 64 texture.

use std::fmt::Write as _;

use serde_json::json;

use super::rules::{Source, file};
use crate::{bundle::Bundle, digits::shortest, file::TextureFileError};
use ltcforge_fit::Precision;

pub(super) fn bundle(source: &Source<'_>) -> Result<Bundle, TextureFileError> {
    let [first, second] = source.both(Precision::F16)?;
    let mut text = format!("{{\"about\":{}", json!(source.about.lines()));
    for (key, stored) in [("LTC_MAT_1", &first), ("LTC_MAT_2", &second)] {
        let number = |x: &f32| shortest(*x, Precision::F16);
        let numbers: Vec<String> = stored.rounded.numbers.iter().map(number).collect();
        // Writing to a String cannot fail.
        let _ = write!(text, ",\n\"{key}\":[{}]", numbers.join(","));
    }
    text += "}\n";
    let steps = [
        "Load area-light-luts.json as an asset of type json (checked with 2.23).",
        "Then call app.setAreaLightLuts( luts.LTC_MAT_1, luts.LTC_MAT_2 ), where luts is the resource of the asset.",
        "Set app.scene.lighting.areaLightsEnabled = true to enable area lights.",
    ];
    let files = vec![file("area-light-luts.json", text.into_bytes(), &[&first, &second])];
    Ok(Bundle { files, steps: steps.map(str::to_owned).into() })
}
