//! The languages that a shader is written in.

use ltcforge_fit::named_list;

named_list! {
    /// A shading language.
    pub enum Language {
        /// WGSL, with both ways to interpolate entries.
        Wgsl = "wgsl",
        /// GLSL 4.50 for OpenGL.
        Glsl = "glsl",
        /// GLSL 3.30 for OpenGL 3.3, to include. It has no compute shaders.
        Glsl330 = "glsl-330",
        /// GLSL ES: 3.10 for OpenGL ES as a program, 3.00 for WebGL 2 to include.
        GlslEs = "glsl-es",
        /// HLSL for shader model 5.1.
        Hlsl = "hlsl",
        /// Metal Shading Language 2.0.
        Msl = "msl",
        /// SPIR-V 1.3, binary, for Vulkan 1.1.
        Spirv = "spirv",
    }
}

impl Language {
    /// Whether the language has programs: the example is a compute shader.
    #[must_use]
    pub fn has_programs(self) -> bool {
        self != Self::Glsl330
    }

    /// Whether the language has text to include; SPIR-V does not.
    #[must_use]
    pub fn has_includes(self) -> bool {
        self != Self::Spirv
    }
}
