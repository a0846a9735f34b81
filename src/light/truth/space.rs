//! The spaces for the integral over a light's image.

use glam::DVec3;

use ltcforge_fit::brdf::{Brdf, edge_weight};

/// The cosine of 18 degrees. A rule of 15 points resolves an image up to this length.
pub(super) const SHORT: f64 = 0.95;

/// A surface and a view, and a map from light directions to unit vectors. In the space of the unit vectors the lobe is
/// broad. The map takes straight edges to curves and lights to regions. The integral of [`Space::density`] over the
/// image of a light is the reflected light.
pub(super) trait Space {
    /// The image of a direction, of unit length.
    fn image(&self, w: DVec3) -> DVec3;

    /// The image of a moving direction, and its derivative, up to a component along the image.
    fn turning_image(&self, w: DVec3, turning: DVec3) -> (DVec3, DVec3);

    /// The energy reflected around the image `c` of a direction, per steradian of the space, and the energy times
    /// [`Space::weight`].
    fn density(&self, c: DVec3) -> [f64; 2];

    /// The weight of the second integral, as a function of the cosine between view and half vector.
    fn weight(&self) -> Weight;

    /// The surface and the view direction.
    fn brdf_and_view(&self) -> (&dyn Brdf, DVec3);

    /// The start of rays to the outline. It is the image of a direction in the light, or a point from which rays cannot
    /// miss the lobe.
    fn tip(&self, within: DVec3) -> DVec3 {
        self.image(within)
    }

    /// The cosine of the largest angle of a part of an outline's image.
    fn short(&self) -> f64 {
        SHORT
    }

    /// The kinks of the density along `(1 - s) from + s to`: values of `s` in (0, 1), in ascending order.
    fn bends(&self, _from: DVec3, _to: DVec3) -> Vec<f64> {
        Vec::new()
    }
}

/// The weight of the second of two integrals, as a function of the cosine between view and half vector.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Weight {
    /// Schlick's fifth power.
    Schlick,
    /// The weight of F82's edge, [`edge_weight`].
    Edge,
}

impl Weight {
    /// The energy, and the energy times the weight.
    pub(super) fn weighted(self, energy: f64, cosine: f64) -> [f64; 2] {
        let weight = match self {
            Self::Schlick => (1.0 - cosine.min(1.0)).powi(5),
            Self::Edge => edge_weight(cosine),
        };
        [energy, energy * weight]
    }
}
