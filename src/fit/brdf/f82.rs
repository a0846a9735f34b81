//! The Fresnel factor of metals by two reflectances, seen from above and at 82 degrees.

use glam::DVec3;

use super::Brdf;
use crate::math::{SquarePoint, pow};

/// The cosine at which the second reflectance is told: 1/7, of 82 degrees.
pub const EDGE_COSINE: f64 = 1.0 / 7.0;

/// The weight by which F82 differs from Schlick's factor, for the cosine `x` between view and half vector:
/// `x (1 - x)^6`, at its greatest, 0.0567, where `x` is 1/7.
#[must_use]
pub fn edge_weight(x: f64) -> f64 {
    let (x, away) = (x.clamp(0.0, 1.0), (1.0 - x).clamp(0.0, 1.0));
    let away2 = away * away;
    x * away2 * away2 * away2
}

/// `b`, the factor of [`edge_weight`] that is subtracted from Schlick's factor `S = F0 + (F90 - F0) (1 - x)^5`:
///
/// ```text
/// F82(x) = S(x) - b x (1 - x)^6,    b = (1 - tint) S(1/7) / ((1/7) (6/7)^6)
/// ```
///
/// so that `F82(1/7) = tint S(1/7)` [Kutz, Hasan and Edmondson 2021; OpenPBR 1.1, metal]. Of a dark
/// F0 with a low tint it is below zero around 75 degrees, down to -0.13. Domain: all in [0, 1].
#[must_use]
pub fn edge_factor(f0: f64, f90: f64, tint: f64) -> f64 {
    let away = 1.0 - EDGE_COSINE;
    let schlick = f0 + (f90 - f0) * (away * away * away * away * away);
    (1.0 - tint) * schlick / edge_weight(EDGE_COSINE)
}

/// The light weighed by [`edge_weight`] where all of it has one incidence, that whose Schlick's factor is the part of it
/// that `fresnel` is: `energy x (1 - x)^6` with `1 - x = (fresnel / energy)^(1/5)`.
#[must_use]
pub fn edge_of_parts([energy, fresnel]: [f64; 2]) -> f64 {
    if energy > 0.0 { energy * edge_weight(1.0 - pow(fresnel / energy, 0.2)) } else { 0.0 }
}

/// The most that [`edge_spread`] tells. Seen from above, where the whole term is nearly zero, sharp lobes have more.
const MOST_SPREAD: f64 = 2.0;

/// The edge term of the lobe for `wo`, its albedo weighted by [`edge_weight`], as a part of what [`edge_of_parts`] tells of its
/// other two terms: one for a lobe of one incidence, and smooth over all lobes, which the term itself is not. In [0, 2].
/// Means over the reflections drawn from `points`, one at least.
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
    let told = edge_of_parts(whole);
    if told > 0.0 { (sum(edge_weight) / told).min(MOST_SPREAD) } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The factor has the published values: F0 face on, the tinted one at 82 degrees, F90 at grazing incidence; with a
    /// tint of one it is Schlick's.
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
            let least = (0..=1000).map(|i| f82(1e-3 * f64::from(i), metal)).fold(f64::INFINITY, f64::min);
            assert!(if tint > 0.1 { least > 0.0 } else { (-0.13..0.0).contains(&least) }, "{metal:?}: {least}");
        }
        // F82 of a white metal with a tint of 1/2, by hand at x = 1/2: 1 - (1/2) 2^-7 / ((1/7) (6/7)^6).
        let expected = 1.0 - 0.5 * 0.007_812_5 * 823_543.0 / 46_656.0;
        assert!((f82(0.5, [1.0, 1.0, 0.5]) - expected).abs() < 1e-15);
    }
}
