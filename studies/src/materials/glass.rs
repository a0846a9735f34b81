//! The true light of a rectangle behind a rough interface: quadrature of the published BTDF over the rectangle.

use glam::DVec3;

use ltcforge::fit::brdf::Ggx;

/// Cells along each side of the rectangle, and the nodes and weights of the three-point Gauss rule in each, on [0, 1].
const CELLS: u32 = 16;
const GAUSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_31, 5.0 / 18.0), (0.5, 4.0 / 9.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

/// The light that GGX transmits towards `wo` from a lamp of basic radiance one, with Schlick's Fresnel factor.
///
/// Per steradian of `wi` it is `(1 - F) D G2 (wo . h) / cos_o` times the Jacobian `eta^2 |wi . h| / |wo + eta wi|^2`,
/// with the normal `h = -(wo + eta wi)`, normalised [Walter et al. 2007, equations 16, 17 and 21]. Domain: as for
/// `transmission::transmitted`, `eta` above one, and a lamp small enough that a sixteenth of it, seen from the surface,
/// is narrower than the lobe.
pub(super) fn through_glass([alpha_x, alpha_y]: [f64; 2], wo: DVec3, eta: f64, lamp: &[DVec3; 4]) -> f64 {
    let ggx = Ggx { alpha_x, alpha_y };
    let (right, up) = (lamp[3] - lamp[0], lamp[1] - lamp[0]);
    let area = right.cross(up);
    let step = 1.0 / f64::from(CELLS);
    let nodes = || (0..CELLS).flat_map(|cell| GAUSS.map(|(x, weight)| ((f64::from(cell) + x) * step, weight * step)));
    let mut sum = 0.0;
    for (s, weight) in nodes() {
        for (t, across) in nodes() {
            let place = lamp[0] + s * right + t * up;
            let distance2 = place.length_squared();
            let wi = place / distance2.sqrt();
            sum += weight * across * density(&ggx, wo, wi, eta) * area.dot(wi).abs() / distance2;
        }
    }
    sum
}

fn density(ggx: &Ggx, wo: DVec3, wi: DVec3, eta: f64) -> f64 {
    let along = -(wo + eta * wi);
    let length2 = along.length_squared();
    let h = along / length2.sqrt();
    let (cos_o, cos_i) = (wo.dot(h), -wi.dot(h));
    if wi.z >= 0.0 || cos_o <= 0.0 || cos_i <= 0.0 {
        return 0.0;
    }
    let f0 = ((eta - 1.0) / (eta + 1.0)).powi(2);
    let passed = (1.0 - f0) * (1.0 - (1.0 - cos_o.min(cos_i)).powi(5));
    let g2 = 1.0 / (1.0 + ggx.smith_lambda(wo) + ggx.smith_lambda(wi));
    passed * ggx.distribution(h) * g2 * cos_o / wo.z * (eta * eta * cos_i / length2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ltcforge::fit::{Sides, math::direction};
    use ltcforge_light::transmission::sampled;

    #[test]
    fn it_equals_the_light_that_visible_normals_refract() {
        let lamp = [[-1.2, -0.7], [-1.2, 0.9], [1.4, 0.9], [1.4, -0.7]].map(|[x, y]| DVec3::new(x, y, -3.0));
        let corners = lamp.map(|corner| corner.to_array());
        for (alpha, theta) in [([0.25, 0.25], 0.3), ([0.4, 0.2], 0.6), ([0.6, 0.6], 1.0)] {
            let wo = direction(theta, 0.7);
            let found = through_glass(alpha, wo, 1.5, &lamp);
            let wanted = sampled(alpha, wo.to_array(), 1.5, &corners, Sides::Two, 1 << 18, [0.3, 0.6]).schlick;
            assert!(wanted > 0.004 && (found - wanted).abs() < 2e-3 * wanted, "{alpha:?} {theta}: {found} {wanted}");
        }
    }
}
