//! Babylon.js, as of `@babylonjs/core` 9.34.0 (npm).
//!
//! `Lights/LTC/ltcTextureTool` loads `areaLights/areaLightsLTC.bin` from the folder of core assets, or from
//! `Tools.AssetBaseUrl` if it is set. It reads 16-bit words in the processor's byte order, which is little-endian. Each
//! texel has eight halves: four of texture 1, then four of texture 2. `ltcHelperFunctions` samples at roughness and
//! sqrt(1 - cos theta). The shader has a constant for half a texel of a 64 x 64 texture.

use super::rules::{Source, file};
use crate::{bundle::Bundle, file::TextureFileError};
use ltcforge_fit::Precision;

pub(super) fn bundle(source: &Source<'_>) -> Result<Bundle, TextureFileError> {
    let [first, second] = source.both(Precision::F16)?;
    let [one, two] = [&first, &second].map(|stored| stored.rounded.half_bits().collect::<Vec<u16>>());
    let texels = one.chunks_exact(4).zip(two.chunks_exact(4));
    let bytes = texels.flat_map(|(one, two)| one.iter().chain(two)).flat_map(|half| half.to_le_bytes()).collect();
    let steps = [
        "Serve this folder, and set Tools.AssetBaseUrl to its URL before the first area light (checked with 9.34).",
        "AssetBaseUrl replaces https://assets.babylonjs.com/core: copy all other files that the page loads from there, too.",
    ];
    let path = "areaLights/areaLightsLTC.bin";
    Ok(Bundle { files: vec![file(path, bytes, &[&first, &second])], steps: steps.map(str::to_owned).into() })
}
