//! The shaders in the languages of other renderers, for one layout of tables: `ltc_math`, `ltc_table`, `ltc_light` and
//! the example that calls them, translated by naga.
//!
//! Invariant: equal arguments give equal bytes, on every machine.

mod fold;
mod golden;
mod header;
mod translate;

use crate::fit::Layout;

/// The languages there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Language {
    /// WGSL, as it is written here: comments, and both ways to weigh entries.
    Wgsl,
    /// GLSL 4.50 for OpenGL.
    Glsl,
    /// HLSL for shader model 5.1.
    Hlsl,
    /// Metal Shading Language 2.0.
    Msl,
    /// SPIR-V 1.3, binary, for Vulkan 1.1.
    Spirv,
}

impl Language {
    /// Every one.
    pub const ALL: [Self; 5] = [Self::Wgsl, Self::Glsl, Self::Hlsl, Self::Msl, Self::Spirv];

    /// Its name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Wgsl => "wgsl",
            Self::Glsl => "glsl",
            Self::Hlsl => "hlsl",
            Self::Msl => "msl",
            Self::Spirv => "spirv",
        }
    }
}

/// Why there is no translation: a defect of the shaders or of naga, for no argument of the caller's leads here.
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
/// Text begins with a comment that tells how to bind it and what a port has to give; SPIR-V has it in its `OpSource`.
///
/// # Errors
/// naga does not translate it.
pub fn port(language: Language, layout: Layout) -> Result<Vec<u8>, PortError> {
    let header = header::header(language, layout);
    translate::translate(language, layout, &header).map_err(|reason| PortError { language, reason })
}

/// A layout's name in a sentence, and in the shaders' constants.
fn layout_names(layout: Layout) -> (&'static str, &'static str) {
    (layout.name(), layout.rules().shader_constant().0)
}

#[cfg(test)]
mod tests;
