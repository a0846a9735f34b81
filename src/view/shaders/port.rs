//! A shader for other renderers, in their language and for one layout of tables.

#[cfg(feature = "shaders")]
use super::translate::translate;
use super::{header::header, language::Language, sources::for_layout};
use crate::fit::Layout;

/// Why there is no translation: a defect of the shaders or of naga, since no argument of the caller leads here.
#[cfg(feature = "shaders")]
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}: {reason}", language.name())]
pub struct PortError {
    /// The language asked for.
    pub language: Language,
    /// What naga says.
    pub reason: String,
}

/// The shader that reads tables of `layout`, in WGSL as it is written here.
///
/// It begins with a comment that explains how to bind a table and lists values that a port has to reproduce.
#[must_use]
pub fn wgsl(layout: Layout) -> String {
    format!("{}\n{}", header(Language::Wgsl, layout), for_layout(layout))
}

/// The shader that reads tables of `layout`, in `language`: UTF-8, or the words of SPIR-V in little-endian order.
///
/// Text begins with a comment that explains how to bind a table and lists values that a port has to reproduce. SPIR-V
/// holds that comment in its `OpSource`.
///
/// # Errors
/// naga does not translate the shader.
#[cfg(feature = "shaders")]
pub fn port(language: Language, layout: Layout) -> Result<Vec<u8>, PortError> {
    if language == Language::Wgsl {
        return Ok(wgsl(layout).into_bytes());
    }
    let header = header(language, layout);
    let source = format!("{header}\n{}", for_layout(layout));
    let body = translate(language, &source).map_err(|reason| PortError { language, reason })?;
    let is_text = language != Language::Spirv;
    Ok(if is_text { [header.as_bytes(), b"\n", &body].concat() } else { body })
}
