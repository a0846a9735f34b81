//! The trade-off between speed, size and accuracy: the recipes that show it, the Pareto fronts, and how both are
//! written and drawn. Beside the tables, the models that light a surface: tables and the closed form.
//!
//! Invariant: no clock and no file here. Callers measure and hand the results in.

mod axis;
mod chart;
mod family;
mod fitted_recipe;
mod front;
mod label;
mod mark;
mod model;
mod number;
mod picture;
mod prediction;
mod table;

pub use family::{Size, family};
pub use fitted_recipe::{FittedRecipe, Measurement, POINTS, rows};
pub use front::{Fronts, front};
pub use model::{LIGHTS, ModelRow, ModelRows, fitted_gaussians, stands_for_ltc};
pub use picture::picture;
pub use prediction::{OffBy, off_by};
pub use table::{csv, json};
