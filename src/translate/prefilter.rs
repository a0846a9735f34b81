//! The prefilter for a picture on a light, as text to include.

use super::{PortError, translation::translate_functions};
use ltcforge_shaders::{Language, prefilter_comment, prefilter_source, stamped};

/// The functions that compute the pyramid of a picture in several passes, in `language`. A comment at the top explains
/// them. Their names start with `prefilter`. They read two textures.
///
/// # Errors
/// [`PortError`] for SPIR-V, which has no text to include, or for a defect of the shader or of naga.
pub fn include_prefilter(language: Language) -> Result<String, PortError> {
    Ok(stamped(&prefilter_comment(), &translate_functions(language, &prefilter_source(), None)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// naga validates each translation before it is returned.
    #[test]
    fn every_language_has_the_passes() {
        let read = |language| match language {
            Language::Wgsl => {
                ["var prefilter_source: texture_2d<f32>;", "textureLoad(prefilter_source, vec2(x, y), 0)"]
            }
            Language::Hlsl => ["Texture2D<float4> prefilter_source", "prefilter_source.Load(int3(uint2(x, y), 0))"],
            Language::Msl => ["texture2d<float> prefilter_source", "prefilter_source.read(uint2(x, y), 0)"],
            _ => ["sampler2D prefilter_source;", "texelFetch(prefilter_source, ivec2(uvec2(x, y)), 0)"],
        };
        for language in Language::ALL.iter().copied().filter(|language| language.has_includes()) {
            let text = include_prefilter(language).expect("a translation");
            let code: String = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
            let functions =
                ["halved(", "row(", "mean(", "level(", "size(", "levels("].map(|name| format!("prefilter_{name}"));
            for wanted in functions.iter().map(String::as_str).chain(read(language)) {
                assert!(code.contains(wanted), "{}: {wanted}\n{text}", language.name());
            }
            assert!(text.starts_with("// SPDX") && !code.contains("ltc_included"), "{}", language.name());
        }
        assert!(include_prefilter(Language::Spirv).is_err());
    }
}
