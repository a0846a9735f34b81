//! Anisotropic Beckmann with height-correlated Smith masking.

use std::f64::consts::{FRAC_2_SQRT_PI, PI};

use glam::{DVec2, DVec3};

use super::scattering::{Brdf, BrdfRules, BrdfSample, PredictionFactors};
use crate::math::{erfc, exp, ln};

/// Microfacets with normally distributed slopes [Beckmann and Spizzichino 1963; Heitz 2014, section 5.3]. The Fresnel
/// factor is one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beckmann {
    /// Roughness along x, in (0, 1]: the square root of twice the variance of the slopes.
    pub alpha_x: f64,
    /// Roughness along y, in (0, 1].
    pub alpha_y: f64,
}

/// Beckmann as an item of [`super::BrdfKind`].
pub(super) struct BeckmannRules;

impl BrdfRules for BeckmannRules {
    fn surface(&self, [alpha_x, alpha_y]: [f64; 2]) -> Box<dyn Brdf> {
        Box::new(Beckmann { alpha_x, alpha_y })
    }

    fn prediction_factors(&self) -> PredictionFactors {
        PredictionFactors { sample: 10.0, error: 4.0 }
    }
}

/// Above this exponent `exp(-x)` is set to zero, because the factor in front of it can be infinite.
const MOST_EXPONENT: f64 = 700.0;

impl Beckmann {
    /// Density of microfacet normals: `D(wm) = exp(-(x^2/ax^2 + y^2/ay^2) / z^2) / (pi ax ay z^4)`. Per steradian; zero
    /// below the horizon.
    #[must_use]
    pub fn distribution(&self, wm: DVec3) -> f64 {
        if wm.z <= 0.0 {
            return 0.0;
        }
        let (x, y, z2) = (wm.x / self.alpha_x, wm.y / self.alpha_y, wm.z * wm.z);
        let exponent = (x * x + y * y) / z2;
        // The exponent is NaN or infinite if z^2 is zero.
        if exponent.is_nan() || exponent > MOST_EXPONENT {
            return 0.0;
        }
        exp(-exponent) / (PI * self.alpha_x * self.alpha_y * z2 * z2)
    }

    /// Smith's `G1(w) = 1 / (1 + Lambda)`, `Lambda = exp(-a^2) / (2 a sqrt(pi)) - erfc(a) / 2` with
    /// `a = z / |(ax x, ay y)|` [Heitz 2014, equation 73]. In [0, 1]; zero at the horizon.
    #[must_use]
    pub fn smith_g1(&self, w: DVec3) -> f64 {
        let (x, y) = (self.alpha_x * w.x, self.alpha_y * w.y);
        let a = w.z / (x * x + y * y).sqrt();
        if a > 6.0 {
            return 1.0;
        }
        let lambda_a = (0.25 * FRAC_2_SQRT_PI * exp(-a * a) - 0.5 * a * erfc(a)).max(0.0);
        a / (a + lambda_a)
    }

    /// `G2 / G1(wo)` for correlated heights: `1 / G2 = 1 / G1(wo) + 1 / G1(wi) - 1`. In [0, 1]; zero if `wi` is not
    /// above the horizon.
    fn g2_over_g1(&self, wo: DVec3, wi: DVec3) -> f64 {
        if wi.z <= 0.0 {
            return 0.0;
        }
        let [o, i] = [wo, wi].map(|w| self.smith_g1(w));
        i / (o + i * (1.0 - o))
    }

    /// A normal visible from `wo`. If the surface is stretched such that both roughnesses are one, the slopes along and
    /// across the view are independent [Heitz and d'Eon 2014].
    fn visible_normal(&self, wo: DVec3, u: [f64; 2]) -> DVec3 {
        let stretched = DVec3::new(self.alpha_x * wo.x, self.alpha_y * wo.y, wo.z).normalize();
        let flat = stretched.truncate();
        let sin = flat.length();
        let along = if sin > 0.0 { flat / sin } else { DVec2::X };
        let slope = VisibleSlope { cos: stretched.z, sin }.invert(u[0]) * along
            + VisibleSlope { cos: 1.0, sin: 0.0 }.invert(u[1]) * along.perp();
        DVec3::new(-self.alpha_x * slope.x, -self.alpha_y * slope.y, 1.0).normalize()
    }
}

/// The distribution of visible slopes `x` along the view, on a surface of roughness one. Its density is
/// `max(0, cos - x sin) exp(-x^2) / sqrt(pi)`, not normalised. For a view along the normal, and for slopes across the
/// view, it is the normal distribution.
struct VisibleSlope {
    cos: f64,
    sin: f64,
}

impl VisibleSlope {
    /// Steeper slopes have a probability below 1e-16.
    const STEEPEST: f64 = 6.0;
    /// Halley's method ends with a step shorter than this. Its error is then about the cube of this step, divided by
    /// the squared distance to the steepest visible slope. This is far less than 1e-8 of the lobe's width.
    const LAST_STEP: f64 = 1e-5;
    /// The largest number of steps; bisection alone needs this many. Halley's method takes three or four.
    const STEPS: usize = 64;

    /// The integral of the density up to `x`, `cos erfc(-x) / 2 + sin exp(-x^2) / (2 sqrt(pi))`, and the value of
    /// `exp(-x^2) / sqrt(pi)`.
    fn below(&self, x: f64) -> (f64, f64) {
        let bell = 0.5 * FRAC_2_SQRT_PI * exp(-x * x);
        (0.5 * (self.cos * erfc(-x) + self.sin * bell), bell)
    }

