//! The Fresnel factor of metals from two reflectances, at normal incidence and at 82 degrees.

use glam::DVec3;

use super::Brdf;
use crate::math::{SquarePoint, pow};

/// The cosine of the angle of the second reflectance: 1/7, about 82 degrees.
pub const EDGE_COSINE: f64 = 1.0 / 7.0;

/// The shape of the difference between F82 and Schlick's factor: `x (1 - x)^6`, with the cosine `x` between view and
/// half vector. Its maximum is 0.0567 at `x` = 1/7.
#[must_use]
pub fn edge_weight(x: f64) -> f64 {
    let (x, away) = (x.clamp(0.0, 1.0), (1.0 - x).clamp(0.0, 1.0));
    let away2 = away * away;
    x * away2 * away2 * away2
}

/// The factor `b` of [`edge_weight`] in the difference between F82 and Schlick's factor
/// `S = F0 + (F90 - F0) (1 - x)^5`:
///
/// ```text
/// F82(x) = S(x) - b x (1 - x)^6,    b = (1 - tint) S(1/7) / ((1/7) (6/7)^6)
/// ```
///
/// It follows that `F82(1/7) = tint S(1/7)` [Kutz, Hasan and Edmondson 2021; OpenPBR 1.1, metal].
///
/// F82 can be negative only for a tint below 25/49. It is linear in F0 and F90. Where only F90 is one, it is
/// `(1 - x)^5 (1 - b x (1 - x))` with `b = (1 - tint) 49/6`, and `x (1 - x)` is at most 1/4. Its minimum is then -0.13,
/// at 75 degrees for a tint of 0. Where only F0 is one, F82 is not negative for a tint from 0.48.
///
/// Domain: all arguments in [0, 1].
fn edge_factor(f0: f64, f90: f64, tint: f64) -> f64 {
    let away = 1.0 - EDGE_COSINE;
    let schlick = f0 + (f90 - f0) * (away * away * away * away * away);
    (1.0 - tint) * schlick / edge_weight(EDGE_COSINE)
}

/// The light that a metal reflects by F82: `max(schlick - b edge, 0)`. `schlick` is its light by Schlick's factor, and
/// `edge` is the light weighted by [`edge_weight`]. A lobe reflects no negative light, although F82 can be negative.
/// Domain: `f0`, `f90` and `tint` in [0, 1].
#[must_use]
pub fn f82_light(schlick: f64, edge: f64, [f0, f90]: [f64; 2], tint: f64) -> f64 {
    (schlick - edge_factor(f0, f90, tint) * edge).max(0.0)
}

/// The light weighted by [`edge_weight`], if all light has the same angle of incidence. The ratio of `fresnel` to
/// `energy` determines this angle: the result is `energy x (1 - x)^6` with `1 - x = (fresnel / energy)^(1/5)`.
#[must_use]
pub fn edge_of_parts([energy, fresnel]: [f64; 2]) -> f64 {
    if energy > 0.0 { energy * edge_weight(1.0 - pow(fresnel / energy, 0.2)) } else { 0.0 }
}

/// The largest value of [`edge_spread`]. The spread of sharp lobes seen from above would exceed this value, but their
/// whole edge term is nearly zero.
const MOST_SPREAD: f64 = 2.0;

/// The edge term of the lobe for `wo`, divided by the value of [`edge_of_parts`] for its other two terms. The edge term
/// is the albedo weighted by [`edge_weight`]. The ratio is one for a lobe with a single angle of incidence. Unlike the
/// edge term itself, the ratio varies smoothly over all lobes. In [0, 2]. All terms are means over reflections drawn
/// from `points`, which must not be empty.
#[must_use]
pub fn edge_spread(brdf: &dyn Brdf, wo: DVec3, points: &[SquarePoint]) -> f64 {
    let mut drawn = Vec::with_capacity(points.len());
    brdf.sample_all(wo, points, &mut drawn);
    let sum = |of: fn(f64) -> f64| drawn.iter().map(|ray| ray.weight * of(ray.cos_theta_d)).sum::<f64>();
    let schlick = |x: f64| {
        let away = (1.0 - x).max(0.0);
        away * away * (away * away) * away
    };
    let whole = [sum(|_| 1.0), sum(schlick)];
    let one_incidence = edge_of_parts(whole);
    if one_incidence > 0.0 { (sum(edge_weight) / one_incidence).min(MOST_SPREAD) } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The factor has the published values: F0 at normal incidence, the tinted value at 82 degrees, F90 at grazing
    /// incidence. With a tint of one it equals Schlick's factor.
    #[test]
    fn it_goes_through_three_reflectances() {
        let f82 = |x: f64, [f0, f90, tint]: [f64; 3]| {
            f0 + (f90 - f0) * (1.0 - x).powi(5) - edge_factor(f0, f90, tint) * edge_weight(x)
        };
        for (f0, f90, tint) in [(0.9, 1.0, 0.5), (0.2, 1.0, 0.0), (0.56, 0.8, 0.93), (0.04, 1.0, 1.0)] {
            let metal = [f0, f90, tint];
            let schlick = f0 + (f90 - f0) * (6.0_f64 / 7.0).powi(5);
            for (x, expected) in [(1.0, f0), (0.0, f90), (EDGE_COSINE, tint * schlick)] {
                assert!((f82(x, metal) - expected).abs() < 1e-15, "{metal:?} {x}");
            }
        }
        // The domain: F82 is not negative for a tint from 25/49, and negative for a black F0 with a lower tint.
        let least = |[f0, f90, tint]: [f64; 3]| {
            (0..=1000).map(|i| f82(1e-3 * f64::from(i), [f0, f90, tint])).fold(1.0, f64::min)
        };
        for i in 0..121 {
            let [f0, f90] = [i % 11, i / 11].map(|i| 0.1 * f64::from(i));
            assert!(least([f0, f90, 25.0 / 49.0]) > -1e-15, "{f0} {f90}");
        }
        for (f0, tint) in [(0.0, 0.51), (0.04, 0.336), (0.5, 0.03)] {
            assert!(least([f0, 1.0, tint + 1e-3]) >= 0.0 && least([f0, 1.0, tint - 2e-3]) < 0.0, "{f0} {tint}");
        }
        assert!(least([0.0, 1.0, 0.5]) < 0.0 && (-0.127..-0.126).contains(&least([0.0, 1.0, 0.0])));
        // F82 of a white metal with a tint of 1/2, by hand at x = 1/2: 1 - (1/2) 2^-7 / ((1/7) (6/7)^6).
        let expected = 1.0 - 0.5 * 0.007_812_5 * 823_543.0 / 46_656.0;
        assert!((f82(0.5, [1.0, 1.0, 0.5]) - expected).abs() < 1e-15);
    }
}
