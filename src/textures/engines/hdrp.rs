//! Unity's High Definition Render Pipeline of 2023 and later, from copies of the sources.
//!
//! `LTCAreaLight.cs` fills the layers of a 64 x 64 array of `R16G16B16A16_SFloat`, one layer per scattering model, from
//! arrays with the bits of halves. Layer 0 comes from `s_LtcMatrixData_BRDF_GGX` in `Generated/LtcData.BRDF_GGX.cs`,
//! and the others come from similar files. Three of our scattering models agree with the shader's formulas: GGX, Disney
//! (Burley's diffuse reflection) and Charlie. The shader's Oren-Nayar is the model of 1994, which differs from ours
//! (docs/engines.md). The shader samples at perceptual roughness and `sqrt(1 - cos theta)`. A texel has elements 00,
//! 02, 11 and 20 of the transposed inverse, divided by element 22. Amplitude and Fresnel term come from another table,
//! which this export does not replace.

use super::rules::{FIRST, SIZE, Source, file};
use crate::{bundle::Bundle, file::TextureFileError};
use ltcforge_fit::{BrdfKind, Precision};

pub(super) fn bundle(source: &Source<'_>) -> Result<Bundle, TextureFileError> {
    let name = match source.brdf {
        BrdfKind::BurleyDiffuse => "Disney",
        BrdfKind::Charlie | BrdfKind::CharlieNeubelt => "Charlie",
        _ => "GGX",
    };
    let stored = source.square(FIRST, SIZE, Precision::F16)?;
    let bits: Vec<u16> = stored.rounded.half_bits().collect();
    let rows: String =
        bits.chunks(4).map(|texel| format!("            {texel:?},\n").replace(['[', ']'], "")).collect();
    let text = format!(
        "{}\nnamespace UnityEngine.Rendering.HighDefinition\n{{\n    internal partial class LTCAreaLight\n    {{\n        \
             internal static ushort[] s_LtcMatrixData_BRDF_{name} = new ushort[{SIZE} * {SIZE} * 4]\n        {{\n{rows}        \
             }};\n    }}\n}}\n",
        source.about.comment()
    );
    let path = format!("LtcData.BRDF_{name}.cs");
    let embed = "Embed the package com.unity.render-pipelines.high-definition in the project, so that its files can be changed.";
    let steps = vec![embed.to_owned(), format!("Replace {path} in its Runtime/Material/LTCAreaLight/Generated.")];
    Ok(Bundle { files: vec![file(&path, text.into_bytes(), &[&stored])], steps })
}
