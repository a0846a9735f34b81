//! What computes rather than waits: tables, mutated inputs, and the sources themselves.

mod circles;
#[path = "../common/mod.rs"]
mod common;
#[path = "../fuzz/mod.rs"]
mod fuzz;
mod links;
mod preview_parameters;
#[path = "../tables/mod.rs"]
mod tables;
