//! Shaders in WGSL for other renderers, put together for one model of light and one layout of tables.
//!
//! [`SHADERS`] are the files of `shaders/`. [`wgsl()`] joins those that a renderer needs for one layout of tables, or for
//! none, with an example that calls them, and puts a comment above. `ltcforge-translate` has the other languages, and texts
//! to include.
//!
//! Invariants: `shaders` knows neither a GPU nor a picture, and translates nothing; equal arguments give equal bytes on
//! every machine.

mod gaussians_header;
mod gaussians_table_header;
mod golden;
mod header;
mod language;
mod lit_by;
mod normals_header;
mod place;
mod sources;
mod text;

pub use gaussians_header::{SG_LIGHT, gaussians_include_header};
pub use gaussians_table_header::gaussians_table_include_header;
pub use golden::{CASES, CORNERS, Case, Golden, TOLERANCE, table as golden_table};
pub use header::{commented, functions_of, table_include_header};
pub use language::Language;
pub use lit_by::{Bound, Filter, Lights, LitBy, Reading};
pub use normals_header::normals_include_header;
pub use place::{BadPrefix, Place, Prefix};
pub use sources::{
    SHADERS, Shader, functions, joined, normals_functions, ported, preview_module, table_reader, without_textures,
};
pub use text::{comment, wgsl};
