//! The interface of a lobe model.

use glam::DVec3;

/// A distribution of directions in the tangent frame.
pub(crate) trait LobeDistribution {
    /// A direction from a point of the unit square, of unit length.
    fn sample(&self, u: [f64; 2]) -> DVec3;

    /// The part of the distribution that a convex polygon covers, seen from the origin and from either side: in [0, 1].
    fn covered(&self, polygon: &[DVec3]) -> f64;
}

/// A lobe model as an item of [`super::LobeModel`].
pub(crate) trait LobeModelRules: Sync {
    /// The distribution of the nine numbers that a lookup gives for an entry; `None` where they make none.
    fn distribution(&self, numbers: &[f64; 9]) -> Option<Box<dyn LobeDistribution>>;
}
