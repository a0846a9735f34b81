//! The L3 norm of the difference between a lobe and an LTC [Heitz et al. 2016, section 4].
//!
//! With the lobe's density `g = f cos / albedo` and the LTC's density `D`,
//!
//! ```text
//! loss = (integral |g - D|^3 / integral g^3)^(1/3)
//! ```
//!
//! Heitz et al. minimise the integral of `|f cos - albedo D|^3`. It has the same minimum, because it is the cube of
//! this loss times a constant of the lobe. Like this file, they use the albedo as the norm of the LTC.
//!
//! The integral is estimated from samples of both densities, weighted by the balance heuristic [Veach and Guibas 1995].
//! With `n_b` samples of the lobe and `n_l` of the LTC, a sample `w` of either contributes
//! `|g - D|^3 / (n_b p_b(w) + n_l D(w))`. A BRDF's sampler can draw directions below the horizon. Below the horizon
//! only the samples of the LTC count, and `p_b` is zero.
//!
//! [`Loss::value`] moves the samples of the LTC with its matrix, as the published code of 2017 does. A gradient through
//! moving samples would need the gradient of the BRDF. [`Loss::value_and_gradient`] therefore keeps the samples of the
//! LTC, and the densities for all weights, as they are at its first matrix. The result is a smooth function of the
//! matrix with an exact gradient. It estimates the same integral; the closer the matrix is to the first matrix, the
//! more accurate the estimate is.

use std::{f64::consts::PI, sync::Arc};

use glam::{DMat3, DVec3};

use super::distance::{Distance, Draws, Grain, Lobe, Loss, MetricRules, Samples};
use crate::{
    brdf::Brdf,
    math::{Lattice, cosine_hemisphere, pow},
    stop_check::StopCheck,
};

/// A coarse evaluation takes one in `COARSE` samples, but at least `LEAST_COARSE` samples.
const COARSE: usize = 8;
const LEAST_COARSE: usize = 64;
/// Work of a sample of the LTC, in units of a projection of a sample on a direction. It covers the BRDF and its
/// density.
const SAMPLE_WORK: usize = 8;
/// Seconds of an evaluation for each sample of the LTC, including two samples of the lobe.
const SAMPLE_SECONDS: f64 = 70e-9;

/// The L3 norm as an item of [`super::Metric`].
pub(super) struct L3;

impl MetricRules for L3 {
    fn distance(&self, samples: &Samples) -> Box<dyn Distance> {
        let coarse = (samples.count / COARSE).max(LEAST_COARSE).min(samples.count);
        let cosines = |count| Lattice::new(count, samples.shift).points().map(cosine_hemisphere).collect();
        Box::new(L3Distance { cosines: Arc::new([cosines(coarse), cosines(samples.count)]) })
    }

    fn seconds(&self, samples: usize, _: usize) -> f64 {
        SAMPLE_SECONDS * samples as f64
    }
}

/// The metric with its fixed samples of the clamped cosine, coarse and full. All entries share them.
#[derive(Debug, Clone)]
struct L3Distance {
    cosines: Arc<[Vec<DVec3>; 2]>,
}

impl Distance for L3Distance {
    fn another(&self) -> Box<dyn Distance> {
        Box::new(self.clone())
    }

    fn to<'a>(&'a mut self, lobe: &Lobe<'a>, stop_check: &mut StopCheck) -> Option<Box<dyn Loss + 'a>> {
        stop_check.worked(lobe.target.points.len() * SAMPLE_WORK)?;
        Some(Box::new(L3Loss::new(*lobe, &self.cosines)))
    }
}

/// A direction in the lobe's frame for the comparison of densities.
#[derive(Debug, Clone, Copy)]
struct DensitySample {
    direction: DVec3,
    /// The lobe's density `g`.
    lobe: f64,
    /// The density of the drawn direction times the number of samples, for the lobe's sampler alone or for both
    /// samplers.
    drawn: f64,
}

/// The density of the LTC of a matrix, in the lobe's frame.
struct Density {
    inverse: DMat3,
    /// `|det M^-1| / pi`.
    factor: f64,
}

impl Density {
    fn new(m: &DMat3) -> Self {
        Self { inverse: m.inverse(), factor: 1.0 / (m.determinant().abs() * PI) }
    }

    /// `c = M^-1 w` and `D = c_z det M^-1 / (pi |c|^4)` for a unit vector `w`.
    fn at(&self, direction: DVec3) -> (DVec3, f64) {
        let c = self.inverse * direction;
        let length2 = c.length_squared();
        (c, c.z.max(0.0) * self.factor / (length2 * length2))
    }
}

