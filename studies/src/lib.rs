//! Finds constants of the code, and prints tables of the docs.
//!
//! Each study has a generator of cases, an objective and held-out cases. All of them are seeded. The commands are in
//! studies/README.md.

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
