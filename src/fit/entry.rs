//! Fits the lobe of one configuration.

use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::{
    brdf::{Brdf, LobeTerms, Mirrors},
    lobe::{
        LobeModel,
        gaussian::{Images, SphericalGaussian, above_horizon},
    },
    math::{Lattice, SquarePoint, row_major},
    metric::{Distance, Grain, Lobe, Metric, Samples, Target},
    recipe::FitSettings,
    solver::{Effort, Guess, Objective, Solver, in_arrays},
    stop_check::{StopCheck, unstopped},
};

/// Samples of the lobe for each sample of the LTC. The lobe can have more samples, because they are projected only
/// once. The samples of the LTC are projected in every evaluation.
const TARGET_SAMPLES_PER_SAMPLE: usize = 2;
/// Samples of the lobe from which its terms are computed, for each sample of the LTC. These samples are cheap, because
/// they are drawn but not projected.
const TERM_SAMPLES_PER_SAMPLE: usize = 4;
/// The held-out sequences are the sequences of the fit, shifted cyclically by these distances. Both are far from all
/// fractions with a small denominator.
const HELD_OUT_SHIFT: [f64; 2] = [0.414_213_562_373_095, 0.732_050_807_568_877];

/// The metric of measured errors. It does not depend on the metric of the fit, so the errors of all tables are
/// comparable.
const ERROR_METRIC: Metric = Metric::Sw1;

/// A fitted configuration, before alignment and storage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FittedEntry {
    /// `M` in the tangent frame, row-major.
    pub matrix: [f64; 9],
    /// The matrix of the second lobe, if entries have two lobes.
    pub second: Option<[f64; 9]>,
    /// Directional albedo for a Fresnel factor of one. For a Gaussian, the albedo is divided by the part of the
    /// Gaussian above the horizon, because a renderer multiplies the amplitude by the Gaussian's integral over a light.
    pub amplitude: f64,
    /// The amplitude, weighted by Schlick's fifth power.
    pub fresnel: f64,
    /// Sliced Wasserstein error on held-out samples and directions.
    pub error: f64,
}

/// Fixed samples and directions, shared by all entries.
#[derive(Debug)]
struct Sampling {
    distance: Box<dyn Distance>,
    target: Arc<[SquarePoint]>,
}

impl Sampling {
    fn new(metric: Metric, settings: &FitSettings, shift: [f64; 2]) -> Self {
        let (count, directions) = (settings.samples as usize, settings.directions as usize);
        Self {
            distance: metric.rules().distance(&Samples { count, directions, shift }),
            target: Lattice::new(count * TARGET_SAMPLES_PER_SAMPLE, shift).points().map(SquarePoint::new).collect(),
        }
    }

    fn another(&self) -> Self {
        Self { distance: self.distance.another(), target: Arc::clone(&self.target) }
    }

    fn target(&self, brdf: &dyn Brdf, wo: DVec3) -> Target {
        Target::sample(brdf, wo, Mirrors::of(wo), &self.target)
    }
}

/// Fits configurations one after the other. All fits share the same prepared samples and directions.
#[derive(Debug)]
pub struct Fitter {
    lobe: LobeModel,
    settings: FitSettings,
    training: Sampling,
    held_out: Sampling,
    /// The points of the samples from which the lobe's terms are computed.
    terms: Arc<[SquarePoint]>,
}

impl Fitter {
    /// A fitter of the default lobe model with these settings.
    #[must_use]
    pub fn new(settings: &FitSettings) -> Self {
        // The seed shifts both sequences by multiples of irrational numbers, so no two seeds have the same shift.
        let turn = |base: f64, step: f64| {
            let turned = base + settings.seed as f64 * step;
            turned - turned.floor()
        };
        let training = [turn(0.0, 0.236_067_977_499_790), turn(0.0, 0.645_751_311_064_591)];
        let held_out = [turn(training[0], HELD_OUT_SHIFT[0]), turn(training[1], HELD_OUT_SHIFT[1])];
        let terms = Lattice::new(settings.samples as usize * TERM_SAMPLES_PER_SAMPLE, training);
        Self {
            lobe: LobeModel::ALL[0],
            settings: *settings,
            training: Sampling::new(settings.metric, settings, training),
            held_out: Sampling::new(ERROR_METRIC, settings, held_out),
            terms: terms.points().map(SquarePoint::new).collect(),
        }
    }

