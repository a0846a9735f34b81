//! A text as a JavaScript module, and the types of the module.

use super::Language;

/// The TypeScript declarations of the module.
pub const DECLARATIONS: &str =
    "/** The text of a shader, as `ltcforge shader` prints it. */\ndeclare const text: string;\nexport default text;\n";

/// A module whose default export is the text. A comment before the text names the language for editors.
#[must_use]
pub fn es_module(text: &str, language: Language) -> String {
    let kind = match language {
        Language::Glsl | Language::Glsl330 | Language::GlslEs => "glsl",
        other => other.name(),
    };
    let text = text.replace('\\', "\\\\").replace('`', "\\`").replace("${", "\\${");
    format!("export default /* {kind} */ `{text}`;\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_template_would_read_is_escaped() {
        let module = es_module("a `b` ${c} \\d $e\n", Language::GlslEs);
        assert_eq!(module, "export default /* glsl */ `a \\`b\\` \\${c} \\\\d $e\n`;\n");
    }
}
