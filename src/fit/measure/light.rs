//! The energy in square lights, of a lobe and of the distribution that represents it.

use std::f64::consts::PI;

use glam::DVec3;

use super::{lobe::Lobe, sequence::net};
use crate::{
    lobe::LobeDistribution,
    math::{rotation_from_z, sin_cos},
};

/// The number of lights for each lobe: `2^3`.
const LOG2_LIGHTS: u32 = 3;
/// Smallest and largest half-width of a light, radians: from a lamp across a room to a window next to the surface.
const HALF_WIDTH: [f64; 2] = [0.05, 0.45];
/// The smallest height of a light's centre above the horizon.
const LEAST_HEIGHT: f64 = 0.05;

/// A square light as seen from the surface: the directions `v` above the surface's horizon with
/// `|v.x|, |v.y| < tan * v.z` in the frame of the light, where `tan` is the tangent of the light's half-width.
#[derive(Debug, Clone, Copy)]
struct SquareLight {
    x: DVec3,
    y: DVec3,
    centre: DVec3,
    tan: f64,
}

/// Mean absolute difference between the energy of the lobe and the energy of `model` in a light, both as fractions of
/// the whole. The mean is over a few lights around directions of the lobe. In [0, 1].
pub(super) fn light_error(lobe: &Lobe, model: &dyn LobeDistribution) -> f64 {
    let errors =
        SquareLight::around(lobe).map(|light| (light.energy_of_lobe(lobe) - light.energy_of_model(model)).abs());
    errors.sum::<f64>() / f64::from(1 << LOG2_LIGHTS)
}

impl SquareLight {
    /// Lights around directions of the lobe. Their widths and rotations come from nets.
    fn around(lobe: &Lobe) -> impl Iterator<Item = Self> {
        let turns = net(LOG2_LIGHTS, [0, 5]).map(|[_, turn]| turn);
        net(LOG2_LIGHTS, [0, 0]).zip(turns).map(|(at, turn)| Self::new(lobe, at, turn))
    }

    fn new(lobe: &Lobe, [where_, how_wide]: [f64; 2], turn: f64) -> Self {
        let mut centre = lobe.directions[(where_ * lobe.directions.len() as f64) as usize];
        centre.z = centre.z.max(LEAST_HEIGHT);
        let frame = rotation_from_z(centre.normalize());
        let (sin_turn, cos_turn) = sin_cos(0.5 * PI * turn);
        let half_width = HALF_WIDTH[0] + (HALF_WIDTH[1] - HALF_WIDTH[0]) * how_wide;
        let (sin_half, cos_half) = sin_cos(half_width);
        Self {
            x: frame * DVec3::new(cos_turn, sin_turn, 0.0),
            y: frame * DVec3::new(-sin_turn, cos_turn, 0.0),
            centre: frame.z_axis,
            tan: sin_half / cos_half,
        }
    }

    /// True if the light covers a direction.
    fn covers(&self, w: DVec3) -> bool {
        let reach = self.tan * w.dot(self.centre);
        w.dot(self.x).abs() < reach && w.dot(self.y).abs() < reach && w.z > 0.0
    }

    /// The fraction of the lobe's energy in the light.
    fn energy_of_lobe(&self, lobe: &Lobe) -> f64 {
        let samples = lobe.directions.iter().zip(&lobe.weights);
        samples.map(|(w, weight)| if self.covers(*w) { *weight } else { 0.0 }).sum()
    }

    /// The fraction of the distribution in the part of the light above the surface's horizon.
    fn energy_of_model(&self, model: &dyn LobeDistribution) -> f64 {
        let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
        let corner = |(x, y): (f64, f64)| self.centre + self.tan * (x * self.x + y * self.y);
        model.covered(&clipped(&corners.map(corner)))
    }
}

/// Clips a convex polygon of rays at the horizon.
fn clipped(polygon: &[DVec3]) -> Vec<DVec3> {
    let mut clipped_vertices = Vec::with_capacity(polygon.len() + 1);
    for (from, to) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
        if from.z > 0.0 {
            clipped_vertices.push(*from);
        }
        if (from.z > 0.0) != (to.z > 0.0) {
            clipped_vertices.push((*from * to.z - *to * from.z) / (to.z - from.z));
        }
    }
    clipped_vertices
}

#[cfg(test)]
mod tests {
    use glam::DMat3;

    use super::{super::lobe::tests::planted, *};
    use crate::Ltc;

    fn skewed() -> DMat3 {
        DMat3::from_cols(DVec3::new(0.5, 0.1, 0.2), DVec3::new(-0.1, 0.3, 0.1), DVec3::new(-0.6, 0.2, 0.8))
    }

    #[test]
    fn the_closed_form_counts_the_samples_inside() {
        for m in [DMat3::IDENTITY, skewed(), skewed() * DMat3::from_diagonal(DVec3::new(1.0, -1.0, 1.0))] {
            let lobe = planted(m);
            let ltc = Ltc::new(m).expect("regular");
            let mut total = 0.0;
            // In addition to the lights of the report, two lights cross the horizon of cosine space, with one half
            // behind the lobe.
            let across = [DVec3::X, DVec3::Y].map(|edge| SquareLight {
                x: rotation_from_z((m * edge).normalize()).x_axis,
                y: rotation_from_z((m * edge).normalize()).y_axis,
                centre: (m * edge).normalize(),
                tan: 0.5,
            });
            for (k, light) in SquareLight::around(&lobe).chain(across).enumerate() {
                let inside = net(16, [3, 5]).map(|u| ltc.sample(u)).filter(|w| light.covers(*w));
                let (counted, found) = (inside.count() as f64 / f64::from(1 << 16), light.energy_of_model(&ltc));
                assert!((counted - found).abs() < 5e-4, "{k}: {counted} {found}");
                total += found;
            }
            assert!(total > 0.2, "{total}");
        }
    }

    /// The error of a lobe's own matrix is small. A matrix whose lobe points elsewhere misses nearly all energy.
    #[test]
    fn the_error_is_small_for_the_own_matrix_and_large_for_another() {
        let m = DMat3::from_cols(DVec3::new(0.02, 0.0, 0.0), DVec3::new(0.0, 0.02, 0.0), DVec3::new(0.6, 0.0, 0.8));
        let lobe = planted(m);
        let away = DMat3::from_cols(m.x_axis, m.y_axis, DVec3::new(-0.6, 0.0, 0.8));
        let right = light_error(&lobe, &Ltc::new(m).expect("regular"));
        let wrong = light_error(&lobe, &Ltc::new(away).expect("regular"));
        assert!(right < 2e-3 && wrong > 0.5, "{right} {wrong}");
    }
}
