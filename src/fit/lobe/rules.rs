//! The interface of a lobe model.

use glam::{DMat3, DVec3};

use super::gaussian::Gaussian;

/// A distribution of directions in the tangent frame.
pub(crate) trait LobeDistribution {
    /// A direction from a point of the unit square, of unit length.
    fn sample(&self, u: [f64; 2]) -> DVec3;

    /// The part of the distribution that a convex polygon covers, seen from the origin and from either side: in [0, 1].
    fn covered(&self, polygon: &[DVec3]) -> f64;

    /// The factor from a table's terms to those of the lobe: the part of the model's own weight that the
    /// distribution is. One, unless the model is cut at the horizon to make it.
    fn above_horizon(&self) -> f64 {
        1.0
    }
}

/// A lobe model as an item of [`super::LobeModel`].
pub(crate) trait LobeModelRules: Sync {
    /// The distribution of the nine numbers that a lookup gives for an entry; `None` where they make none.
    fn distribution(&self, numbers: &[f64; 9]) -> Option<Box<dyn LobeDistribution>>;

    /// Another matrix of the same distribution, which a layout stores relative to a reflection's.
    fn relative_to(&self, _reflection: &DMat3, matrix: &DMat3) -> DMat3 {
        *matrix
    }

    /// The mean error of a table, over that of a table of LTCs.
    fn error_over_ltc(&self) -> f64 {
        1.0
    }

    /// The Gaussian that the numbers stand for; `None` for models that are no Gaussians.
    fn gaussian(&self) -> Option<Gaussian> {
        None
    }
}
