//! The functions that a Rust program calls: fits on all cores, and tables kept in a folder. They share one error type.
//!
//! Invariant: this module decides nothing about a table; it only calls the layers below.

mod builder;
mod error;
mod fitting;
#[cfg(feature = "textures")]
mod light_pyramid;
mod lighting;
#[cfg(feature = "shaders")]
mod shader;
mod tables;

pub use builder::{RecipeBuilder, RecipeDocument};
pub use error::Error;
pub use fitting::{Fit, fit};
#[cfg(feature = "textures")]
pub use light_pyramid::light_pyramid;
pub use lighting::{light, light_by_table, light_by_table_above};
#[cfg(feature = "shaders")]
pub use shader::shader;
pub use tables::{cached, write_table};
