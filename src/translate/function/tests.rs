use super::*;
use ltcforge_fit::testing::planted_isotropic;

/// naga validates each translation before it is returned.
#[test]
fn every_language_has_the_functions_and_no_bindings() {
    let function = IsotropicFunction::of(&planted_isotropic(Layout::Reflected)).expect("a function");
    for language in Language::ALL.iter().copied().filter(|language| language.has_includes()) {
        let text = include_function(
            language,
            &function,
            &["table 17".to_owned()],
            Lights::All,
            Additions::default(),
            &Namespace::default(),
        )
        .expect("a translation");
        let name = language.name();
        assert!(text.starts_with("// SPDX") && text.contains("//   table 17\n"), "{name}");
        let code: String = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
        for function in [
            "ltc_lookup",
            "ltc_inverse",
            "ltc_rectangle",
            "ltc_polygon",
            "ltc_disk",
            "ltc_sphere",
            "ltc_tube",
            "ltc_line",
        ] {
            assert!(code.contains(&format!("{function}(")), "{name}: {function}");
        }
        for bound in ["texture", "sampler", "uniform", "buffer", "binding", "cbuffer", "ltc_included"] {
            assert!(!code.contains(bound), "{name}: {bound}");
        }
    }
}