/// The integral of the cubes and its gradient, accumulated sample by sample.
///
/// With `N = M^-1`, `c = N w` and `D = c_z |det N| / (pi |c|^4)`:
///
/// ```text
/// dD/dN = D ((z / c_z - 4 c / |c|^2) w^T + M^T),    dL/dM = -N^T (dL/dN) N^T
/// ```
struct Slopes {
    density: Density,
    sum: f64,
    by_inverse: DMat3,
    by_determinant: f64,
}

impl Slopes {
    fn new(density: Density) -> Self {
        Self { density, sum: 0.0, by_inverse: DMat3::ZERO, by_determinant: 0.0 }
    }

    /// Adds a direction drawn with a density of `1 / weight`. `lobe` is the lobe's density in this direction.
    fn add(&mut self, direction: DVec3, lobe: f64, weight: f64) {
        let (c, ltc) = self.density.at(direction);
        let off = ltc - lobe;
        self.sum += cube(off.abs()) * weight;
        if ltc > 0.0 {
            let slope = 3.0 * off * off.abs() * weight * ltc;
            let by_c = (DVec3::Z * (1.0 / c.z) - c * (4.0 / c.length_squared())) * slope;
            let w = direction;
            self.by_inverse += DMat3::from_cols(by_c * w.x, by_c * w.y, by_c * w.z);
            self.by_determinant += slope;
        }
    }

    /// The gradient of the sum with respect to the matrix.
    fn by_matrix(&self, m: &DMat3) -> DMat3 {
        let by_inverse = self.by_inverse + m.transpose() * self.by_determinant;
        let transposed = self.density.inverse.transpose();
        -(transposed * by_inverse * transposed)
    }
}

/// The distance to one lobe.
struct L3Loss<'a> {
    lobe: Lobe<'a>,
    cosines: &'a [Vec<DVec3>; 2],
    /// The lobe's samples.
    samples: Vec<DensitySample>,
    /// `albedo`.
    albedo: f64,
    /// `1 / integral g^3`.
    inv_whole: f64,
    spread: f64,
    /// The fixed samples of lobe and LTC for gradients. They are computed for the first matrix that is evaluated.
    fixed: [Option<Vec<DensitySample>>; 2],
}

impl<'a> L3Loss<'a> {
    fn new(lobe: Lobe<'a>, cosines: &'a [Vec<DVec3>; 2]) -> Self {
        let Lobe { brdf, wo, target } = lobe;
        let count = target.drawn as f64;
        let (mut albedo, mut cubes) = (0.0, 0.0);
        let mut samples = Vec::with_capacity(target.points.len());
        for point in &target.points {
            let direction = *point + DVec3::Z;
            let [value, pdf] = value_and_pdf(brdf, wo, target.frame * direction);
            // Due to rounding, a sampler can draw a direction whose density is zero.
            if pdf > 0.0 {
                albedo += value / pdf;
                cubes += value * value * value / pdf;
                samples.push(DensitySample { direction, lobe: value, drawn: count * pdf });
            }
        }
        albedo /= count;
        let inv_albedo = 1.0 / albedo;
        for sample in &mut samples {
            sample.lobe *= inv_albedo;
        }
        let whole = cubes / count * inv_albedo * inv_albedo * inv_albedo;
        let half_trace = 0.5 * (target.core.scatter.x_axis.x + target.core.scatter.y_axis.y);
        Self { lobe, cosines, samples, albedo, inv_whole: 1.0 / whole, spread: half_trace.sqrt(), fixed: [None, None] }
    }

    /// Maps a sample of the clamped cosine to a sample of the LTC of `m`.
    fn moved(&self, m: &DMat3, factor: f64, cosine: DVec3, count: f64) -> (DensitySample, f64) {
        let image = *m * cosine;
        let length = image.length();
        let direction = image * (1.0 / length);
        let density = cosine.z * factor * (length * length * length);
        let [value, pdf] = value_and_pdf(self.lobe.brdf, self.lobe.wo, self.lobe.target.frame * direction);
        (DensitySample { direction, lobe: value / self.albedo, drawn: count * pdf }, density)
    }

    /// `spread (sum / integral g^3)^(1/3)` for an estimate of the integral of the cube.
    fn loss(&self, sum: f64) -> f64 {
        self.spread * pow(sum * self.inv_whole, 1.0 / 3.0)
    }

