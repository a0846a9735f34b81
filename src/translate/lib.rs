//! The shaders of `ltcforge-shaders` in the languages of other renderers.
//!
//! [`port()`] translates a shader together with the example that calls it. [`include()`] omits the example, and
//! [`include_function()`] replaces the table by polynomials. WGSL is returned as written, without naga.
//!
//! The printer writes GLSL, HLSL and MSL from a syntax tree of the WGSL. naga validates the WGSL and writes SPIR-V.
//!
//! Invariants: only `translation` uses naga; equal arguments give equal bytes on every machine.

mod error;
mod function;
mod include;
mod layers;
mod port;
mod prefilter;
mod printer;
mod samplers;
#[cfg(test)]
mod tests;
mod translation;
mod wgsl;

pub use error::PortError;
pub use function::include_function;
pub use include::{include, include_given};
pub use layers::include_layers;
pub use port::port;
pub use prefilter::include_prefilter;
pub use samplers::include_samplers;
