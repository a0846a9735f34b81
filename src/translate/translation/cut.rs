//! A translation without its entry point, and with the names of WGSL for its bindings: text to include.

use super::{Bound, Language};

/// The names of a table's bindings without the sampler, which is last, in the order of the bindings in WGSL.
fn names(bound: Bound) -> &'static [&'static str] {
    match bound {
        Bound::Volumes => &["ltc_table", "ltc_matrix_a", "ltc_matrix_b", "ltc_terms"],
        Bound::Array => &["ltc_table", "ltc_layers"],
    }
}

/// The text above the entry point, which naga writes last; `None` for a text without the entry point.
pub(super) fn without_entry(language: Language, bound: Bound, whole: &str, entry: &str) -> Option<String> {
    match language {
        Language::Wgsl => cut_at(whole, "@fragment\n"),
        Language::Glsl | Language::Glsl330 | Language::GlslEs => {
            let functions = cut_at(whole, "void main() {")?;
            Some(named(bound, &lines(&functions, |line| glsl_line(language, line))))
        }
        Language::Hlsl => {
            let functions = cut_at(whole, &format!("float4 {entry}("))?;
            Some(lines(&functions, |line| hlsl_line(bound, line)))
        }
        Language::Msl => cut_at(whole, &format!("struct {entry}Output")),
        Language::Spirv => None,
    }
}

fn cut_at(whole: &str, sign: &str) -> Option<String> {
    whole.rfind(sign).map(|at| format!("{}\n", whole[..at].trim_end()))
}

/// The text line by line, each as a function has it, or without it.
fn lines(text: &str, of: impl Fn(&str) -> Option<String>) -> String {
    text.lines().filter_map(of).fold(String::new(), |text, line| text + &line + "\n")
}

/// Versions and outputs are the program's; uniforms are loose where blocks have no binding.
fn glsl_line(language: Language, line: &str) -> Option<String> {
    if line.starts_with("#version") || line.starts_with("layout(location") {
        return None;
    }
    let has_blocks = language == Language::Glsl;
    match loose_uniform(line).filter(|_| !has_blocks) {
        Some(loose) => Some(loose),
        None => Some(line.to_owned()),
    }
}

/// `uniform Block { Type name; };` as `uniform Type name;`.
fn loose_uniform(line: &str) -> Option<String> {
    let (before, rest) = line.split_once("uniform ")?;
    let member = rest.split_once('{')?.1.split_once('}')?.0.trim();
    (before.is_empty() || before.starts_with("layout(std140")).then(|| format!("uniform {member}"))
}

/// naga reaches samplers by way of a heap, since HLSL has no array of them by binding.
fn hlsl_line(bound: Bound, line: &str) -> Option<String> {
    let is_heap = line.contains("nagaSamplerHeap") || line.contains("nagaComparisonSamplerHeap");
    if line.starts_with("static const SamplerState ltc_sampler") {
        return Some(format!("SamplerState ltc_sampler : register(s{});", names(bound).len()));
    }
    (!is_heap && !line.contains("SamplerIndexArray")).then(|| line.to_owned())
}

/// naga numbers the bindings of OpenGL.
fn named(bound: Bound, text: &str) -> String {
    names(bound)
        .iter()
        .enumerate()
        .fold(text.to_owned(), |text, (binding, name)| text.replace(&format!("_group_0_binding_{binding}_fs"), name))
}
