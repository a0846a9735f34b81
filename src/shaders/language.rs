//! The languages that a shader is written in.

/// A shading language.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Language {
    /// WGSL as it is written here, with its comments and both ways to interpolate entries.
    Wgsl,
    /// GLSL 4.50 for OpenGL.
    Glsl,
    /// GLSL 3.30 for OpenGL 3.3, which has no compute shaders: to include.
    Glsl330,
    /// GLSL ES: 3.10 for OpenGL ES as a program, 3.00 for WebGL 2 to include.
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
    pub const ALL: [Self; 7] =
        [Self::Wgsl, Self::Glsl, Self::Glsl330, Self::GlslEs, Self::Hlsl, Self::Msl, Self::Spirv];

    /// Its name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Wgsl => "wgsl",
            Self::Glsl => "glsl",
            Self::Glsl330 => "glsl-330",
            Self::GlslEs => "glsl-es",
            Self::Hlsl => "hlsl",
            Self::Msl => "msl",
            Self::Spirv => "spirv",
        }
    }

    /// Whether programs are written in it: the example is a compute shader.
    #[must_use]
    pub fn has_programs(self) -> bool {
        self != Self::Glsl330
    }

    /// Whether it has text to include: SPIR-V has none.
    #[must_use]
    pub fn has_includes(self) -> bool {
        self != Self::Spirv
    }
}
