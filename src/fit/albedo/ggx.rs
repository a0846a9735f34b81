//! The directional albedo of GGX with height-correlated Smith masking, and its part weighted by Schlick's fifth power.

use std::{f64::consts::PI, sync::LazyLock};

use super::quadrature::Rule;
use crate::math::{cos, exp, ln};

/// The number of azimuths for views below and above [`HIGH`], and of slopes along an azimuth for surfaces below and
/// above [`ROUGH`]. At 3,000 places, values differ by at most 3e-7 from those with 96 of both.
const AZIMUTHS: [usize; 2] = [24, 14];
const SLOPES: [usize; 2] = [28, 24];
/// The cosine from which fewer azimuths are enough.
const HIGH: f64 = 1.0 / 16.0;
/// The alpha from which fewer slopes are enough.
const ROUGH: f64 = 1.0 / 16.0;
static RULES: LazyLock<[Rule; 2]> = LazyLock::new(|| SLOPES.map(Rule::new));
static COSINES: LazyLock<[Vec<f64>; 2]> =
    LazyLock::new(|| AZIMUTHS.map(|n| (0..n).map(|i| cos(PI * (i as f64 + 0.5) / n as f64)).collect()));

/// Albedo, and albedo weighted by `(1 - wo . wm)^5`, for a Fresnel factor of one. Domain: alpha in [1e-4, 1], cosine in
/// [1e-3, 1].
///
/// The integral runs over the slope of the normal, in polar coordinates `r`, `phi` around the normal of the surface.
/// With `t = tan(theta_o)`, the light is above the horizon for `r < R(phi)`, where `R` solves `r^2 - 2 t r cos(phi) = 1`.
/// So `R = e^y` with `sinh(y) = t cos(phi)`. The variables are `psi` with `y = asinh(t) cos(psi)`, in which the
/// midpoint rule converges exponentially, and `x` with `r = alpha sinh(x)`, in which the density of slopes is
/// `2 sinh(x) / cosh(x)^3`.
pub(super) fn ggx(alpha: f64, cosine: f64) -> [f64; 2] {
    let (cosines, rule) = (&COSINES[usize::from(cosine >= HIGH)], &RULES[usize::from(alpha >= ROUGH)]);
    let cosine = cosine.min(1.0 - 1e-12);
    let (alpha2, tangent) = (alpha * alpha, (1.0 - cosine * cosine).sqrt() / cosine);
    let view = (1.0 + alpha2 * tangent * tangent).sqrt();
    let widest = ln(tangent + (1.0 + tangent * tangent).sqrt());
    let mut sum = [0.0; 2];
    for cos_psi in cosines {
        let reach = exp(widest * cos_psi);
        let (slope, cosh) = (0.5 * (reach - 1.0 / reach), 0.5 * (reach + 1.0 / reach));
        let sin_psi = (1.0 - cos_psi * cos_psi).sqrt();
        let azimuth = widest * sin_psi * cosh / ((tangent - slope) * (tangent + slope)).sqrt();
        let end = reach / alpha;
        let part = rule.integrate(0.0, ln(end + (1.0 + end * end).sqrt()), |x| {
            let grown = exp(x);
            let (sinh, cosh) = (0.5 * (grown - 1.0 / grown), 0.5 * (grown + 1.0 / grown));
            let r = alpha * sinh;
            let r2 = r * r;
            // The cosine of the light, from the two zeros R and -1/R of its numerator.
            let z = (cosine * (reach - r) * (1.0 + r * reach) / (reach * (1.0 + r2))).max(0.0);
            let light = (z * z + alpha2 * (1.0 - z * z).max(0.0)).sqrt();
            let masking = 2.0 * z / (z * view + light);
            // `wo . wm` is `cosine (1 + t r cos(phi))`, divided by the length of the normal.
            let facing = 1.0 + r * slope;
            let weight = 2.0 * sinh / (cosh * cosh * cosh) * facing * masking;
            let grazing = (1.0 - cosine * facing / (1.0 + r2).sqrt()).max(0.0);
            let grazing2 = grazing * grazing;
            [weight, weight * grazing2 * grazing2 * grazing]
        });
        sum.iter_mut().zip(part).for_each(|(sum, part)| *sum += azimuth * part / cosines.len() as f64);
    }
    sum
}
