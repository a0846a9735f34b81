//! Shaders in WGSL for other renderers, assembled for a light model and a table layout.
//!
//! [`SHADERS`] are the files in `shaders/`. [`wgsl()`] joins the files for one layout, or for a model without a table.
//! It adds an example that calls the functions, and a comment at the top. `ltcforge-translate` has the other languages,
//! and texts to include.
//!
//! Invariants: `shaders` knows neither GPUs nor pictures, and translates nothing; equal arguments give equal bytes on
//! every machine.

mod added;
mod additions;
mod bindings;
mod es_module;
mod formula_header;
mod gaussians_header;
mod gaussians_table_header;
mod given;
mod golden;
mod gpu_cost;
mod header;
mod language;
mod layers;
mod lit_by;
mod model_shader;
mod models;
mod namespace;
mod normals_header;
mod prefilter;
mod samplers;
mod sources;
mod stamp;
mod text;
mod textured;

pub use additions::{AdditionError, Additions};
pub use es_module::{DECLARATIONS, es_module};
pub use gaussians_header::SG_LIGHT;
pub use given::GivenAxes;
pub use golden::{
    BLENDED, CASES, CORNERS, Case, Golden, SecondGolden, TOLERANCE, table as golden_table,
    table_of_two_lobes as golden_table_of_two_lobes,
};
pub use gpu_cost::{COMPILER, GpuCost, GpuLimit};
pub use header::{commented, functions_of, table_caller};
pub use language::Language;
pub use layers::{FUZZ_CASES, fuzz_values, layers_comment, layers_source};
pub use lit_by::{Bound, Filter, Lights, LitBy, LitByError, Reading};
pub use model_shader::ModelShader;
pub use namespace::{BadPrefix, Namespace, Prefix};
pub use prefilter::{prefilter_comment, prefilter_source};
pub use samplers::{samplers, samplers_comment, samplers_source};
pub use sources::{SHADERS, Shader, functions, joined, ported, preview_module, table_reader, without_textures};
pub use stamp::{head, stamped};
pub use text::wgsl;