    /// The loss and its gradient with respect to the matrix, from the sum and its gradient.
    fn of(&self, slopes: &Slopes, m: &DMat3) -> (f64, DMat3) {
        let loss = self.loss(slopes.sum);
        // The slope of the cube root. It is set to zero if lobe and LTC are equal.
        let scale = if slopes.sum > 0.0 { loss / (3.0 * slopes.sum) } else { 0.0 };
        (loss, slopes.by_matrix(m) * scale)
    }

    fn fix_samples(&self, m: &DMat3, grain: Grain) -> Vec<DensitySample> {
        let cosines = &self.cosines[grain as usize];
        let (count, density) = (cosines.len() as f64, Density::new(m));
        let stride = self.stride(grain);
        let share = 1.0 / stride as f64;
        let of_lobe = self.samples.iter().step_by(stride);
        let own = of_lobe.map(|sample| DensitySample {
            drawn: sample.drawn * share + count * density.at(sample.direction).1,
            ..*sample
        });
        let of_ltc = cosines.iter().map(|cosine| {
            let (sample, density) = self.moved(m, density.factor, *cosine, self.lobe.target.drawn as f64 * share);
            DensitySample { drawn: sample.drawn + count * density, ..sample }
        });
        own.chain(of_ltc).collect()
    }

    /// The step through the lobe's samples: a coarse evaluation takes every n-th sample.
    fn stride(&self, grain: Grain) -> usize {
        match grain {
            Grain::Coarse => (self.cosines[1].len() / self.cosines[0].len()).max(1),
            Grain::Full => 1,
        }
    }
}

/// `f cos`, and the density with which the lobe's sampler draws a direction above the horizon; zeros below.
fn value_and_pdf(brdf: &dyn Brdf, wo: DVec3, wi: DVec3) -> [f64; 2] {
    if wi.z > 0.0 { [brdf.eval_cos(wo, wi), brdf.pdf(wo, wi)] } else { [0.0; 2] }
}

fn cube(x: f64) -> f64 {
    x * x * x
}

impl Loss for L3Loss<'_> {
    fn spread(&self) -> f64 {
        self.spread
    }

    fn value(&mut self, m: &DMat3, stop_check: &mut StopCheck) -> Option<f64> {
        let cosines = &self.cosines[Grain::Full as usize];
        stop_check.worked(self.samples.len() + SAMPLE_WORK * cosines.len())?;
        let (count, density) = (cosines.len() as f64, Density::new(m));
        let mut sum = 0.0;
        for sample in &self.samples {
            let (_, ltc) = density.at(sample.direction);
            sum += cube((sample.lobe - ltc).abs()) / (sample.drawn + count * ltc);
        }
        for cosine in cosines {
            let (sample, ltc) = self.moved(m, density.factor, *cosine, self.lobe.target.drawn as f64);
            sum += cube((sample.lobe - ltc).abs()) / (sample.drawn + count * ltc);
        }
        Some(self.loss(sum))
    }

    fn value_and_gradient(&mut self, m: &DMat3, grain: Grain, stop_check: &mut StopCheck) -> Option<(f64, DMat3)> {
        let fixed = if let Some(fixed) = self.fixed[grain as usize].take() {
            fixed
        } else {
            stop_check.worked(SAMPLE_WORK * self.cosines[grain as usize].len())?;
            self.fix_samples(m, grain)
        };
        stop_check.worked(2 * fixed.len())?;
        let mut slopes = Slopes::new(Density::new(m));
        for sample in &fixed {
            slopes.add(sample.direction, sample.lobe, 1.0 / sample.drawn);
        }
        self.fixed[grain as usize] = Some(fixed);
        Some(self.of(&slopes, m))
    }

    fn step(&self, m: &DMat3, rate: f64, draws: &Draws, stop_check: &mut StopCheck) -> Option<DMat3> {
        stop_check.worked(2 * SAMPLE_WORK * draws.lobe.len())?;
        let Lobe { brdf, wo, .. } = self.lobe;
        let images = draws.cosines.iter().map(|c| (*m * *c).normalize());
        let mut slopes = Slopes::new(Density::new(m));
        let count = draws.lobe.len() as f64;
        for direction in draws.lobe.iter().copied().chain(images) {
            let [value, _] = value_and_pdf(brdf, wo, direction);
            let lobe = value / self.albedo;
            let (_, ltc) = slopes.density.at(direction);
            slopes.add(direction, lobe, 1.0 / (count * (lobe + ltc)));
        }
        let (_, by_m) = self.of(&slopes, m);
        // A singular matrix has no density, so the step is zero.
        Some(if by_m.is_finite() { by_m * rate } else { DMat3::ZERO })
    }
}

#[cfg(test)]
mod tests;
