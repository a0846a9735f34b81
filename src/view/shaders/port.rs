//! A shader for other renderers, in their language and for one layout of tables.

use super::{Language, header::header, sources::for_layout, translate::translate};
use crate::fit::Layout;

/// Why there is no translation: a defect of the shaders or of naga, since no argument of the caller leads here.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}: {reason}", language.name())]
pub struct PortError {
    /// The language asked for.
    pub language: Language,
    /// What naga says.
    pub reason: String,
}

/// The shader that reads tables of `layout`, in `language`: UTF-8, or the words of SPIR-V in little-endian order.
///
/// Text begins with a comment that explains how to bind a table and lists values that a port has to reproduce. SPIR-V
/// holds that comment in its `OpSource`.
///
/// # Errors
/// naga does not translate the shader.
pub fn port(language: Language, layout: Layout) -> Result<Vec<u8>, PortError> {
    let header = header(language, layout);
    let source = format!("{header}\n{}", for_layout(layout));
    if language == Language::Wgsl {
        return Ok(source.into_bytes());
    }
    let body = translate(language, &source).map_err(|reason| PortError { language, reason })?;
    let is_text = language != Language::Spirv;
    Ok(if is_text { [header.as_bytes(), b"\n", &body].concat() } else { body })
}
