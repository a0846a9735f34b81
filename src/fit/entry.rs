//! One configuration from lobe to matrix.

use glam::{DMat3, DVec3};

use super::{
    bfgs::Limits,
    guess,
    loss::{CosineSamples, Loss, Workspace},
    recipe::{FitSettings, Solver},
    sgd::{self, Schedule},
    solve::refine,
    target::{Mirrors, Target},
};
use crate::{
    brdf::{Brdf, Ggx},
    math::{fibonacci_hemisphere, lattice2, row_major, sin_cos},
};

/// Samples of the lobe for each sample of the LTC: they are projected once, the LTC's in every evaluation.
const TARGET_SAMPLES_PER_SAMPLE: usize = 4;
/// BFGS stops when two steps in a row lower the loss by less than this part: about 20 evaluations. With a tenth of
/// it there are 40, and the tables are not better on samples that the fit did not see.
const RELATIVE_DECREASE: f64 = 1e-4;
/// The held-out sequences are those of the fit shifted by these parts of a turn, far from any small fraction.
const HELD_OUT_SHIFT: [f64; 2] = [0.414_213_562_373_095, 0.732_050_807_568_877];

/// One fitted configuration, before alignment and storage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FittedEntry {
    /// `M` in the tangent frame, row-major.
    pub matrix: [f64; 9],
    /// Directional albedo for a Fresnel factor of one.
    pub amplitude: f64,
    /// Its part weighted by Schlick's fifth power.
    pub fresnel: f64,
    /// Sliced Wasserstein error on samples and directions that the fit did not see.
    pub error: f64,
}

/// The view direction of a node: unit length, exactly in a coordinate plane at `phi` of zero or pi/2.
pub(super) fn view_direction(theta: f64, phi: f64) -> DVec3 {
    let (sin_theta, cos_theta) = sin_cos(theta);
    let (sin_phi, cos_phi) = sin_cos(phi);
    DVec3::new(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta)
}

/// Symmetries of the lobe of an anisotropic, axis-aligned surface seen from `wo`.
pub(super) fn mirrors(wo: DVec3) -> Mirrors {
    Mirrors { x: wo.x == 0.0, y: wo.y == 0.0 }
}

/// Fixed samples and directions, shared by all entries.
#[derive(Debug, Clone)]
struct Sampling {
    samples: CosineSamples,
    directions: Vec<DVec3>,
    shift: [f64; 2],
}

impl Sampling {
    fn new(settings: &FitSettings, shift: [f64; 2]) -> Self {
        let (samples, directions) = (settings.samples as usize, settings.directions as usize);
        Self {
            samples: CosineSamples::new(samples, |i| lattice2(i, samples, shift)),
            directions: (0..directions).map(|i| fibonacci_hemisphere(i, directions, shift[1])).collect(),
            shift,
        }
    }

    fn target(&self, brdf: &impl Brdf, wo: DVec3) -> Target {
        Target::sample(brdf, wo, mirrors(wo), self.samples.len() * TARGET_SAMPLES_PER_SAMPLE, self.shift)
    }
}

/// Fits configurations one after the other; what they share is prepared once.
#[derive(Debug)]
pub struct Fitter {
    settings: FitSettings,
    seen: Sampling,
    held_out: Sampling,
    work: Workspace,
}

impl Fitter {
    /// A fitter for these settings.
    #[must_use]
    pub fn new(settings: &FitSettings) -> Self {
        // The seed turns both sequences. Multiples of an irrational number never meet.
        let turn = |base: f64, step: f64| {
            let turned = base + settings.seed as f64 * step;
            turned - turned.floor()
        };
        let seen = [turn(0.0, 0.236_067_977_499_790), turn(0.0, 0.645_751_311_064_591)];
        let held_out = [turn(seen[0], HELD_OUT_SHIFT[0]), turn(seen[1], HELD_OUT_SHIFT[1])];
        Self {
            settings: *settings,
            seen: Sampling::new(settings, seen),
            held_out: Sampling::new(settings, held_out),
            work: Workspace::default(),
        }
    }

    /// Fits the lobe of `ggx` for `wo`. `stream` picks the random numbers of solver `sgd`.
    ///
    /// Domain: roughness at least 1e-8, `wo` of unit length above the horizon.
    pub fn fit(&mut self, ggx: &Ggx, wo: DVec3, stream: u64) -> FittedEntry {
        let target = self.seen.target(ggx, wo);
        let matrix = match self.settings.solver {
            Solver::Bfgs => {
                let loss = Loss::new(&target, &self.seen.samples, &self.seen.directions);
                let limits = Limits { steps: self.settings.steps, relative_decrease: RELATIVE_DECREASE };
                let guess = guess::from_core(&target.core);
                target.frame * refine(&loss, &guess, target.mirrors, limits, &mut self.work)
            }
            Solver::Sgd => sgd::descend(ggx, wo, &Schedule::of(&self.settings), stream),
        };
        FittedEntry {
            matrix: row_major(&matrix),
            amplitude: target.terms.amplitude,
            fresnel: target.terms.fresnel,
            error: self.error(ggx, wo, &matrix),
        }
    }

    /// Sliced Wasserstein distance between the lobe and the LTC of `matrix` on the held-out samples.
    pub fn error(&mut self, ggx: &Ggx, wo: DVec3, matrix: &DMat3) -> f64 {
        let target = self.held_out.target(ggx, wo);
        let loss = Loss::new(&target, &self.held_out.samples, &self.held_out.directions);
        loss.value(&(target.frame.transpose() * *matrix), &mut self.work)
    }
}
