//! A shader for other renderers, in their language.

use ltcforge_shaders::{Language, LitBy, ported, wgsl};

use super::translation::translate;

/// Why there is no translation: a language that has no such text ([`Language::has_programs`],
/// [`Language::has_includes`]), or a defect of the shaders or of naga.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}: {reason}", language.name())]
pub struct PortError {
    /// The language asked for.
    pub language: Language,
    /// The message of naga.
    pub reason: String,
}

/// The shader that lights by a table of some layout, or without one, in `language`: UTF-8, or the words of SPIR-V in
/// little-endian order.
///
/// SPIR-V holds the comment in its `OpSource`.
///
/// # Errors
/// naga does not translate the shader.
pub fn port(language: Language, lit_by: impl Into<LitBy>) -> Result<Vec<u8>, PortError> {
    let lit_by = lit_by.into();
    if language == Language::Wgsl {
        return Ok(wgsl(lit_by).into_bytes());
    }
    let header = lit_by.comment(language);
    let source = format!("{header}\n{}", ported(lit_by));
    let body = translate(language, lit_by, &source).map_err(|reason| PortError { language, reason })?;
    let (version, code) = body.split_at(version_line(language, &body));
    let is_text = language != Language::Spirv;
    Ok(if is_text { [version, header.as_bytes(), b"\n", code].concat() } else { body })
}

/// Bytes of the line `#version`, before which OpenGL ES takes nothing, not even a comment; zero in other languages.
fn version_line(language: Language, code: &[u8]) -> usize {
    match language {
        Language::Glsl | Language::Glsl330 | Language::GlslEs => {
            code.iter().position(|byte| *byte == b'\n').map_or(0, |end| end + 1)
        }
        Language::Wgsl | Language::Spirv | Language::Hlsl | Language::Msl => 0,
    }
}
