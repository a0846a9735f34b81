//! ltcforge fits, stores and serves Linearly Transformed Cosine tables.

#[cfg(feature = "cli")]
pub mod cli;
#[cfg(feature = "client")]
pub mod client;
pub mod files;
pub mod fit;
mod library;
#[cfg(feature = "server")]
pub mod server;
pub mod view;

pub use files::{
    digest::Digest,
    export::{TableFile, TableFileError},
    recipe::{Fault, Preset, RecipeBuilder, RecipeError},
};
pub use fit::{BrdfKind, Configuration, Layout, LookedUp, Metric, PerAxis, Precision, Recipe, Report, Solver, Table};
pub use glam;
pub use library::{Error, Fit, cached, fit, write_table};
