//! The Fresnel factor of metals by two reflectances, seen from above and at 82 degrees.

use glam::DVec3;

use super::Brdf;
use crate::math::SquarePoint;

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

/// The edge term of the lobe for `wo`: its albedo weighted by [`edge_weight`], the mean over the reflections drawn from
/// `points`, one at least. For GGX `E[G2/G1 x (1 - x)^6]` over visible normals. A metal reflects
/// `F0 (amplitude - fresnel) + F90 fresnel - b edge`.
#[must_use]
pub fn edge_term(brdf: &dyn Brdf, wo: DVec3, points: &[SquarePoint]) -> f64 {
    let mut drawn = Vec::with_capacity(points.len());
    brdf.sample_all(wo, points, &mut drawn);
    drawn.iter().map(|sample| sample.weight * edge_weight(sample.cos_theta_d)).sum::<f64>() / points.len() as f64
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
