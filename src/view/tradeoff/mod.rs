//! The trade-off between speed, size and accuracy: recipes, Pareto fronts, documents and pictures. It also compares the
//! models that light a surface: tables and closed forms.
//!
//! Invariant: this module reads neither a clock nor files. Callers measure, and pass the results.

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
pub use model::{LIGHTS, ModelRow, ModelRows, fitted_gaussians, represents_ltc};
pub use picture::picture;
pub use prediction::{OffBy, off_by};
pub use table::{csv, json};
