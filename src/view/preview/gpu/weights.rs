//! How entries of a table are interpolated.

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
