//! Fuzz: sheen of a volume of fibres. Its lobe is a linearly transformed cosine.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};

use super::scattering::{Brdf, BrdfRules, BrdfSample};
use crate::math::{SquarePoint, cosine_hemisphere, exp};

/// The multiple-scattering sheen of Zeltner, Burley and Chiang 2022, which OpenPBR uses as fuzz. A layer of upright
/// fibres reflects light after any number of bounces. The remaining light passes through.
///
/// ```text
/// f cos i = R D(c) a^2 / |c|^3,    c = M^-1 wi = (a x + b z, a y, z),    D(c) = max(z, 0) / (pi |c|)
/// ```
///
/// with `x` along the view's azimuth. The albedo `R` and the numbers `a` and `b` are functions of the view's cosine and
/// the roughness. Instead of the authors' table, this file uses closed-form approximations. They are from MaterialX
/// 1.39, `mx_microfacet_sheen.glsl` (Copyright Contributors to the MaterialX Project, Apache-2.0), based on
/// <https://github.com/tizian/ltc-sheen> (Apache-2.0). The authors fitted each view separately, so the BRDF is only
/// approximately reciprocal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fuzz {
    roughness: f64,
}

/// Fuzz as an item of [`super::BrdfKind`].
pub(super) struct FuzzRules;

impl BrdfRules for FuzzRules {
    fn surface(&self, [alpha_x, alpha_y]: [f64; 2]) -> Box<dyn Brdf> {
        Box::new(Fuzz::new(alpha_x.max(alpha_y).sqrt()))
    }

    fn is_isotropic(&self) -> bool {
        true
    }

    fn follows_reflection(&self) -> bool {
        false
    }

    fn is_ltc(&self) -> bool {
        true
    }
}

/// The authors did not fit smaller roughnesses.
const LEAST_ROUGHNESS: f64 = 0.01;
/// The smallest albedo. For views from above and roughnesses from 0.04 to 0.13, the closed form is negative, down to
/// -2e-5.
const LEAST_ALBEDO: f64 = 1e-6;

impl Fuzz {
    /// The fuzz of a surface with a roughness in [0, 1], the square root of a table's alpha. Values below 0.01 are
    /// raised to 0.01.
    #[must_use]
    pub fn new(roughness: f64) -> Self {
        Self { roughness: roughness.max(LEAST_ROUGHNESS) }
    }

    /// The albedo `R` for a view of cosine `x`. In [1e-6, 0.75].
    #[must_use]
    pub fn albedo(&self, x: f64) -> f64 {
        let y = self.roughness;
        let width = y * (0.020_660_7 + 1.584_91 * y) / (0.037_942_4 + y * (1.322_27 + y));
        let middle = y * (-0.193_854 + y * (-1.148_85 + y * (1.793_2 - 0.959_43 * y * y))) / (0.046_391 + y);
        let offset = y * (0.000_654_023 + (-0.020_781_8 + 0.119_681 * y) * y) / (1.262_64 + y * (-1.920_21 + y));
        let away = (x - middle) / width;
        (exp(-0.5 * away * away) / (width * (2.0 * PI).sqrt()) + offset).max(LEAST_ALBEDO)
    }

    /// The numbers `a` and `b` for a view of cosine `x`: `a` is positive, `b` is in (-0.19, 0].
    fn inverse_numbers(self, x: f64) -> [f64; 2] {
        let y = self.roughness;
        let a = (2.581_26 * x + 0.813_703 * y) * y / (1.0 + 0.310_327 * x * x + 2.609_94 * x * y);
        let below = 0.000_025_405_3 + 1.712_28 * x - 1.715_06 * x * y + 1.341_74 * y * y;
        [a, (1.0 - x).max(0.0).sqrt() * (y - 1.0) * y * y * y / below]
    }

    fn sample_with(self, wo: DVec3, [a, b]: [f64; 2], u: [f64; 2]) -> BrdfSample {
        let c = cosine_hemisphere(u);
        let across = DVec3::new((c.x - b * c.z) / a, c.y / a, c.z).normalize();
        let [cos, sin] = azimuth(wo);
        let wi = DVec3::new(cos * across.x - sin * across.y, sin * across.x + cos * across.y, across.z);
        let weight = if wi.z > 0.0 { self.albedo(wo.z) } else { 0.0 };
        BrdfSample { wi, weight, cos_theta_d: super::cos_theta_d(wo, wi) }
    }
}

