//! Shaders of `ltcforge-shaders` in the languages of other renderers.
//!
//! [`port()`] translates a shader with the example that calls it. [`include()`] does so without the example, and
//! [`include_function()`] puts a table's polynomials in its place. WGSL is handed out as it is written, without naga.
//!
//! GLSL, HLSL and MSL are printed from a syntax tree of the WGSL; naga validates it and writes SPIR-V.
//!
//! Invariants: only `translation` uses naga; equal arguments give equal bytes on every machine.

mod error;
mod function;
mod include;
mod layers;
mod port;
mod prefilter;
mod printer;
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
