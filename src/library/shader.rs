//! The shader in another language.

use super::Error;
use crate::{
    fit::Layout,
    view::shaders::{self, Language},
};

/// The shader that reads tables of `layout`, in `language`: UTF-8, or the words of SPIR-V in little-endian order.
///
/// Text begins with a comment that explains how to bind a table and lists values that a port has to reproduce. SPIR-V
/// holds that comment in its `OpSource`.
///
/// # Errors
/// [`Error::Shader`] when naga does not translate the shader, which is a defect of this crate.
pub fn shader(language: Language, layout: Layout) -> Result<Vec<u8>, Error> {
    Ok(shaders::port(language, layout)?)
}
