//! Integrates lobes around a reflection over the normals that reflect.

use std::f64::consts::PI;

use glam::DVec3;

use super::space::{Space, Weight};
use ltcforge_fit::brdf::{Brdf, Ggx};

/// The cosine of 60 degrees. Rays from a tip this near to the pole turn by at most 150 degrees.
const NEAR_POLE: f64 = 0.5;

/// Maps a light direction to the normal that reflects the view there, `c = normalize(A^-1 h)`,
/// `A = diag(alpha_x, alpha_y, 1)`.
struct Stretch {
    stretch: DVec3,
    wo: DVec3,
}

impl Stretch {
    fn new([alpha_x, alpha_y]: [f64; 2], wo: DVec3) -> Self {
        Self { stretch: DVec3::new(alpha_x, alpha_y, 1.0), wo }
    }

    fn image(&self, w: DVec3) -> DVec3 {
        ((self.wo + w) / self.stretch).normalize()
    }

    fn turning_image(&self, w: DVec3, turning: DVec3) -> (DVec3, DVec3) {
        let h = (self.wo + w) / self.stretch;
        let length = h.length();
        (h / length, turning / self.stretch / length)
    }
}

/// A lobe of GGX over normals.
pub(super) struct GgxNormals {
    map: Stretch,
    ggx: Ggx,
    /// `A wo` and its length.
    wo_stretched: DVec3,
    length: f64,
    weight: Weight,
}

impl GgxNormals {
    pub(super) fn new([alpha_x, alpha_y]: [f64; 2], wo: DVec3, weight: Weight) -> Self {
        let map = Stretch::new([alpha_x, alpha_y], wo);
        let wo_stretched = map.stretch * wo;
        Self { map, ggx: Ggx { alpha_x, alpha_y }, wo_stretched, length: wo_stretched.length(), weight }
    }
}

impl Space for GgxNormals {
    fn image(&self, w: DVec3) -> DVec3 {
        self.map.image(w)
    }

    fn turning_image(&self, w: DVec3, turning: DVec3) -> (DVec3, DVec3) {
        self.map.turning_image(w, turning)
    }

    /// Visible normals have the density `2 (A wo . c) / (cos_o + |A wo|) / pi`, and `G2 / G1` is
    /// `(cos_o + |A wo|) cos_i / (|A wo| cos_i + cos_o |A wi|)`.
    fn density(&self, c: DVec3) -> [f64; 2] {
        let Stretch { stretch, wo } = self.map;
        let h = (stretch * c).normalize();
        let cosine = wo.dot(h);
        let wi = 2.0 * cosine * h - wo;
        if wi.z <= 0.0 {
            return [0.0; 2];
        }
        let shadowing = self.length * wi.z + wo.z * (stretch * wi).length();
        self.weight.weighted(2.0 * self.wo_stretched.dot(c) * wi.z / (PI * shadowing), cosine)
    }

    fn weight(&self) -> Weight {
        self.weight
    }

    fn brdf_and_view(&self) -> (&dyn Brdf, DVec3) {
        (&self.ggx, self.map.wo)
    }
}

/// A lobe around a reflection that is not GGX, over normals.
pub(super) struct Normals<'a> {
    map: Stretch,
    brdf: &'a dyn Brdf,
    weight: Weight,
}

impl<'a> Normals<'a> {
    pub(super) fn new(brdf: &'a dyn Brdf, alpha: [f64; 2], wo: DVec3, weight: Weight) -> Self {
        Self { map: Stretch::new(alpha, wo), brdf, weight }
    }
}

impl Space for Normals<'_> {
    fn image(&self, w: DVec3) -> DVec3 {
        self.map.image(w)
    }

    fn turning_image(&self, w: DVec3, turning: DVec3) -> (DVec3, DVec3) {
        self.map.turning_image(w, turning)
    }

    /// The tip is the pole for images far from it. Lobes without long tails are zero there, and rays between two points
    /// far from the pole could miss the lobe. Rays from the pole, the centre of the lobe, cannot. A tip outside of the
    /// image gives the same sum.
    fn tip(&self, within: DVec3) -> DVec3 {
        let image = self.image(within);
        if image.z > NEAR_POLE { image } else { DVec3::Z }
    }

    /// A steradian around `c` is `alpha_x alpha_y / |A c|^3` steradians of normals.
    fn density(&self, c: DVec3) -> [f64; 2] {
        let Stretch { stretch, wo } = self.map;
        let h = stretch * c;
        let length = h.length();
        let wm = h / length;
        let steradians = stretch.x * stretch.y / (length * length * length);
        self.weight.weighted(self.brdf.eval_normal(wo, wm) * steradians, wo.dot(wm))
    }

    fn weight(&self) -> Weight {
        self.weight
    }

    fn brdf_and_view(&self) -> (&dyn Brdf, DVec3) {
        (self.brdf, self.map.wo)
    }
}
