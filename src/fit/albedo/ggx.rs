//! The directional albedo of isotropic GGX with height-correlated Smith masking, weighted by Fresnel factors.

use std::{f64::consts::PI, sync::LazyLock};

use super::quadrature::{RULES, asinh};
use crate::math::{cos, exp, ln};

/// The largest numbers of azimuths and slopes.
const MOST: [usize; 2] = [20, 28];
/// The largest number of slopes for surfaces with an alpha above [`ROUGH`].
const MOST_ROUGH: f64 = 22.0;
const ROUGH: f64 = 1.0 / 16.0;
static COSINES: LazyLock<Vec<Vec<f64>>> = LazyLock::new(|| {
    let azimuths = |n: usize| (0..n).map(|i| cos(PI * (i as f64 + 0.5) / n as f64)).collect();
    (0..=MOST[0]).map(azimuths).collect()
});

/// The number of azimuths for views with `asinh(tan(theta_o)) = widest`. Together with [`slopes`] it gives values that
/// differ by at most 3e-7 from those with 96 azimuths and 96 slopes, at 3,000 places.
fn azimuths(widest: f64) -> usize {
    ((3.0 + 4.0 * widest).min(8.5 + 1.4 * widest).ceil() as usize).min(MOST[0])
}

/// The number of slopes for the variable `x` from 0 to `end`.
pub(super) fn slopes(alpha: f64, end: f64) -> usize {
    let most = if alpha < ROUGH { MOST[1] as f64 } else { MOST_ROUGH };
    (2.5 + 5.0 * end).min(most).ceil() as usize
}

/// Albedo for a Fresnel factor of one, and albedo weighted by `(1 - x)^5` and by `x (1 - x)^6` with `x = wo . wm`. Domain:
/// alpha in [1e-4, 1], cosine in [1e-3, 1].
pub(super) fn ggx(alpha: f64, cosine: f64) -> [f64; 3] {
    reflected(alpha, cosine, false, powers)
}

/// `weight` with the factors 1, `(1 - x)^5` and `x (1 - x)^6`.
pub(super) fn powers(weight: f64, incident: f64) -> [f64; 3] {
    let grazing = (1.0 - incident).max(0.0);
    let grazing2 = grazing * grazing;
    let fifth = weight * grazing2 * grazing2 * grazing;
    [weight, fifth, fifth * grazing * incident]
}

/// The integral of `factors(weight, wo . wm)`, where the integral of `weight` is the albedo. `is_fine` uses the most
/// nodes, for factors that are steeper than [`powers`].
///
/// The integral runs over the slope of the normal, in polar coordinates `r`, `phi` around the normal of the surface.
/// With `t = tan(theta_o)`, the light is above the horizon for `r < R(phi)`, where `R` solves `r^2 - 2 t r cos(phi) = 1`.
/// So `R = e^y` with `sinh(y) = t cos(phi)`. The variables are `psi` with `y = asinh(t) cos(psi)`, in which the
/// midpoint rule converges exponentially, and `x` with `r = alpha sinh(x)`, in which the density of slopes is
/// `2 sinh(x) / cosh(x)^3`. Longer intervals need more nodes.
pub(super) fn reflected<const N: usize>(
    alpha: f64,
    cosine: f64,
    is_fine: bool,
    factors: impl Fn(f64, f64) -> [f64; N],
) -> [f64; N] {
    let cosine = cosine.min(1.0 - 1e-12);
    let (alpha2, tangent) = (alpha * alpha, (1.0 - cosine * cosine).sqrt() / cosine);
    let view = (1.0 + alpha2 * tangent * tangent).sqrt();
    let widest = asinh(tangent);
    let cosines = &COSINES[if is_fine { MOST[0] } else { azimuths(widest) }];
    let mut sum = [0.0; N];
    for cos_psi in cosines {
        let reach = exp(widest * cos_psi);
        let lowest = 1.0 / reach;
        let (slope, cosh) = (0.5 * (reach - lowest), 0.5 * (reach + lowest));
        let sin_psi = (1.0 - cos_psi * cos_psi).sqrt();
        let azimuth = widest * sin_psi * cosh / ((tangent - slope) * (tangent + slope)).sqrt();
        let end = reach * (1.0 / alpha);
        let end = end + (1.0 + end * end).sqrt();
        let length = ln(end);
        let inverse = 1.0 / end;
        // The integrand at `x`, for `e^x` and `e^-x`.
        let at = |grown: f64, shrunk: f64| -> [f64; N] {
            let (sinh, cosh) = (0.5 * (grown - shrunk), 0.5 * (grown + shrunk));
            let r = alpha * sinh;
            let normal = 1.0 / (1.0 + r * r).sqrt();
            // The cosine of the light, from the two zeros R and -1/R of its numerator.
            let z = (cosine * (reach - r) * (lowest + r) * normal * normal).max(0.0);
            let light = (z * z + alpha2 * (1.0 - z * z).max(0.0)).sqrt();
            // `wo . wm` is `cosine (1 + t r cos(phi))`, divided by the length of the normal.
            let facing = 1.0 + r * slope;
            let weight = 4.0 * sinh * facing * z / (cosh * cosh * cosh * (z * view + light));
            let incident = cosine * facing * normal;
            factors(weight, incident)
        };
        let mut part = [0.0; N];
        // Nodes are symmetric, so one exponential serves two.
        let nodes = RULES[if is_fine { MOST[1] } else { slopes(alpha, length) }].nodes();
        for (i, [x, weight]) in nodes[..nodes.len().div_ceil(2)].iter().enumerate() {
            let grown = exp(length * x);
            let shrunk = 1.0 / grown;
            let mut add = |values: [f64; N]| part.iter_mut().zip(values).for_each(|(sum, x)| *sum += weight * x);
            add(at(grown, shrunk));
            if 2 * i + 1 != nodes.len() {
                add(at(end * shrunk, inverse * grown));
            }
        }
        sum.iter_mut().zip(part).for_each(|(sum, part)| *sum += azimuth * length * part / cosines.len() as f64);
    }
    sum
}