    /// This fitter with another lobe model.
    #[must_use]
    pub fn of(self, lobe: LobeModel) -> Self {
        Self { lobe, ..self }
    }

    /// A fitter for another thread, which shares samples and directions with this fitter.
    #[must_use]
    pub fn another(&self) -> Self {
        Self {
            lobe: self.lobe,
            settings: self.settings,
            training: self.training.another(),
            held_out: self.held_out.another(),
            terms: Arc::clone(&self.terms),
        }
    }

    /// Fits the lobe of `brdf` for `wo` and measures the error of the fit. `stream` selects the random numbers of
    /// solver `sgd`. Returns `None` if `stop_check` stops the fit.
    ///
    /// Domain: roughness at least 1e-8, `wo` of unit length above the horizon.
    pub fn fit(&mut self, brdf: &dyn Brdf, wo: DVec3, stream: u64, stop_check: &mut StopCheck) -> Option<FittedEntry> {
        self.fit_near(brdf, wo, stream, None, stop_check).map(|(entry, _)| entry)
    }

    /// Like [`Fitter::fit`], but solvers that start from a matrix start from `start`, given in [`Fitter::frame`] of the
    /// lobe.
    pub fn fit_from(
        &mut self,
        brdf: &dyn Brdf,
        wo: DVec3,
        start: DMat3,
        stop_check: &mut StopCheck,
    ) -> Option<FittedEntry> {
        self.fit_near(brdf, wo, 0, Some(start), stop_check).map(|(entry, _)| entry)
    }

    /// The frame of a lobe: the rotation from +z to its mean direction.
    #[must_use]
    pub fn frame(&self, brdf: &dyn Brdf, wo: DVec3) -> DMat3 {
        self.training.target(brdf, wo).frame
    }

    /// Like [`Fitter::fit`], but solvers that start from a matrix start from `near`, the matrix of a neighbouring lobe.
    /// Also returns the matrix from which to start the next lobe. Both matrices are in the frame of their own lobe.
    pub(super) fn fit_near(
        &mut self,
        brdf: &dyn Brdf,
        wo: DVec3,
        stream: u64,
        near: Option<DMat3>,
        stop_check: &mut StopCheck,
    ) -> Option<(FittedEntry, DMat3)> {
        let target = self.training.target(brdf, wo);
        let matrix = self.solve(self.settings.solver, Lobe { brdf, wo, target: &target }, stream, near, stop_check)?;
        let held_out = target.again(brdf, wo, &self.held_out.target);
        let LobeTerms { amplitude, fresnel } = brdf.terms(wo, &self.terms);
        let error = self.distance(&Lobe { brdf, wo, target: &held_out }, &matrix, stop_check)?;
        let above = self.gaussian(&matrix).map_or(1.0, |gaussian| above_horizon(&gaussian));
        let [amplitude, fresnel] = [amplitude, fresnel].map(|term| term / above);
        let entry = FittedEntry { matrix: row_major(&matrix), second: None, amplitude, fresnel, error };
        Some((entry, target.frame.transpose() * matrix))
    }

    fn solve(
        &mut self,
        solver: Solver,
        lobe: Lobe,
        stream: u64,
        near: Option<DMat3>,
        stop_check: &mut StopCheck,
    ) -> Option<DMat3> {
        let FitSettings { metric, samples, directions, steps, seed, simplex, .. } = self.settings;
        let effort = Effort { metric, samples: samples as usize, directions: directions as usize, steps, seed };
        let simplex = simplex.unwrap_or_default();
        let Lobe { brdf, wo, target } = lobe;
        if self.lobe == LobeModel::Ltc
            && let Some(own) = brdf.ltc(wo)
        {
            return Some(own);
        }
        let mut loss = self.training.distance.to(&lobe, stop_check)?;
        let model = self.lobe;
        solver
            .rules()
            .solve(Objective { model, brdf, wo, target, loss: &mut *loss, effort, stream, simplex, near }, stop_check)
    }

