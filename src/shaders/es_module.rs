//! A shader text as a JavaScript module, and the module's types.

use super::Language;

/// The TypeScript declarations of the module.
pub const DECLARATIONS: &str =
    "/** The text of a shader, as `ltcforge shader` prints it. */\ndeclare const text: string;\nexport default text;\n";

/// A module with the text as its default export. A comment before the text names the language for editors.
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
    fn special_characters_of_templates_are_escaped() {
        let module = es_module("a `b` ${c} \\d $e\n", Language::GlslEs);
        assert_eq!(module, "export default /* glsl */ `a \\`b\\` \\${c} \\\\d $e\n`;\n");
    }
}
