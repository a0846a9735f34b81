//! The shading languages.

use ltcforge_fit::named_list;

named_list! {
    /// A shading language.
    pub enum Language {
        /// WGSL, in which a constant selects how entries are interpolated.
        Wgsl = "wgsl",
        /// GLSL 4.50 for OpenGL.
        Glsl = "glsl",
        /// GLSL 3.30 for OpenGL 3.3, only as text to include, because it has no compute shaders.
        Glsl330 = "glsl-330",
        /// GLSL ES: 3.10 for programs in OpenGL ES, and 3.00 for text to include in WebGL 2.
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
    /// Whether shaders in this language come as programs: the example is a compute shader.
    #[must_use]
    pub fn has_programs(self) -> bool {
        self != Self::Glsl330
    }

    /// Whether shaders in this language come as text to include. SPIR-V does not.
    #[must_use]
    pub fn has_includes(self) -> bool {
        self != Self::Spirv
    }
}
