//! Unity's High Definition Render Pipeline, as of its sources of 2023 and later (read in copies of them).
//!
//! `LTCAreaLight.cs` fills layer 0 of a 64 x 64 array of `R16G16B16A16_SFloat` with `s_LtcMatrixData_BRDF_GGX`, an
//! array of the bits of halves in `Generated/LtcData.BRDF_GGX.cs`. The shader samples at perceptual roughness and
//! `sqrt(1 - cos theta)`, and takes a texel as elements 00, 02, 11 and 20 of the transposed inverse over element 22.
//! Amplitude and Fresnel term come from a table of another kind, which stays.

use super::rules::{EngineRules, FIRST, SIZE, Source, file};
use crate::{bundle::Bundle, file::TextureFileError};
use ltcforge_fit::Precision;

/// Unity's High Definition Render Pipeline.
pub(super) struct Hdrp;

impl EngineRules for Hdrp {
    fn layout(&self) -> Option<&'static str> {
        Some("hdrp")
    }

    fn bundle(&self, source: &Source<'_>) -> Result<Bundle, TextureFileError> {
        let stored = source.square(FIRST, SIZE, Precision::F16)?;
        let bits: Vec<u16> = stored.rounded.half_bits().collect();
        let rows: String =
            bits.chunks(4).map(|texel| format!("            {texel:?},\n").replace(['[', ']'], "")).collect();
        let text = format!(
            "{}\nnamespace UnityEngine.Rendering.HighDefinition\n{{\n    internal partial class LTCAreaLight\n    {{\n        \
             internal static ushort[] s_LtcMatrixData_BRDF_GGX = new ushort[{SIZE} * {SIZE} * 4]\n        {{\n{rows}        \
             }};\n    }}\n}}\n",
            source.about.comment()
        );
        let steps = [
            "Embed the package com.unity.render-pipelines.high-definition in the project, so that its files can be changed.",
            "Replace LtcData.BRDF_GGX.cs in its Runtime/Material/LTCAreaLight/Generated.",
        ];
        let files = vec![file("LtcData.BRDF_GGX.cs", text.into_bytes(), &[&stored])];
        Ok(Bundle { files, steps: steps.map(str::to_owned).into() })
    }
}
