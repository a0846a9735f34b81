//! Ways to compile the shaders.

/// Another way to compile the shaders, to be measured against the usual one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Variant {
    /// How entries are interpolated.
    pub weights: Weights,
    /// A constant takes the place of the table.
    pub lookup_is_constant: bool,
}

/// How entries are interpolated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Weights {
    /// The sampler on a software rasteriser, where it is faster and interpolates in f32; otherwise the shader, since
    /// the samplers of GPUs have weights of 8 bits.
    #[default]
    Exact,
    /// The shader.
    Shader,
    /// The sampler.
    Sampler,
}
