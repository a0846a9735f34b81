//! A shader for other renderers, in one of their languages.

use ltcforge_shaders::{Language, LitBy, stamped, wgsl};

use super::{
    PortError,
    translation::{program, spirv_program},
};

/// The shader in `language` for light by a table of a layout, or without a table. The bytes are UTF-8, or SPIR-V words
/// in little-endian order.
///
/// SPIR-V contains the comment in its `OpSource`.
///
/// # Errors
/// [`PortError`] if the language has no program or naga does not translate the shader.
pub fn port(language: Language, lit_by: impl Into<LitBy>) -> Result<Vec<u8>, PortError> {
    let lit_by = lit_by.into();
    if language == Language::Wgsl {
        return Ok(wgsl(lit_by).into_bytes());
    }
    let header = lit_by.comment(language);
    let failed = |reason| PortError { language, reason };
    if language == Language::Spirv {
        return spirv_program(lit_by, &header).map_err(failed);
    }
    let body = program(language, lit_by).map_err(failed)?;
    // OpenGL ES allows nothing before the version line, not even a comment.
    let (version, code) = match body.split_once('\n').filter(|(first, _)| first.starts_with("#version")) {
        Some((version, code)) => (format!("{version}\n"), code),
        None => (String::new(), body.as_str()),
    };
    Ok((version + &stamped(&header, code)).into_bytes())
}