    /// The quantile function: the slope whose cumulative probability is `u`. Domain: `u` in [0, 1].
    fn invert(&self, u: f64) -> f64 {
        let top = if self.cos < Self::STEEPEST * self.sin { self.cos / self.sin } else { Self::STEEPEST };
        let wanted = u * self.below(top).0;
        // The initial guess blends the quantiles of a view along the normal and of a grazing view.
        let grazing = -(-ln(u.max(f64::EPSILON))).sqrt();
        let (mut low, mut high) = (-Self::STEEPEST, top);
        let mut x = (self.cos * normal_slope(u) + self.sin * grazing).clamp(low, high);
        for _ in 0..Self::STEPS {
            let (below, bell) = self.below(x);
            let off = below - wanted;
            (low, high) = if off > 0.0 { (low, x) } else { (x, high) };
            // Halley: f = off, f' = visible bell, f'' = -(sin + 2 x visible) bell.
            let visible = self.cos - x * self.sin;
            let step = off / (visible * bell);
            let next = x - step / (1.0 + 0.5 * step * (self.sin + 2.0 * x * visible) / visible);
            if next >= low && next <= high {
                if (next - x).abs() < Self::LAST_STEP {
                    return next;
                }
                x = next;
            } else {
                x = 0.5 * (low + high);
            }
        }
        x
    }
}

/// The slope whose cumulative probability is `u` for the density `exp(-x^2) / sqrt(pi)`, to six digits:
/// `erf^-1(2 u - 1)` [Giles 2012, "Approximating the erfinv function"].
fn normal_slope(u: f64) -> f64 {
    const MIDDLE: [f64; 9] = [
        2.810_226_36e-8,
        3.432_739_39e-7,
        -3.523_387_7e-6,
        -4.391_506_54e-6,
        2.185_808_7e-4,
        -1.253_725_03e-3,
        -4.177_681_64e-3,
        0.246_640_727,
        1.501_409_41,
    ];
    const TAIL: [f64; 9] = [
        -2.002_142_57e-4,
        1.009_505_58e-4,
        1.349_343_22e-3,
        -3.673_428_44e-3,
        5.739_507_73e-3,
        -7.622_461_3e-3,
        9.438_870_47e-3,
        1.001_674_06,
        2.832_976_82,
    ];
    let w = -ln((4.0 * u * (1.0 - u)).max(f64::EPSILON));
    let (w, coefficients) = if w < 5.0 { (w - 2.5, MIDDLE) } else { (w.sqrt() - 3.0, TAIL) };
    coefficients.iter().fold(0.0, |sum, c| sum * w + c) * (2.0 * u - 1.0)
}

impl Brdf for Beckmann {
    /// `D(wm) G2(wo, wi) / (4 cos(theta_o))`.
    fn eval_cos(&self, wo: DVec3, wi: DVec3) -> f64 {
        self.pdf(wo, wi) * self.g2_over_g1(wo, wi)
    }

    /// `D(wm) G2(wo, wi) (wo . wm) / cos(theta_o)`.
    fn eval_normal(&self, wo: DVec3, wm: DVec3) -> f64 {
        let cosine = wo.dot(wm);
        if cosine <= 0.0 || wo.z <= 0.0 {
            return 0.0;
        }
        let g2 = self.smith_g1(wo) * self.g2_over_g1(wo, 2.0 * cosine * wm - wo);
        self.distribution(wm) * g2 * cosine / wo.z
    }

    fn sample(&self, wo: DVec3, u: [f64; 2]) -> BrdfSample {
        let wm = self.visible_normal(wo, u);
        let cos_theta_d = wo.dot(wm);
        let wi = 2.0 * cos_theta_d * wm - wo;
        BrdfSample { wi, weight: self.g2_over_g1(wo, wi), cos_theta_d }
    }

    /// `D(wm) G1(wo) / (4 cos(theta_o))`. Directions below the horizon have a density too, because the sampler draws
    /// them.
    fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        let sum = wo + wi;
        if wo.z <= 0.0 || sum.z <= 0.0 {
            return 0.0;
        }
        self.distribution(sum.normalize()) * self.smith_g1(wo) / (4.0 * wo.z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tests views from the normal to the horizon, and probabilities from nearly 0 to nearly 1.
    #[test]
    fn slopes_are_inverted() {
        assert!((normal_slope(0.975) - 1.385_903_824).abs() < 1e-5, "1.96 standard deviations");
        let views = [(1.0, 0.0), (1.0, 1e-9), (0.9, 0.435_889_894), (0.5, 0.866_025_404), (0.01, 0.999_95), (0.0, 1.0)];
        for (cos, sin) in views {
            let visible = VisibleSlope { cos, sin };
            let whole = visible.below(if sin > 0.0 { (cos / sin).min(6.0) } else { 6.0 }).0;
            for u in [1e-12, 1e-6, 0.01, 0.2, 0.5, 0.7, 0.99, 1.0 - 1e-6] {
                let found = visible.below(visible.invert(u)).0 / whole;
                assert!((found - u).abs() < 1e-8 && (found / u - 1.0).abs() < 1e-4, "{cos} {u}: {found}");
            }
        }
    }
}
