//! The fitting core: from a recipe to a table.
//!
//! A [`Layout`] maps a configuration to an entry of the table. `metric` samples the configuration's lobe. `solver`
//! finds the matrix whose LTC is nearest to the lobe. The layout selects the stored numbers. [`Table`] looks them up.
//! `measure` measures the table and shares no code with the metric.
//!
//! Invariant: `fit` uses no clock, file, environment variable, JSON value or thread count. Equal recipes give equal
//! bytes.

pub mod albedo;
pub mod brdf;
pub mod lobe;
pub mod math;

mod assemble;
mod axes;
mod between;
mod cost;
mod entry;
mod expectation;
mod given;
mod layout;
mod measure;
mod metric;
mod named_list;
mod recipe;
mod run;
mod second;
mod shard;
mod solver;
mod stop_check;
mod table;
mod terms;
#[cfg(any(test, feature = "testing"))]
pub mod testing;

pub use assemble::assemble;
pub use axes::{LEAST_ALPHA, PerAxis};
pub use brdf::{
    Asymmetry, BrdfKind, BrdfModel, LobeFresnel, MOST_ALBEDO, MOST_VALUES, SecondLobe, TabulatedAxes, TabulatedBrdf,
    TabulatedFault, TabulatedFile, WeightedF0,
};
pub use cost::fit_seconds;
pub use entry::{FittedEntry, Fitter};
pub use expectation::{Expectation, expectation};
pub use given::GivenNodes;
pub use layout::{
    ALPHA_FLOOR, FreeNumbers, LEAST_THETAS, Layout, LayoutShader, MOST_MATERIALS, Precision, RATIO_FLOOR, Reflection,
    ShaderAxes, ShaderNumbers, ShaderPlace, THETA_CEILING,
};
pub use lobe::LobeModel;
pub use lobe::ltc::{Clip, Ltc, MAX_VERTICES, Sides, cheap_form_factor, clipped_form_factor};
pub use measure::{
    Accuracy, Closeness, Corner, Difference, ErrorMap, Extent, Figures, Floors, Gap, GoOn, MOST_POINTS, Matrices,
    Moved, POOR_WIDTH, Poor, REPORT_VERSION, Report, ReportPoints, SampledLobes, SecondReport, Spread, TermError,
    Worst, difference, error_map_while, extremes, figures_of, report, report_points, report_while, width_between,
};
pub use metric::Metric;
pub use recipe::{FITTER_VERSION, FitSettings, Recipe, StoredTerms};
pub use run::{Progress, fit_entries, fit_plan};
pub use shard::{Plan, ShardBytesError, fit_rows, fit_shard, shard_from_bytes, shard_to_bytes};
pub use solver::{Shear, Simplex, Solver, Start};
pub use stop_check::StopCheck;
pub use table::{
    Configuration, FUNCTION_SIDE, FunctionError, IsotropicFunction, LookedUp, Table, Terms, blend_weight, blended,
};
pub use terms::{edge_spreads, ggx_terms, terms_of};
