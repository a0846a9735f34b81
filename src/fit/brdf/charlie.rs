//! Sheen by the Charlie distribution, with the visibility of Estevez and Kulla.

use std::f64::consts::{FRAC_PI_3, PI};

use glam::{DVec2, DVec3};

use super::scattering::{Bends, Brdf, BrdfRules, BrdfSample, PredictionFactors};
use crate::math::{SquarePoint, exp, pow};

/// The sheen of Estevez and Kulla 2017, "Production Friendly Microfacet Sheen BRDF", with a Fresnel factor of one:
/// `f = D / (4 cos o cos i (1 + Lambda(o) + Lambda(i)))`. Their softening of the terminator is left out: it treats view
/// and light differently, so the BRDF would not be reciprocal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Charlie {
    fibres: Fibres,
    /// The coefficients `a` to `e` of `L`.
    shape: [f64; 5],
}

/// Charlie with the visibility of Estevez and Kulla as an item of [`super::BrdfKind`].
pub(super) struct CharlieRules;

impl BrdfRules for CharlieRules {
    fn surface(&self, [alpha_x, alpha_y]: [f64; 2]) -> Box<dyn Brdf> {
        Box::new(Charlie::new(alpha_x.max(alpha_y)))
    }

    fn is_isotropic(&self) -> bool {
        true
    }

    fn follows_reflection(&self) -> bool {
        false
    }

    fn prediction_factors(&self) -> PredictionFactors {
        PredictionFactors { sample: 8.0, error: 0.8 }
    }
}

/// `a` to `e` of `L` for roughness zero and one [Estevez and Kulla 2017, table 1].
const SHAPES: [[f64; 5]; 2] =
    [[25.3245, 3.32435, 0.16801, -1.27393, -4.85967], [21.5473, 3.82987, 0.19823, -1.97760, -4.32054]];

impl Charlie {
    /// The sheen of a surface with roughness `alpha`; see `Fibres::new` for its range.
    #[must_use]
    pub fn new(alpha: f64) -> Self {
        let fibres = Fibres::new(alpha);
        let rough = 1.0 - (1.0 - fibres.alpha) * (1.0 - fibres.alpha);
        let [sharp, round] = SHAPES;
        Self { fibres, shape: std::array::from_fn(|k| sharp[k] + (round[k] - sharp[k]) * rough) }
    }

    /// `L(x) = a / (1 + b x^c) + d x + e` [Estevez and Kulla 2017, equation 3].
    fn log_lambda(&self, x: f64) -> f64 {
        let [a, b, c, d, e] = self.shape;
        a / (1.0 + b * pow(x, c)) + d * x + e
    }

    /// `Lambda = exp(L(cos))` for cosines below one half, else `exp(2 L(1/2) - L(1 - cos))`.
    fn smith_lambda(&self, cosine: f64) -> f64 {
        exp(if cosine < 0.5 {
            self.log_lambda(cosine)
        } else {
            2.0 * self.log_lambda(0.5) - self.log_lambda((1.0 - cosine).max(0.0))
        })
    }
}

impl Brdf for Charlie {
    fn eval_cos(&self, wo: DVec3, wi: DVec3) -> f64 {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        let shadowed = 1.0 + self.smith_lambda(wo.z) + self.smith_lambda(wi.z);
        self.fibres.distribution(wo, wi) / (4.0 * wo.z * shadowed)
    }

    /// `Lambda` has two branches, which join where the cosine is one half.
    fn bends(&self, _: DVec3) -> Bends {
        Bends { theta_i: vec![FRAC_PI_3], phi: Vec::new() }
    }

    fn sample(&self, wo: DVec3, u: [f64; 2]) -> BrdfSample {
        BrdfSample::of(self, wo, self.fibres.sample(wo, &SquarePoint::new(u)))
    }

    fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        self.fibres.pdf(wo, wi)
    }
}

/// The Charlie distribution of normals, with a sampler for the light that these normals reflect. Most of them are far
/// from the surface normal, like the normals of upright fibres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Fibres {
    /// Roughness, from [`Fibres::SMOOTHEST_ALPHA`] to 1.
    alpha: f64,
}

