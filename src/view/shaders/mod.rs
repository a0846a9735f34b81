//! The shaders in WGSL, and one file of them for other renderers, translated where its language is not WGSL.
//!
//! [`SHADERS`] are the files of `shaders/`. [`port()`] joins those that a renderer needs for one layout of tables, or for
//! none, with an example that calls them, puts a comment above, and has naga translate them. [`include()`] does so without
//! the example, and [`include_function()`] puts a table's polynomials in its place. WGSL is handed out as it is written, without naga.
//!
//! Invariants: `shaders` knows neither a GPU nor a picture; only `translate` uses naga; equal arguments give equal bytes
//! on every machine.

#[cfg(feature = "shaders")]
mod function;
mod gaussians_header;
mod gaussians_table_header;
mod golden;
mod header;
#[cfg(feature = "shaders")]
mod include;
mod language;
mod lit_by;
mod normals_header;
#[cfg(feature = "shaders")]
mod place;
mod port;
mod sources;
#[cfg(all(test, feature = "shaders"))]
mod tests;
#[cfg(feature = "shaders")]
mod translate;

#[cfg(feature = "shaders")]
pub use function::include_function;
#[cfg(test)]
pub use gaussians_header::SG_LIGHT;
#[cfg(test)]
pub use golden::{CASES, CORNERS, Case, Golden, TOLERANCE, table as golden_table};
#[cfg(feature = "shaders")]
pub use include::include;
pub use language::Language;
pub use lit_by::{Bound, Filter, Lights, LitBy, Reading};
#[cfg(feature = "shaders")]
pub use place::{BadPrefix, Place, Prefix};
pub use port::wgsl;
#[cfg(feature = "shaders")]
pub use port::{PortError, port};
#[cfg(feature = "render")]
pub use sources::preview_module;
pub use sources::{SHADERS, Shader};
#[cfg(all(test, feature = "render"))]
pub use sources::{joined, normals_functions, table_reader};
