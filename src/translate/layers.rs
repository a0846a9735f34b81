//! The layers of a material as text to include.

use super::{PortError, translation::translate_functions};
use ltcforge_shaders::{Language, layers_comment, layers_source, stamped};

/// The functions that combine a coat and fuzz with the layers below, in `language`. A comment at the top explains them.
/// Their names start with `layers`. There are no bindings.
///
/// # Errors
/// [`PortError`] for SPIR-V, which has no text to include, or for a defect of the shader or of naga.
pub fn include_layers(language: Language) -> Result<String, PortError> {
    Ok(stamped(&layers_comment(), &translate_functions(language, &layers_source(), None)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// naga validates each translation before it is returned.
    #[test]
    fn every_language_has_the_functions() {
        for language in Language::ALL.iter().copied().filter(|language| language.has_includes()) {
            let text = include_layers(language).expect("a translation");
            let code: String = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
            for function in ["layers_metal(", "layers_fuzz(", "layers_albedo(", "layers_coated(", "layers_fuzzed("] {
                assert!(code.contains(function), "{}: {function}", language.name());
            }
            assert!(text.starts_with("// SPDX") && !code.contains("ltc_included"), "{}", language.name());
        }
        assert!(include_layers(Language::Spirv).is_err());
    }
}
