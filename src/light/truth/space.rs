//! The spaces in which a light's image is integrated over.

use glam::DVec3;

use ltcforge_fit::brdf::{Brdf, edge_weight};

/// Cosine of 18 degrees: an image no longer than this is smooth to a rule of 15 points.
pub(super) const SHORT: f64 = 0.95;

/// A view of a surface, and a map of the directions of light to unit vectors among which the lobe is broad.
///
/// The map takes straight edges to curves and lights to regions. The integral of [`Space::density`] over the image of a
/// light is what is reflected of it.
pub(super) trait Space {
    /// The image of a direction, of length one.
    fn image(&self, w: DVec3) -> DVec3;

    /// The image of a direction that turns, and its derivative, up to a part along the image.
    fn turning_image(&self, w: DVec3, turning: DVec3) -> (DVec3, DVec3);

    /// Energy reflected around the image `c` of a direction, per steradian there, and the same times
    /// [`Space::weight`].
    fn density(&self, c: DVec3) -> [f64; 2];

    /// The weight of the second integral, for a cosine between view and half vector.
    fn weight(&self) -> Weight;

    /// The surface, and the direction from which it is seen.
    fn seen(&self) -> (&dyn Brdf, DVec3);

    /// Where rays to the outline start: the image of a direction within a light, or a point that finds the lobe more
    /// surely.
    fn tip(&self, within: DVec3) -> DVec3 {
        self.image(within)
    }

    /// Cosine of the angle up to which parts of an outline's image are taken as a whole.
    fn short(&self) -> f64 {
        SHORT
    }

    /// Where the density bends along `(1 - s) from + s to`: values of `s` in (0, 1), in ascending order.
    fn bends(&self, _from: DVec3, _to: DVec3) -> Vec<f64> {
        Vec::new()
    }
}

/// What weighs the second of two integrals, by the cosine between view and half vector.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Weight {
    /// Schlick's fifth power.
    Schlick,
    /// That of F82's edge, [`edge_weight`].
    Edge,
}

impl Weight {
    /// The whole, and the same weighed.
    pub(super) fn beside(self, energy: f64, cosine: f64) -> [f64; 2] {
        let weight = match self {
            Self::Schlick => (1.0 - cosine.min(1.0)).powi(5),
            Self::Edge => edge_weight(cosine),
        };
        [energy, energy * weight]
    }
}
