//! The lobe of a BRDF as weighted directions.

use glam::DVec3;

use super::sequence::net;
use crate::brdf::Brdf;

/// Samples of a lobe: `2^12`.
const LOG2_SAMPLES: u32 = 12;
/// Digital shift of the samples' points.
const SCRAMBLE: [u32; 2] = [0x5bd1_e995, 0x2c1b_3c6d];

/// A cosine-weighted lobe, normalised to a distribution, in the tangent frame.
#[derive(Debug, Clone)]
pub(super) struct Lobe {
    /// Unit vector of the mean direction.
    pub(super) axis: DVec3,
    /// Unit vectors.
    pub(super) directions: Vec<DVec3>,
    /// Weight of each direction. The weights add up to one.
    pub(super) weights: Vec<f64>,
    /// Reflectance for a Fresnel factor of one.
    pub(super) amplitude: f64,
    /// Reflectance for a Fresnel factor of `(1 - wo.wm)^5`.
    pub(super) fresnel: f64,
}

impl Lobe {
    /// The lobe of `brdf` for the view direction `wo`. Domain: `wo.z > 0`.
    pub(super) fn sample(brdf: &dyn Brdf, wo: DVec3) -> Self {
        let drawn: Vec<_> = net(LOG2_SAMPLES, SCRAMBLE).map(|u| brdf.sample(wo, u)).collect();
        let mean = |f: fn(f64) -> f64| {
            drawn.iter().map(|sample| sample.weight * f(sample.cos_theta_d)).sum::<f64>() / drawn.len() as f64
        };
        let amplitude = mean(|_| 1.0);
        let fresnel = mean(|cos| {
            let x = (1.0 - cos).max(0.0);
            x * x * x * x * x
        });
        let lit = drawn.iter().filter(|sample| sample.weight > 0.0);
        let (directions, weights) = lit.map(|sample| (sample.wi, sample.weight)).unzip();
        Self { amplitude, fresnel, ..Self::of(directions, weights) }
    }

    /// The lobe of weighted directions. Domain: their mean is not zero.
    fn of(directions: Vec<DVec3>, mut weights: Vec<f64>) -> Self {
        let total: f64 = weights.iter().sum();
        for weight in &mut weights {
            *weight /= total;
        }
        let axis = directions.iter().zip(&weights).map(|(w, weight)| *weight * *w).sum::<DVec3>().normalize();
        Self { axis, directions, weights, amplitude: 1.0, fresnel: 0.0 }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use std::f64::consts::PI;

    use glam::DMat3;

    use super::*;
    use crate::{Ltc, brdf::Ggx, math::direction};

    /// The LTC of `matrix` as a lobe.
    pub(in super::super) fn planted(matrix: DMat3) -> Lobe {
        let ltc = Ltc::new(matrix).expect("a regular matrix");
        let directions: Vec<DVec3> = net(LOG2_SAMPLES, SCRAMBLE).map(|u| ltc.sample(u)).collect();
        let weights = vec![1.0; directions.len()];
        Lobe::of(directions, weights)
    }

    /// A lobe of directions with the given weights.
    pub(in super::super) fn of(samples: &[(DVec3, f64)]) -> Lobe {
        let (directions, weights) = samples.iter().copied().unzip();
        Lobe::of(directions, weights)
    }

    /// Compares with the integral of the BRDF over the hemisphere, by the midpoint rule.
    #[test]
    fn mean_and_reflectance_equal_the_brdf() {
        for (alpha_x, alpha_y, theta, phi) in [(1.0, 1.0, 0.0, 0.0), (0.6, 0.2, 1.1, 0.9), (0.3, 0.9, 1.4, 2.5)] {
            let (ggx, wo) = (Ggx { alpha_x, alpha_y }, direction(theta, phi));
            let (mut sum, mut amplitude, mut fresnel) = (DVec3::ZERO, 0.0, 0.0);
            let n = 600;
            for (i, j) in (0..n).flat_map(|i| (0..2 * n).map(move |j| (i, j))) {
                let z = (f64::from(i) + 0.5) / f64::from(n);
                let wi = direction(z.acos(), PI * (f64::from(j) + 0.5) / f64::from(n));
                let reflected = ggx.eval_cos(wo, wi) * PI / f64::from(n * n);
                sum += reflected * wi;
                amplitude += reflected;
                fresnel += reflected * (1.0 - wo.dot((wo + wi).normalize())).powi(5);
            }
            let lobe = Lobe::sample(&ggx, wo);
            assert!((lobe.weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            assert!((lobe.axis - sum.normalize()).length() < 1e-3, "{theta}: {} {sum}", lobe.axis);
            assert!((lobe.amplitude - amplitude).abs() < 1e-3 && (lobe.fresnel - fresnel).abs() < 1e-3, "{theta}");
        }
    }
}
