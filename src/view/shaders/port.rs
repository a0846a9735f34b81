//! A shader for other renderers, in their language.

#[cfg(feature = "shaders")]
use super::translate::translate;
use super::{
    gaussians_header::gaussians_header, gaussians_table_header::gaussians_table_header, header::header,
    language::Language, lit_by::LitBy, normals_header::normals_header, sources::ported,
};

/// Why there is no translation: a language that has no such text ([`Language::has_programs`], [`Language::has_includes`]), or a
/// defect of the shaders or of naga.
#[cfg(feature = "shaders")]
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}: {reason}", language.name())]
pub struct PortError {
    /// The language asked for.
    pub language: Language,
    /// What naga says.
    pub reason: String,
}

/// The shader that lights by a table of some layout, or without one, in WGSL as it is written here.
///
/// It begins with a comment that explains how to call it and lists values that a port has to reproduce.
#[must_use]
pub fn wgsl(lit_by: impl Into<LitBy>) -> String {
    let lit_by = lit_by.into();
    format!("{}\n{}", comment(Language::Wgsl, lit_by), ported(lit_by))
}

/// The comment at the top.
pub(super) fn comment(language: Language, lit_by: LitBy) -> String {
    match lit_by {
        LitBy::Table(layout) => header(language, layout),
        LitBy::Normals => normals_header(language),
        LitBy::Gaussian(_) => gaussians_header(language),
        LitBy::GaussianTable(_, layout) => gaussians_table_header(language, layout),
    }
}

/// The same shader in `language`: UTF-8, or the words of SPIR-V in little-endian order.
///
/// SPIR-V holds the comment in its `OpSource`.
///
/// # Errors
/// naga does not translate the shader.
#[cfg(feature = "shaders")]
pub fn port(language: Language, lit_by: impl Into<LitBy>) -> Result<Vec<u8>, PortError> {
    let lit_by = lit_by.into();
    if language == Language::Wgsl {
        return Ok(wgsl(lit_by).into_bytes());
    }
    let header = comment(language, lit_by);
    let source = format!("{header}\n{}", ported(lit_by));
    let body = translate(language, lit_by, &source).map_err(|reason| PortError { language, reason })?;
    let (version, code) = body.split_at(version_line(language, &body));
    let is_text = language != Language::Spirv;
    Ok(if is_text { [version, header.as_bytes(), b"\n", code].concat() } else { body })
}

/// Bytes of the line `#version`, before which OpenGL ES takes nothing, not even a comment; zero in other languages.
#[cfg(feature = "shaders")]
fn version_line(language: Language, code: &[u8]) -> usize {
    match language {
        Language::Glsl | Language::Glsl330 | Language::GlslEs => {
            code.iter().position(|byte| *byte == b'\n').map_or(0, |end| end + 1)
        }
        Language::Wgsl | Language::Spirv | Language::Hlsl | Language::Msl => 0,
    }
}
