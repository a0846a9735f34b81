//! A BRDF whose values are measured or computed elsewhere.

mod asymmetry;
mod axes;
mod check;
mod fault;
mod grid;
#[cfg(any(test, feature = "testing"))]
pub(crate) mod planted;
mod surface;
mod tabulate;
#[cfg(test)]
mod tests;

pub use asymmetry::Asymmetry;
pub use axes::TabulatedAxes;
pub use check::{MOST_ALBEDO, MOST_VALUES};
pub use fault::TabulatedFault;
pub use grid::TabulatedBrdf;

use super::scattering::{Brdf, BrdfRules, PredictionFactors};

/// Tabulated BRDFs as an item of [`super::BrdfKind`]. Their surfaces need a file: see [`super::BrdfModel`].
pub(super) struct TabulatedRules;

impl BrdfRules for TabulatedRules {
    fn surface(&self, _: [f64; 2]) -> Box<dyn Brdf> {
        panic!("a tabulated model has no surfaces without its file")
    }

    /// Files with azimuths of the view are anisotropic: see [`super::BrdfModel::is_isotropic`].
    fn is_isotropic(&self) -> bool {
        true
    }

    /// Some tabulated BRDFs follow the reflection, but a file does not say whether its BRDF does.
    fn follows_reflection(&self) -> bool {
        false
    }

    fn needs_file(&self) -> bool {
        true
    }

    /// The error depends on the file's contents. The prediction assumes the error of GGX.
    fn prediction_factors(&self) -> PredictionFactors {
        PredictionFactors { sample: 7.0, error: 1.0 }
    }
}
