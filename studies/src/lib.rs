//! Where constants of the sources come from, and rows of the documents.
//!
//! Each study has its generator, its objective and what it holds out; all are seeded. studies/README.md has the
//! commands.

pub mod albedo;
pub mod arcs;
pub mod below;
pub mod best;
pub mod clock;
pub mod costs;
mod draw;
pub mod expected;
pub mod figures;
pub mod glass;
pub mod gpu_costs;
pub mod gpu_times;
pub mod l3;
pub mod light_errors;
pub mod lights;
pub mod linear;
pub mod markdown;
pub mod materials;
pub mod minimax;
pub mod models;
pub mod networks;
pub mod prefilter;
pub mod source;
pub mod tables;
pub mod tabulated;
pub mod textured;
