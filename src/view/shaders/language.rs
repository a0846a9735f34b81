//! The languages that a shader is written in.

/// A shading language.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Language {
    /// WGSL as it is written here, with its comments and both ways to interpolate entries.
    Wgsl,
    /// GLSL 4.50 for OpenGL.
    Glsl,
    /// GLSL ES 3.10 for OpenGL ES.
    GlslEs,
    /// HLSL for shader model 5.1.
    Hlsl,
    /// Metal Shading Language 2.0.
    Msl,
    /// SPIR-V 1.3, binary, for Vulkan 1.1.
    Spirv,
}

impl Language {
    /// Every language.
    pub const ALL: [Self; 6] = [Self::Wgsl, Self::Glsl, Self::GlslEs, Self::Hlsl, Self::Msl, Self::Spirv];

    /// Its name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Wgsl => "wgsl",
            Self::Glsl => "glsl",
            Self::GlslEs => "glsl-es",
            Self::Hlsl => "hlsl",
            Self::Msl => "msl",
            Self::Spirv => "spirv",
        }
    }
}
