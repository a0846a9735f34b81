//! The interface of a lobe model.

use glam::{DMat3, DVec3};

use super::gaussian::Gaussian;

/// A distribution of directions in the tangent frame.
pub(crate) trait LobeDistribution {
    /// Maps a point of the unit square to a direction of unit length.
    fn sample(&self, u: [f64; 2]) -> DVec3;

    /// The integral of the distribution over the directions from the origin to a convex polygon, in [0, 1]. The polygon
    /// is visible from both sides.
    fn covered(&self, polygon: &[DVec3]) -> f64;

    /// The factor that converts a table's terms to the terms of the lobe: the fraction of the model's weight above the
    /// horizon. It is one unless the model is cut at the horizon.
    fn above_horizon(&self) -> f64 {
        1.0
    }
}

/// A lobe model as an item of [`super::LobeModel`].
pub(crate) trait LobeModelRules: Sync {
    /// The distribution that the nine numbers of a lookup define; `None` if the numbers are invalid.
    fn distribution(&self, numbers: &[f64; 9]) -> Option<Box<dyn LobeDistribution>>;

    /// A matrix of the same distribution, for layouts that store matrices relative to the reflection.
    fn relative_to(&self, _reflection: &DMat3, matrix: &DMat3) -> DMat3 {
        *matrix
    }

    /// The mean error of a table, divided by the mean error of a table of LTCs.
    fn error_over_ltc(&self) -> f64 {
        1.0
    }

    /// The kind of Gaussian; `None` for models that are not Gaussians.
    fn gaussian(&self) -> Option<Gaussian> {
        None
    }
}