/// Cosine and sine of a direction's azimuth. The azimuth of the pole is zero.
fn azimuth(w: DVec3) -> [f64; 2] {
    let sin_theta = (w.x * w.x + w.y * w.y).sqrt();
    if sin_theta > 0.0 { [w.x / sin_theta, w.y / sin_theta] } else { [1.0, 0.0] }
}

impl Brdf for Fuzz {
    fn eval_cos(&self, wo: DVec3, wi: DVec3) -> f64 {
        if wo.z <= 0.0 { 0.0 } else { self.albedo(wo.z) * self.pdf(wo, wi) }
    }

    fn sample(&self, wo: DVec3, u: [f64; 2]) -> BrdfSample {
        self.sample_with(wo, self.inverse_numbers(wo.z), u)
    }

    fn sample_all(&self, wo: DVec3, points: &[SquarePoint], drawn: &mut Vec<BrdfSample>) {
        let numbers = self.inverse_numbers(wo.z);
        drawn.extend(points.iter().map(|point| self.sample_with(wo, numbers, point.u)));
    }

    fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        if wi.z <= 0.0 {
            return 0.0;
        }
        let ([a, b], [cos, sin]) = (self.inverse_numbers(wo.z), azimuth(wo));
        let c = DVec3::new(a * (cos * wi.x + sin * wi.y) + b * wi.z, a * (cos * wi.y - sin * wi.x), wi.z);
        let density = a / c.length_squared();
        wi.z / PI * density * density
    }

    fn ltc(&self, wo: DVec3) -> Option<DMat3> {
        let ([a, b], [cos, sin]) = (self.inverse_numbers(wo.z), azimuth(wo));
        let along = DVec3::new(cos, sin, 0.0);
        Some(DMat3::from_cols(along / a, DVec3::new(-sin, cos, 0.0) / a, DVec3::Z - along * (b / a)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Lattice, direction};

    /// Samples of the authors' table of the fibre volume, `ltc_table_sheen_volume` (Apache-2.0): indices of roughness
    /// and cosine in steps of 1/31, then `a`, `b` and `R`.
    const PUBLISHED: [([u32; 2], [f64; 3]); 12] = [
        ([8, 1], [0.10394, -0.13135, 0.60100]),
        ([8, 8], [0.21199, -0.01460, 0.10220]),
        ([8, 16], [0.24877, -0.02636, 0.00733]),
        ([8, 30], [0.38570, -0.02709, 0.00037]),
        ([16, 1], [0.27454, -0.17439, 0.65370]),
        ([16, 8], [0.42539, -0.09729, 0.37145]),
        ([16, 16], [0.49060, -0.05014, 0.15718]),
        ([16, 30], [0.57204, -0.02257, 0.02565]),
        ([24, 1], [0.53027, -0.11957, 0.68862]),
        ([24, 8], [0.66758, -0.09697, 0.52211]),
        ([24, 16], [0.72083, -0.07263, 0.35421]),
        ([24, 30], [0.76785, -0.01865, 0.16553]),
    ];

    #[test]
    fn numbers_are_near_the_authors_table() {
        for ([roughness, cosine], [a, b, albedo]) in PUBLISHED {
            let part = |step: u32| f64::from(step) / 31.0;
            let fuzz = Fuzz::new(part(roughness));
            let [found_a, found_b] = fuzz.inverse_numbers(part(cosine));
            let off = [found_a - a, found_b - b, fuzz.albedo(part(cosine)) - albedo];
            assert!(
                off.iter().zip([0.035, 0.04, 0.01]).all(|(off, most)| off.abs() < most),
                "{roughness} {cosine}: {off:?}"
            );
        }
    }

    /// Reciprocity is exact only if light and view are equal.
    #[test]
    fn it_is_only_approximately_reciprocal() {
        let (fuzz, wo) = (Fuzz::new(0.6), direction(0.9, 0.3));
        let ratios = Lattice::new(64, [0.3, 0.1]).points().map(|u| {
            let wi = fuzz.sample(wo, u).wi;
            fuzz.eval_cos(wo, wi) / wi.z / (fuzz.eval_cos(wi, wo) / wo.z)
        });
        let most = ratios.map(|ratio| ratio.max(1.0 / ratio)).fold(0.0, f64::max);
        assert!((1.1..3.0).contains(&most), "{most}");
    }
}