impl Fibres {
    /// The smallest roughness; smaller values are raised to it. It corresponds to a perceptual roughness of 0.07, a
    /// limit that renderers use. Seen from above, a surface with this roughness reflects only 1e-30 of the light. The
    /// reflected light of smoother surfaces would soon underflow to zero.
    pub(super) const SMOOTHEST_ALPHA: f64 = 0.0049;
    /// The width of the sampler, relative to the width of `D` near the horizon, where `D` is almost exponential. The
    /// lobe is wider than `D`, because shadowing removes the light closest to the horizon.
    const WIDER: f64 = 2.0;

    /// Fibres of roughness `alpha` in [0, 1], the square of glTF's sheen roughness. Smaller values are raised to
    /// [`Fibres::SMOOTHEST_ALPHA`].
    pub(super) fn new(alpha: f64) -> Self {
        Self { alpha: alpha.max(Self::SMOOTHEST_ALPHA) }
    }

    /// `D(wm) = (2 + 1/alpha) sin(theta_m)^(1/alpha) / (2 pi)` for the normal halfway between two directions [Estevez
    /// and Kulla 2017, equation 2], `sin^2 = 1 - (z_o + z_i)^2 / (2 + 2 wo . wi)`. Per steradian. Domain: both
    /// directions above the horizon.
    pub(super) fn distribution(self, wo: DVec3, wi: DVec3) -> f64 {
        let wm = (wo + wi).normalize();
        let exponent = 1.0 / self.alpha;
        (2.0 + exponent) * pow(wm.x * wm.x + wm.y * wm.y, 0.5 * exponent) / (2.0 * PI)
    }

    /// The parameters of the sampler for a view.
    ///
    /// Let `b = 1 / (2 alpha)`, and let `s` be the sine of the view's polar angle. To second order, the logarithm of
    /// `D` falls by `b (z cos(o) / (1 + s) + z^2 / 4)` with the height `z` of light at the view's azimuth. At the
    /// horizon it falls by `b s (1 - s) / (1 + s)^2 p^2 / 2` with the azimuth `p` relative to the view.
    fn around(self, wo: DVec3) -> Around {
        let flat = wo.truncate();
        let sin = flat.length();
        let b = 0.5 / self.alpha;
        let slope = b * wo.z / (1.0 + sin);
        let curvature = b * sin * (1.0 - sin).max(0.0) / ((1.0 + sin) * (1.0 + sin));
        Around {
            azimuth: if sin > 0.0 { flat / sin } else { DVec2::X },
            height: Self::WIDER * 2.0 / (slope + (slope * slope + b).sqrt()),
            focus: curvature / (1.0 + curvature + (1.0 + 2.0 * curvature).sqrt()),
        }
    }

    pub(super) fn sample(self, wo: DVec3, point: &SquarePoint) -> DVec3 {
        self.around(wo).sample(point)
    }

    pub(super) fn pdf(self, wo: DVec3, wi: DVec3) -> f64 {
        if wo.z <= 0.0 || wi.z < 0.0 {
            return 0.0;
        }
        self.around(wo).pdf(wi)
    }
}

/// Directions low above the horizon, mostly towards the view's azimuth. The height `z` of a direction has the density
/// `h (1 + h) / (z + h)^2` with `h = height`. The azimuth has a wrapped Cauchy distribution of focus `q`,
/// `(1 - q^2) / (2 pi (1 + q^2 - 2 q cos p))`. Both have heavier tails than the lobe, so weights are bounded.
struct Around {
    azimuth: DVec2,
    height: f64,
    focus: f64,
}

impl Around {
    /// Maps a uniform azimuth with the Moebius map `(e^(i a) + q) / (1 + q e^(i a))`.
    fn sample(&self, point: &SquarePoint) -> DVec3 {
        let (h, q) = (self.height, self.focus);
        let z = (point.u[1] * h / (1.0 + h - point.u[1])).min(1.0);
        let turned = DVec2::new((1.0 + q * q) * point.cos + 2.0 * q, (1.0 - q * q) * point.sin)
            / (1.0 + q * q + 2.0 * q * point.cos);
        (self.azimuth.rotate(turned) * ((1.0 - z) * (1.0 + z)).sqrt()).extend(z)
    }

    fn pdf(&self, wi: DVec3) -> f64 {
        let (h, q) = (self.height, self.focus);
        let flat = wi.truncate();
        let radius = flat.length();
        let cosine = if radius > 0.0 { self.azimuth.dot(flat) / radius } else { 1.0 };
        let of_height = h * (1.0 + h) / ((wi.z + h) * (wi.z + h));
        of_height * (1.0 - q * q) / (2.0 * PI * (1.0 + q * q - 2.0 * q * cosine))
    }
}
