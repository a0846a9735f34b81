//! Lookup tables of directional albedo: split-sum (DFG), energy compensation, sheen, diffuse, rough glass.
//!
//! `quadrature` computes values. `solve` finds the texels whose linear filter is nearest to the values. `report`
//! measures a table at other places.
//!
//! Invariant: no random numbers. A shard is the part of the table with one texel of the first axis.

mod anisotropic;
mod axes;
mod ggx;
mod glass;
mod quadrature;
mod recipe;
mod report;
mod rows;
mod solve;
#[cfg(test)]
mod tests;

pub use axes::{AxisParameter, LutAxes, Texels};
pub use recipe::{DfgForm, LutKind, LutPrecision, LutRecipe, LutResolution};
pub use report::{LutError, LutReport, MeasuredLut};
pub use rows::{Lut, LutPlan, fit_lut};
