//! Ways to compile the shaders.

/// Other ways to compile the shaders, to be measured against the usual one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Variant {
    /// Who weighs the entries around a configuration.
    pub weights: Weights,
    /// A constant stands for the table.
    pub lookup_is_constant: bool,
}

/// Who weighs the entries around a configuration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Weights {
    /// The sampler of a software rasteriser, which is faster there and weighs in f32; else the shader, since GPUs'
    /// samplers have weights of 8 bits.
    #[default]
    Exact,
    /// The shader.
    Shader,
    /// The sampler.
    Sampler,
}
