//! The shader in another language.

use super::Error;
use ltcforge_shaders::{Language, LitBy};
use ltcforge_translate::port;

/// The shader in `language` that reads tables of a layout, or needs no table: UTF-8 text, or the words of SPIR-V in
/// little-endian order.
///
/// Text begins with a comment that explains how to call the shader and lists values that a port has to reproduce.
/// SPIR-V contains this comment in its `OpSource`.
///
/// # Errors
/// [`Error::Shader`] when naga does not translate the shader, which is a defect of this crate.
pub fn shader(language: Language, lit_by: impl Into<LitBy>) -> Result<Vec<u8>, Error> {
    Ok(port(language, lit_by)?)
}
