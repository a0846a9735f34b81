//! Recipe to table: the fitting core.
//!
//! A configuration's path: [`nodes()`] says where it lies, `target` samples its lobe, `guess` and `solve` find the
//! matrix whose LTC is nearest to it by the distance of `loss`, `align` picks the representative that is stored.
//!
//! Invariant: `fit` knows no clock, file, environment, JSON value or thread count; equal recipes give equal bytes.

pub mod brdf;
pub mod ltc;
pub mod math;

mod align;
mod assemble;
mod bfgs;
mod cost;
mod entry;
mod expectation;
mod guess;
mod loss;
mod measure;
mod nodes;
mod recipe;
mod sgd;
mod shard;
mod solve;
mod target;
mod terms;

/// Called now and then in a long fit, so that its caller can tell that it is alive, and stop it.
pub type Pulse<'a> = dyn FnMut() -> std::ops::ControlFlow<()> + 'a;

pub use assemble::assemble;
pub use cost::fit_seconds;
pub use entry::{FittedEntry, Fitter};
pub use expectation::{Expectation, expectation};
#[cfg(test)]
pub(crate) use ltc::quadrature;
pub use ltc::{
    ALPHA_Y_FLOOR, Clip, Configuration, Layout, LookedUp, Ltc, MAX_VERTICES, PerAxis, Reflection, Scalar, Sides, Table,
    Terms,
};
pub use measure::{
    Accuracy, Corner, ErrorMap, Extent, Floors, MOST_POINTS, Matrices, Moved, REPORT_VERSION, Report, Spread,
    TermError, Worst, error_map, extremes, report, report_points,
};
pub use nodes::{ALPHA_FLOOR, RATIO_FLOOR, THETA_CEILING, nodes};
pub use recipe::{BrdfKind, FITTER_VERSION, FitSettings, Metric, Precision, Recipe, Solver};
pub use shard::{Plan, ShardBytesError, fit_rows, fit_shard, shard_from_bytes, shard_to_bytes};
pub use terms::ggx_terms;
