//! Finds constants of the code, and prints tables of the docs.
//!
//! Most studies that find constants have an objective, and seeded generators of cases for the search and of held-out
//! cases. The commands are in studies/README.md.

pub mod albedo;
pub mod arcs;
pub mod below;
pub mod best;
pub mod clock;
pub mod costs;
mod draw;
pub mod expected;
pub mod figures;
pub mod formula;
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
pub mod paths;
pub mod prefilter;
pub mod source;
pub mod tables;
pub mod tabulated;
pub mod textured;
