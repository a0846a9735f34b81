//! The interpolation of entries of a table.

/// The interpolation of entries.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Weights {
    /// The sampler on a software rasteriser, where it is faster and interpolates in f32. Otherwise the shader, because
    /// the samplers of GPUs have weights of 8 bits.
    #[default]
    Exact,
    /// The shader interpolates.
    Shader,
    /// The sampler interpolates.
    Sampler,
}
