//! The light of square lights in a lobe and in an LTC.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};

use super::distance::SHIFT;
use crate::fit::{
    math::{Lattice, atan2, rotation_from_z, sin_cos},
    metric::Target,
};

/// Lights that a lobe is measured with.
const LIGHTS: usize = 8;
/// Least and most half-width of a light, radians: from a lamp across a room to a window beside the surface.
const HALF_WIDTH: [f64; 2] = [0.05, 0.45];
/// The centre of a light is at least this high above the horizon.
const LEAST_HEIGHT: f64 = 0.05;

/// A square light as seen from the surface: the directions `v` with `|v.x|, |v.y| < tan v.z` in its own frame, above
/// the surface's horizon.
#[derive(Debug, Clone, Copy)]
struct SquareLight {
    x: DVec3,
    y: DVec3,
    centre: DVec3,
    tan: f64,
}

/// Mean absolute difference, over a few lights around directions of the lobe, of the part of its energy that reaches
/// them and the part by the LTC of `m`, a regular matrix in the tangent frame, whose inverse is `inverse`. In [0, 1].
pub(super) fn light_error(target: &Target, inverse: &DMat3) -> f64 {
    SquareLight::around(target)
        .map(|light| (light.energy_of_lobe(target) - light.energy_of_ltc(inverse)).abs())
        .sum::<f64>()
        / LIGHTS as f64
}

impl SquareLight {
    /// The lights: around directions of the lobe, of widths and turned by angles that the sequences tell.
    fn around(target: &Target) -> impl Iterator<Item = Self> {
        let turns = Lattice::new(LIGHTS, [SHIFT[1], SHIFT[0]]).points().map(|[_, turn]| turn);
        Lattice::new(LIGHTS, SHIFT).points().zip(turns).map(|(at, turn)| Self::new(target, at, turn))
    }

    fn new(target: &Target, [where_, how_wide]: [f64; 2], turn: f64) -> Self {
        let index = (where_ * target.points.len() as f64) as usize;
        let mut centre = target.frame * (target.points[index.min(target.points.len() - 1)] + DVec3::Z);
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

    /// The part of the lobe's samples inside.
    fn energy_of_lobe(&self, target: &Target) -> f64 {
        // Into the lobe's frame once, rather than each sample out of it.
        let to_lobe = target.frame.transpose();
        let [x, y, centre, up] = [self.x, self.y, self.centre, DVec3::Z].map(|v| to_lobe * v);
        let inside = |w: DVec3| {
            let reach = self.tan * w.dot(centre);
            w.dot(x).abs() < reach && w.dot(y).abs() < reach && w.dot(up) > 0.0
        };
        let samples = target.points.iter().zip(&target.weights);
        samples.map(|(p, weight)| if inside(*p + DVec3::Z) { *weight } else { 0.0 }).sum()
    }

    /// The integral of the LTC over the light in closed form: the polygon, back in cosine space, clipped at the
    /// horizon, is `sum angle(v_i, v_i+1) (v_i x v_i+1 / |v_i x v_i+1|).z / (2 pi)` [Heitz et al. 2016, section 4].
    fn energy_of_ltc(&self, inverse: &DMat3) -> f64 {
        let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
        let corner = |(x, y): (f64, f64)| self.centre + self.tan * (x * self.x + y * self.y);
        let above: Vec<DVec3> = clipped(&corners.map(corner)).iter().map(|v| *inverse * *v).collect();
        let polygon: Vec<DVec3> = clipped(&above).iter().map(|v| v.normalize_or_zero()).collect();
        let edge = |(from, to): (&DVec3, &DVec3)| {
            let normal = from.cross(*to);
            let length = normal.length();
            if length > 0.0 { atan2(length, from.dot(*to)) * normal.z / length } else { 0.0 }
        };
        let next = polygon.iter().cycle().skip(1);
        // A matrix with negative determinant turns the polygon over.
        (polygon.iter().zip(next).map(edge).sum::<f64>() / (2.0 * PI)).abs()
    }
}

/// The part of a convex polygon of rays that is above the horizon.
fn clipped(polygon: &[DVec3]) -> Vec<DVec3> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (from, to) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
        if from.z > 0.0 {
            kept.push(*from);
        }
        if (from.z > 0.0) != (to.z > 0.0) {
            kept.push((*from * to.z - *to * from.z) / (to.z - from.z));
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::{Ltc, brdf::Mirrors, metric::planted};

    const NO_MIRRORS: Mirrors = Mirrors { x: false, y: false };

    fn skewed() -> DMat3 {
        DMat3::from_cols(DVec3::new(0.5, 0.1, 0.2), DVec3::new(-0.1, 0.3, 0.1), DVec3::new(-0.6, 0.2, 0.8))
    }

    #[test]
    fn the_closed_form_counts_the_samples_inside() {
        for m in [DMat3::IDENTITY, skewed(), skewed() * DMat3::from_diagonal(DVec3::new(1.0, -1.0, 1.0))] {
            let target = planted(m, NO_MIRRORS);
            let ltc = Ltc::new(m).expect("regular");
            let mut seen = 0.0;
            // Besides those of the report, two that lie half behind the lobe, across the horizon of cosine space.
            let across = [DVec3::X, DVec3::Y].map(|edge| SquareLight {
                x: rotation_from_z((m * edge).normalize()).x_axis,
                y: rotation_from_z((m * edge).normalize()).y_axis,
                centre: (m * edge).normalize(),
                tan: 0.5,
            });
            for (k, light) in SquareLight::around(&target).chain(across).enumerate() {
                let n = 1 << 16;
                let inside = Lattice::new(n, [0.2, 0.7]).points().map(|u| ltc.sample(u)).filter(|w| {
                    let reach = light.tan * w.dot(light.centre);
                    w.dot(light.x).abs() < reach && w.dot(light.y).abs() < reach && w.z > 0.0
                });
                let (counted, found) = (inside.count() as f64 / n as f64, light.energy_of_ltc(&m.inverse()));
                assert!((counted - found).abs() < 5e-4, "{k}: {counted} {found}");
                seen += found;
            }
            assert!(seen > 0.2, "{seen}");
        }
    }

    /// A lobe and its own matrix agree; one that looks elsewhere loses about all the energy.
    #[test]
    fn the_error_tells_right_from_wrong() {
        let m = DMat3::from_cols(DVec3::new(0.02, 0.0, 0.0), DVec3::new(0.0, 0.02, 0.0), DVec3::new(0.6, 0.0, 0.8));
        let target = planted(m, NO_MIRRORS);
        let away = DMat3::from_cols(m.x_axis, m.y_axis, DVec3::new(-0.6, 0.0, 0.8));
        let right = light_error(&target, &m.inverse());
        let wrong = light_error(&target, &away.inverse());
        assert!(right < 2e-3 && wrong > 0.5, "{right} {wrong}");
    }
}
