//! The choice between the sampler and the shader for the interpolation of table entries.

/// The part of the GPU that interpolates table entries.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Weights {
    /// The sampler on a software rasteriser, where it is faster and interpolates in f32. Otherwise the shader, because
    /// the samplers of GPUs have 8-bit weights.
    #[default]
    Exact,
    /// The shader interpolates.
    Shader,
    /// The sampler interpolates.
    Sampler,
}
