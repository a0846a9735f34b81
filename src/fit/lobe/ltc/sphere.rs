//! The form factor of a light that is a spherical cap, clipped at the horizon.

use std::f64::consts::PI;

use crate::math::atan2;

/// The form factor of a cap clipped at the horizon, relative to the form factor of the same cap unclipped and straight
/// above. It is the cosine-weighted solid angle of the cap's part above the horizon, divided by `pi length`.
///
/// `cos_elevation` is the cosine `c` between the cap's axis and the normal. `length` is the length of the cap's vector
/// form factor, `sin^2 sigma` for a cap of half angle `sigma`, up to a hemisphere. Shaders take the vector form factor
/// of any light, and multiply its length by the result [Hill and Heitz 2016].
///
/// By Stokes' theorem, the cosine-weighted solid angle of a part of the sphere is half the integral of `(r x dr)_z`
/// along its border. With `s = sqrt(1 - c^2)`, the cap's circle is above the horizon for `|t| < tau`, where
/// `r_z = cos sigma c + sin sigma s cos t`. The cap hides an arc of `2 beta` of the horizon:
///
/// ```text
/// cos tau  = -cot sigma c / s        (tau is 0 or pi if the circle does not meet the horizon)
/// cos beta = cos sigma / s
/// E = tau sin^2 sigma c - sin sigma cos sigma s sin tau + beta
/// ```
///
/// The result is `max(c, 0)` for a cap that does not meet the horizon, and for a cap of zero width. Domain:
/// `cos_elevation` in [-1, 1], `length` in [0, 1].
#[must_use]
pub fn clipped_form_factor(cos_elevation: f64, length: f64) -> f64 {
    let c = cos_elevation;
    let (sin_sigma, cos_sigma) = (length.sqrt(), (1.0 - length).max(0.0).sqrt());
    // The axis is farther from the horizon than from the border of the cap.
    if c.abs() >= sin_sigma {
        return c.max(0.0);
    }
    // tau and beta are computed from sine and cosine, both multiplied by the same length: sin^2 sigma s^2 - cos^2 sigma
    // c^2 = sin^2 sigma - c^2.
    let met = (length - c * c).sqrt();
    let tau = atan2(met, -cos_sigma * c);
    let beta = atan2(met, cos_sigma);
    let projected_solid_angle = tau * length * c - cos_sigma * met + beta;
    (projected_solid_angle / (PI * length)).max(0.0)
}

/// An approximation of [`clipped_form_factor`] with two additions and a division: `(length + c) / (length + 1)`,
/// clamped at zero [Hill and Heitz 2016].
///
/// It is exact for a light straight above and for a light of zero width. Otherwise its error is between -0.029 and
/// +0.180 (at `length` 0.64, `c` 0.225), and at most +0.106 if the cap does not meet the horizon. Multiplied by
/// `length`, the error is relative to the light of a hemisphere. This error is 0.042 on average over `c` and `length`.
/// It is between -0.0075 and +0.135 (at `length` 0.82, `c` 0.165), and at most +0.051 if the cap does not meet the
/// horizon.
#[must_use]
pub fn cheap_form_factor(cos_elevation: f64, length: f64) -> f64 {
    ((length + cos_elevation) / (length + 1.0)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The midpoint rule in polar angle and azimuth about the cap's axis.
    fn by_quadrature(c: f64, length: f64) -> f64 {
        let (sigma, s) = (length.sqrt().asin(), (1.0 - c * c).sqrt());
        let (rings, sectors) = (400, 800);
        let mut sum = 0.0;
        for i in 0..rings {
            let (sin, cos) = ((f64::from(i) + 0.5) / f64::from(rings) * sigma).sin_cos();
            for j in 0..sectors {
                let t = (f64::from(j) + 0.5) / f64::from(sectors) * 2.0 * PI;
                sum += (cos * c + sin * s * t.cos()).max(0.0) * sin;
            }
        }
        sum * sigma / f64::from(rings) * 2.0 / f64::from(sectors) / length
    }

    #[test]
    fn it_is_the_cap_s_cosine_weighted_solid_angle() {
        for length in [1e-3, 0.02, 0.1, 0.35, 0.6, 0.85, 0.99, 1.0] {
            for c in [-1.0, -0.95, -0.7, -0.3, -0.02, 0.0, 0.02, 0.3, 0.7, 0.95, 1.0] {
                let (found, wanted) = (clipped_form_factor(c, length), by_quadrature(c, length));
                assert!((found - wanted).abs() < 2e-5, "{c} {length}: {found} {wanted}");
            }
        }
    }

    #[test]
    fn known_caps_have_known_values() {
        // The hemisphere above; the hemisphere to the side, half of which is visible; the hemisphere below.
        assert!((clipped_form_factor(1.0, 1.0) - 1.0).abs() < 1e-15);
        assert!((clipped_form_factor(0.0, 1.0) - 0.5).abs() < 1e-15);
        assert!(clipped_form_factor(-1.0, 1.0) < 1e-15);
        // A hemisphere at any elevation gives (1 + c) / 2.
        assert!((clipped_form_factor(0.6, 1.0) - 0.8).abs() < 1e-14);
        // The result for a light of zero width is its cosine.
        assert_eq!([clipped_form_factor(0.3, 0.0), clipped_form_factor(-0.3, 0.0)], [0.3, 0.0]);
    }

    #[test]
    fn it_is_continuous_where_the_border_meets_the_horizon() {
        for length in [0.05, 0.4, 0.9] {
            for c in [f64::sqrt(length), -f64::sqrt(length)] {
                let [before, after] = [-1e-9, 1e-9].map(|by| clipped_form_factor(c + by, length));
                assert!((before - after).abs() < 1e-8, "{c} {length}: {before} {after}");
            }
        }
    }

    #[test]
    fn the_cheap_fit_has_the_documented_error() {
        let (mut factor, mut light, mut mean) = ([0.0_f64; 3], [0.0_f64; 3], 0.0);
        let (rows, columns) = (300, 600);
        for i in 1..=rows {
            let length = f64::from(i) / f64::from(rows);
            for j in 0..=columns {
                let c = f64::from(2 * j) / f64::from(columns) - 1.0;
                let off = cheap_form_factor(c, length) - clipped_form_factor(c, length);
                let above = if c * c > length { off } else { 0.0 };
                factor = [factor[0].max(off), factor[1].min(off), factor[2].max(above)];
                light = [light[0].max(length * off), light[1].min(length * off), light[2].max(length * above)];
                mean += length * off.abs() / f64::from(rows * (columns + 1));
            }
        }
        let wanted = [0.1803, -0.0288, 0.1059, 0.1346, -0.0075, 0.0507];
        for (found, wanted) in factor.into_iter().chain(light).zip(wanted) {
            assert!((found - wanted).abs() < 3e-4, "{found} {wanted}");
        }
        assert!((mean - 0.042).abs() < 3e-4, "{mean}");
        for length in [0.0, 0.4, 1.0] {
            assert_eq!(cheap_form_factor(1.0, length), 1.0);
        }
        assert_eq!([cheap_form_factor(0.3, 0.0), cheap_form_factor(-0.3, 0.0)], [0.3, 0.0]);
    }
}
