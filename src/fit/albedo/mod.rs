//! Lookup tables of directional albedo: split-sum (DFG), energy compensation, sheen, diffuse.
//!
//! `quadrature` computes values. `solve` finds the texels whose linear filter is nearest to the values. `report`
//! measures a table at other places.
//!
//! Invariant: no random numbers. A shard is a row of texels.

mod axes;
mod ggx;
mod quadrature;
mod recipe;
mod report;
mod rows;
mod solve;
#[cfg(test)]
mod tests;

pub use axes::{CosineAxis, LutAxes, RoughnessAxis, Texels};
pub use recipe::{DfgForm, LutKind, LutPrecision, LutRecipe, LutResolution};
pub use report::{LutError, LutMap, LutReport, MeasuredLut};
pub use rows::{Lut, LutPlan, fit_lut};
