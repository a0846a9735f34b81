//! Functions that sample lights, as text to include.

use super::{PortError, translation::translate_functions};
use ltcforge_shaders::{Language, samplers_comment, samplers_source, stamped};

/// The functions that draw directions to polygon lights, in `language`. A comment at the top explains them. Their names
/// start with `sampler`. There are no bindings.
///
/// # Errors
/// [`PortError`] for SPIR-V, which has no text to include, or for a defect of the shader or of naga.
pub fn include_samplers(language: Language) -> Result<String, PortError> {
    Ok(stamped(&samplers_comment(), &translate_functions(language, &samplers_source(), None)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// naga validates each translation before it is returned.
    #[test]
    fn every_language_has_the_functions() {
        for language in Language::ALL.iter().copied().filter(|language| language.has_includes()) {
            let text = include_samplers(language).expect("a translation");
            let code: String = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
            let functions = ["normals(", "ltc(", "draw(", "pdf(", "draw_either(", "minus_hidden(", "by_ratio("];
            for function in functions.iter().chain(&["normals_polygon(", "ltc_polygon(", "pdf_polygon("]) {
                assert!(code.contains(&format!("sampler_{function}")), "{}: {function}", language.name());
            }
            assert!(text.starts_with("// SPDX") && !code.contains(" ltc_"), "{}", language.name());
        }
        assert!(include_samplers(Language::Spirv).is_err());
    }
}
