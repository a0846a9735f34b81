//! Tests that compute without waiting: tables, mutated inputs, and checks of the sources.

mod circles;
#[path = "../common/mod.rs"]
mod common;
#[path = "../fuzz/mod.rs"]
mod fuzz;
mod links;
mod preview_parameters;
#[path = "../tables/mod.rs"]
mod tables;