    /// The matrix that solver `sgd` finds, whichever solver the settings name. Returns `None` if `stop_check` stops the
    /// fit.
    #[must_use]
    pub fn descended(&mut self, brdf: &dyn Brdf, wo: DVec3, stream: u64, stop_check: &mut StopCheck) -> Option<DMat3> {
        let target = self.training.target(brdf, wo);
        self.solve(Solver::Sgd, Lobe { brdf, wo, target: &target }, stream, None, stop_check)
    }

    /// Like [`Fitter::fit_near`], but returns only the matrix from which to start the next lobe.
    pub(super) fn next_to(
        &mut self,
        brdf: &dyn Brdf,
        wo: DVec3,
        near: Option<DMat3>,
        stop_check: &mut StopCheck,
    ) -> Option<DMat3> {
        let [_, next] = self.matrices(brdf, wo, 0, near, stop_check)?;
        Some(next)
    }

    /// Like [`Fitter::fit_near`], but returns only the matrix, row-major.
    pub(super) fn matrix_near(
        &mut self,
        brdf: &dyn Brdf,
        wo: DVec3,
        stream: u64,
        near: Option<DMat3>,
        stop_check: &mut StopCheck,
    ) -> Option<[f64; 9]> {
        let [matrix, _] = self.matrices(brdf, wo, stream, near, stop_check)?;
        Some(row_major(&matrix))
    }

    /// The matrix of a lobe in the tangent frame and in the frame of the lobe.
    fn matrices(
        &mut self,
        brdf: &dyn Brdf,
        wo: DVec3,
        stream: u64,
        near: Option<DMat3>,
        stop_check: &mut StopCheck,
    ) -> Option<[DMat3; 2]> {
        let target = self.training.target(brdf, wo);
        let matrix = self.solve(self.settings.solver, Lobe { brdf, wo, target: &target }, stream, near, stop_check)?;
        Some([matrix, target.frame.transpose() * matrix])
    }

    /// Calls `measure` with a function that evaluates loss and gradient once, at the initial guess for the lobe.
    pub fn with_evaluation(&mut self, brdf: &dyn Brdf, wo: DVec3, measure: impl FnOnce(&mut dyn FnMut() -> f64)) {
        let target = self.training.target(brdf, wo);
        let mut go_on = unstopped;
        let mut stop_check = StopCheck::new(&mut go_on);
        let Some(mut loss) = self.training.distance.to(&Lobe { brdf, wo, target: &target }, &mut stop_check) else {
            return;
        };
        let matrix = Guess::of(&target.core).matrix();
        measure(&mut || {
            loss.value_and_gradient(&matrix, Grain::Full, &mut stop_check).map_or(f64::NAN, |(value, _)| value)
        });
    }

    /// Sliced Wasserstein distance between the lobe and the fitted `matrix`, on the held-out samples.
    pub fn error(&mut self, brdf: &dyn Brdf, wo: DVec3, matrix: &DMat3) -> f64 {
        let held_out = self.held_out.target(brdf, wo);
        self.distance(&Lobe { brdf, wo, target: &held_out }, matrix, &mut StopCheck::new(&mut unstopped))
            .unwrap_or(f64::NAN)
    }

    /// The Gaussian with a given matrix, if the lobe model is a Gaussian.
    fn gaussian(&self, matrix: &DMat3) -> Option<SphericalGaussian<f64>> {
        let columns = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|column| column.to_array());
        self.lobe.gaussian().map(|gaussian| SphericalGaussian::along_first(gaussian, columns))
    }

    /// Distance between a lobe of held-out samples and the fitted `matrix`.
    fn distance(&mut self, held_out: &Lobe, matrix: &DMat3, stop_check: &mut StopCheck) -> Option<f64> {
        let to_lobe = held_out.target.frame.transpose();
        let gaussian = self.gaussian(matrix);
        let mut loss = self.held_out.distance.to(held_out, stop_check)?;
        let Some((gaussian, images)) = gaussian.zip(loss.images()) else {
            return loss.value(&(to_lobe * *matrix), stop_check);
        };
        let mut offsets = Vec::new();
        Images::new(images.lattice(Grain::Full)).offsets(&gaussian, &to_lobe, &mut offsets);
        images.value_of(&in_arrays(&offsets), stop_check)
    }
}

#[cfg(test)]
mod tests;
