//! Bevy 0.19 and its development branch, from copies of the sources.
//!
//! `bevy_pbr` with feature `area_light_luts` embeds `crates/bevy_pbr/src/ltc/ltc.ktx2`: an array of two layers of 64 x
//! 64 texels, `R16G16B16A16_SFLOAT`, zstd. The resource `AreaLightLuts { image }` of the render world replaces it at
//! run time.

use super::rules::{SIZE, Source, file};
use crate::{bundle::Bundle, containers::ktx2, file::TextureFileError, halves::Halves, texture::Texture};
use ltcforge_fit::Precision;

pub(super) fn bundle(source: &Source<'_>) -> Result<Bundle, TextureFileError> {
    let [first, second] = source.both(Precision::F32)?.map(|stored| stored.texture);
    let texels = [first.texels.as_slice(), &second.texels].concat();
    let mut both = Texture::new("ltc", [SIZE, SIZE, 1], 2, &["x", "y", "z", "w"], texels)?;
    both.halves = first.halves.as_ref().zip(second.halves.as_ref()).map(|(first, second)| Halves {
        numbers: [first.numbers.as_slice(), &second.numbers].concat(),
        displacement: first.displacement,
    });
    let stored = source.stored(&both, Precision::F16)?;
    let bytes = ktx2(&stored, true, source.about)?;
    let steps = [
        "Built in: replace crates/bevy_pbr/src/ltc/ltc.ktx2 in Bevy's sources (feature area_light_luts).",
        "At run time: load ltc.ktx2 with a linear sampler and insert its handle as AreaLightLuts { image } into the render world.",
    ];
    Ok(Bundle { files: vec![file("ltc.ktx2", bytes, &[&stored])], steps: steps.map(str::to_owned).into() })
}
