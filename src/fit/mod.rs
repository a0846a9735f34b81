//! Recipe to table: the fitting core.
//!
//! Invariant: `fit` knows no clock, file, environment, JSON value or thread count; equal recipes give equal bytes.

mod recipe;
mod shard;

pub use recipe::{BrdfKind, FITTER_VERSION, FitSettings, Metric, Precision, Recipe, Solver};
pub use shard::{FittedEntry, Plan, ShardBytesError, assemble, fit_shard, shard_from_bytes, shard_to_bytes};
