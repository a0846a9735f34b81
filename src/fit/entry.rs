//! One configuration from lobe to matrix.

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
    pulse::{Pulse, unstopped},
    recipe::FitSettings,
    solver::{Effort, Guess, Objective, Solver, in_arrays},
};

/// Samples of the lobe for each sample of the LTC. The lobe can have more, because its samples are projected once and
/// those of the LTC in every evaluation.
const TARGET_SAMPLES_PER_SAMPLE: usize = 2;
/// Samples of the lobe that tell its terms, for each sample of the LTC. They are drawn and no more, so they cost little.
const TERM_SAMPLES_PER_SAMPLE: usize = 4;
/// The held-out sequences are those of the fit, shifted by these parts of a turn. Both parts are far from any fraction
/// with a small denominator.
const HELD_OUT_SHIFT: [f64; 2] = [0.414_213_562_373_095, 0.732_050_807_568_877];

/// The metric of measured errors, whatever the fit minimises: the errors of all tables compare.
const ERROR_METRIC: Metric = Metric::Sw1;

/// One fitted configuration, before alignment and storage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FittedEntry {
    /// `M` in the tangent frame, row-major.
    pub matrix: [f64; 9],
    /// Directional albedo for a Fresnel factor of one; of a Gaussian over its part above the horizon, so that what it has
    /// over a light is multiplied by this.
    pub amplitude: f64,
    /// The same, weighted by Schlick's fifth power.
    pub fresnel: f64,
    /// Sliced Wasserstein error on samples and directions that the fit did not see.
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

/// Fits configurations one after the other. The samples and directions that they share are prepared once.
#[derive(Debug)]
pub struct Fitter {
    lobe: LobeModel,
    settings: FitSettings,
    seen: Sampling,
    held_out: Sampling,
    /// Where the lobe is sampled for its terms.
    terms: Arc<[SquarePoint]>,
}

impl Fitter {
    /// A fitter of the default lobe model for these settings.
    #[must_use]
    pub fn new(settings: &FitSettings) -> Self {
        // The seed shifts both sequences by multiples of irrational numbers, which never coincide.
        let turn = |base: f64, step: f64| {
            let turned = base + settings.seed as f64 * step;
            turned - turned.floor()
        };
        let seen = [turn(0.0, 0.236_067_977_499_790), turn(0.0, 0.645_751_311_064_591)];
        let held_out = [turn(seen[0], HELD_OUT_SHIFT[0]), turn(seen[1], HELD_OUT_SHIFT[1])];
        let terms = Lattice::new(settings.samples as usize * TERM_SAMPLES_PER_SAMPLE, seen);
        Self {
            lobe: LobeModel::ALL[0],
            settings: *settings,
            seen: Sampling::new(settings.metric, settings, seen),
            held_out: Sampling::new(ERROR_METRIC, settings, held_out),
            terms: terms.points().map(SquarePoint::new).collect(),
        }
    }

    /// This fitter, for a lobe model that the settings' solver finds.
    #[must_use]
    pub fn of(self, lobe: LobeModel) -> Self {
        Self { lobe, ..self }
    }

    /// A fitter that shares samples and directions with this one, for another thread.
    #[must_use]
    pub fn another(&self) -> Self {
        Self {
            lobe: self.lobe,
            settings: self.settings,
            seen: self.seen.another(),
            held_out: self.held_out.another(),
            terms: Arc::clone(&self.terms),
        }
    }

    /// Fits the lobe of `brdf` for `wo` and measures the fit. `stream` chooses the random numbers of solver `sgd`.
    /// `None` when `pulse` stops it.
    ///
    /// Domain: roughness at least 1e-8, `wo` of unit length above the horizon.
    pub fn fit(&mut self, brdf: &dyn Brdf, wo: DVec3, stream: u64, pulse: &mut Pulse) -> Option<FittedEntry> {
        self.fit_near(brdf, wo, stream, None, pulse).map(|(entry, _)| entry)
    }

    /// [`Fitter::fit`] by a solver that starts from a matrix, from `start`: in [`Fitter::frame`] of the lobe.
    pub fn fit_from(&mut self, brdf: &dyn Brdf, wo: DVec3, start: DMat3, pulse: &mut Pulse) -> Option<FittedEntry> {
        self.fit_near(brdf, wo, 0, Some(start), pulse).map(|(entry, _)| entry)
    }

    /// The frame of a lobe: the rotation that takes +z to its mean direction.
    #[must_use]
    pub fn frame(&self, brdf: &dyn Brdf, wo: DVec3) -> DMat3 {
        self.seen.target(brdf, wo).frame
    }

    /// [`Fitter::fit`], for solvers that start from the matrix of a lobe next to this one, and the matrix with which to start
    /// the next one: each in the frame of its own lobe.
    pub(super) fn fit_near(
        &mut self,
        brdf: &dyn Brdf,
        wo: DVec3,
        stream: u64,
        near: Option<DMat3>,
        pulse: &mut Pulse,
    ) -> Option<(FittedEntry, DMat3)> {
        let target = self.seen.target(brdf, wo);
        let matrix = self.solve(self.settings.solver, Lobe { brdf, wo, target: &target }, stream, near, pulse)?;
        let unseen = target.again(brdf, wo, &self.held_out.target);
        let LobeTerms { amplitude, fresnel } = brdf.terms(wo, &self.terms);
        let error = self.distance(&Lobe { brdf, wo, target: &unseen }, &matrix, pulse)?;
        let above = self.gaussian(&matrix).map_or(1.0, |gaussian| above_horizon(&gaussian));
        let [amplitude, fresnel] = [amplitude, fresnel].map(|term| term / above);
        let entry = FittedEntry { matrix: row_major(&matrix), amplitude, fresnel, error };
        Some((entry, target.frame.transpose() * matrix))
    }

    fn solve(
        &mut self,
        solver: Solver,
        lobe: Lobe,
        stream: u64,
        near: Option<DMat3>,
        pulse: &mut Pulse,
    ) -> Option<DMat3> {
        let FitSettings { metric, samples, directions, steps, seed, simplex, .. } = self.settings;
        let effort = Effort { metric, samples: samples as usize, directions: directions as usize, steps, seed };
        let simplex = simplex.unwrap_or_default();
        let Lobe { brdf, wo, target } = lobe;
        let mut loss = self.seen.distance.to(&lobe, pulse)?;
        let model = self.lobe;
        solver
            .rules()
            .solve(Objective { model, brdf, wo, target, loss: &mut *loss, effort, stream, simplex, near }, pulse)
    }

    /// The matrix of solver `sgd`, whatever the settings' solver; `None` when `pulse` stops it.
    #[must_use]
    pub fn descended(&mut self, brdf: &dyn Brdf, wo: DVec3, stream: u64, pulse: &mut Pulse) -> Option<DMat3> {
        let target = self.seen.target(brdf, wo);
        self.solve(Solver::Sgd, Lobe { brdf, wo, target: &target }, stream, None, pulse)
    }

    /// The matrix alone that [`Fitter::fit_near`] gives for the next lobe.
    pub(super) fn next_to(
        &mut self,
        brdf: &dyn Brdf,
        wo: DVec3,
        near: Option<DMat3>,
        pulse: &mut Pulse,
    ) -> Option<DMat3> {
        let target = self.seen.target(brdf, wo);
        let matrix = self.solve(self.settings.solver, Lobe { brdf, wo, target: &target }, 0, near, pulse)?;
        Some(target.frame.transpose() * matrix)
    }

    /// Calls `measure` with a function that evaluates loss and gradient once, at the lobe's first guess.
    pub fn with_evaluation(&mut self, brdf: &dyn Brdf, wo: DVec3, measure: impl FnOnce(&mut dyn FnMut() -> f64)) {
        let target = self.seen.target(brdf, wo);
        let mut beat = unstopped;
        let mut pulse = Pulse::new(&mut beat);
        let Some(mut loss) = self.seen.distance.to(&Lobe { brdf, wo, target: &target }, &mut pulse) else { return };
        let matrix = Guess::of(&target.core).matrix();
        measure(&mut || loss.value_and_gradient(&matrix, Grain::Full, &mut pulse).map_or(f64::NAN, |(value, _)| value));
    }

    /// Sliced Wasserstein distance between the lobe and the lobe model of `matrix` on the held-out samples.
    pub fn error(&mut self, brdf: &dyn Brdf, wo: DVec3, matrix: &DMat3) -> f64 {
        let unseen = self.held_out.target(brdf, wo);
        self.distance(&Lobe { brdf, wo, target: &unseen }, matrix, &mut Pulse::new(&mut unstopped)).unwrap_or(f64::NAN)
    }

    /// The Gaussian of a matrix, if the lobe model is one.
    fn gaussian(&self, matrix: &DMat3) -> Option<SphericalGaussian<f64>> {
        let columns = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|column| column.to_array());
        self.lobe.gaussian().map(|gaussian| SphericalGaussian::of_columns(gaussian, columns))
    }

    /// Distance between a lobe of held-out samples and the lobe model of `matrix`.
    fn distance(&mut self, unseen: &Lobe, matrix: &DMat3, pulse: &mut Pulse) -> Option<f64> {
        let to_lobe = unseen.target.frame.transpose();
        let gaussian = self.gaussian(matrix);
        let mut loss = self.held_out.distance.to(unseen, pulse)?;
        let Some((gaussian, images)) = gaussian.zip(loss.images()) else {
            return loss.value(&(to_lobe * *matrix), pulse);
        };
        let mut offsets = Vec::new();
        Images::new(images.lattice(Grain::Full)).offsets(&gaussian, &to_lobe, &mut offsets);
        images.value_of(&in_arrays(&offsets), pulse)
    }
}

#[cfg(test)]
mod tests {
    use std::{f64::consts::FRAC_PI_2, ops::ControlFlow};

    use proptest::prelude::*;

    use super::*;
    use crate::fit::brdf::Ggx;
    use crate::fit::{
        ALPHA_FLOOR, Metric, RATIO_FLOOR, THETA_CEILING,
        math::{direction, from_row_major},
    };

    fn fit(settings: FitSettings, ggx: &Ggx, wo: DVec3, stream: u64) -> FittedEntry {
        let fitted = Fitter::new(&settings).fit(ggx, wo, stream, &mut Pulse::new(&mut unstopped));
        fitted.expect("nothing stops it")
    }

    fn settings(solver: Solver, samples: u32, directions: u32, steps: u32) -> FitSettings {
        FitSettings { metric: Metric::Sw1, solver, samples, directions, steps, seed: 0, simplex: None }
    }

    /// One of the values where fits are hardest, moved by a few ulps, or any value from `low` to `high`.
    fn hard(values: &'static [f64], low: f64, high: f64) -> impl Strategy<Value = f64> {
        let near = (prop::sample::select(values), -3_i64..=3)
            .prop_map(move |(x, ulps)| f64::from_bits(x.to_bits().saturating_add_signed(ulps)).clamp(low, high));
        prop_oneof![near, low..high]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        #[test]
        fn every_lobe_gets_a_finite_upright_matrix(
            alpha in hard(&[ALPHA_FLOOR, 1e-3, 1.0], ALPHA_FLOOR, 1.0),
            ratio in hard(&[RATIO_FLOOR, 1e-3, 1.0], RATIO_FLOOR, 1.0),
            theta in hard(&[0.0, 1e-9, 1.57, THETA_CEILING], 0.0, THETA_CEILING),
            phi in hard(&[0.0, 1e-12, FRAC_PI_2], 0.0, FRAC_PI_2),
        ) {
            let ggx = Ggx { alpha_x: alpha, alpha_y: alpha * ratio };
            let wo = direction(theta, phi);
            let entry = fit(settings(Solver::Bfgs, 64, 6, 20), &ggx, wo, 0);
            prop_assert!(entry.matrix.iter().all(|x| x.is_finite()), "{entry:?}");
            prop_assert!(from_row_major(&entry.matrix).determinant() > 0.0, "{entry:?}");
            prop_assert!(entry.error.is_finite() && entry.error < 0.2, "{entry:?}");
            prop_assert!((0.0..=1.0).contains(&entry.fresnel) && (0.0..=1.0 + 1e-9).contains(&entry.amplitude), "{entry:?}");
        }
    }

    /// The sharpest and the broadest isotropic lobes, from above and at the horizon.
    #[test]
    fn every_metric_and_solver_fits_the_hardest_isotropic_lobes() {
        let pairs = Solver::ALL.iter().flat_map(|solver| Metric::ALL.iter().map(move |metric| (*solver, *metric)));
        for (solver, metric) in pairs.filter(|(solver, _)| *solver != Solver::Sgd) {
            for (alpha, theta) in [1e-4, 1e-2, 1.0].into_iter().flat_map(|a| [0.0, 1.5, THETA_CEILING].map(|t| (a, t)))
            {
                let ggx = Ggx { alpha_x: alpha, alpha_y: alpha };
                let settings = FitSettings { metric, ..settings(solver, 64, 6, 40) };
                let entry = fit(settings, &ggx, direction(theta, 0.0), 0);
                assert!(entry.matrix.iter().all(|x| x.is_finite()), "{solver} {metric} {alpha} {theta}: {entry:?}");
                assert!(
                    from_row_major(&entry.matrix).determinant() > 0.0,
                    "{solver} {metric} {alpha} {theta}: {entry:?}"
                );
                assert!(entry.error < 0.2, "{solver} {metric} {alpha} {theta}: {entry:?}");
            }
        }
    }

    /// Seen from above, a sharp lobe is an LTC: `M = diag(2 alpha_x, 2 alpha_y, 1)`.
    #[test]
    fn a_sharp_lobe_from_above_has_the_limit_s_matrix() {
        let ggx = Ggx { alpha_x: 1e-3, alpha_y: 4e-4 };
        let entry = fit(settings(Solver::Bfgs, 512, 16, 60), &ggx, DVec3::Z, 0);
        let [xx, _, _, _, yy, _, _, _, zz] = entry.matrix;
        assert!((xx / zz / 2e-3 - 1.0).abs() < 0.01 && (yy / zz / 8e-4 - 1.0).abs() < 0.01, "{entry:?}");
        assert!((entry.amplitude - 1.0).abs() < 1e-4 && entry.fresnel < 1e-9, "{entry:?}");
    }

    #[test]
    fn more_samples_fit_better() {
        let ggx = Ggx { alpha_x: 0.4, alpha_y: 0.1 };
        let wo = direction(1.0, 0.6);
        let [coarse, fine] = [32, 1024].map(|n| fit(settings(Solver::Bfgs, n, 16, 60), &ggx, wo, 0).matrix);
        let mut judge = Fitter::new(&settings(Solver::Bfgs, 2048, 48, 1));
        let [coarse, fine] = [coarse, fine].map(|m| judge.error(&ggx, wo, &from_row_major(&m)));
        assert!(fine < coarse, "{fine} {coarse}");
    }

    /// Algorithm 3 approaches the same fit, only slower: after a few hundred steps a broad lobe is near its best fit.
    #[test]
    fn the_paper_s_descent_comes_near_the_same_error() {
        let ggx = Ggx { alpha_x: 0.8, alpha_y: 0.5 };
        let wo = direction(0.7, 0.4);
        let ours = fit(settings(Solver::Bfgs, 1024, 32, 60), &ggx, wo, 0).matrix;
        let descended = |seed| {
            let settings = FitSettings { seed, ..settings(Solver::Sgd, 256, 8, 600) };
            fit(settings, &ggx, wo, 7).matrix
        };
        let mut judge = Fitter::new(&settings(Solver::Bfgs, 1024, 32, 1));
        let [ours, theirs, identity] = [ours, descended(0), [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]]
            .map(|m| judge.error(&ggx, wo, &from_row_major(&m)));
        assert!(ours <= theirs && theirs < 3.0 * ours && theirs < 0.2 * identity, "{ours} {theirs} {identity}");
        assert_eq!(descended(0), descended(0));
        assert_ne!(descended(0), descended(1));
    }

    /// By the L3 norm too, from the identity, if the lobe is as broad: a sharp one has no slope there.
    #[test]
    fn the_descent_by_l3_finds_broad_lobes_and_stays_finite_at_sharp_ones() {
        let descended = |alpha: f64| {
            let settings = FitSettings { metric: Metric::L3, ..settings(Solver::Sgd, 256, 8, 1000) };
            let ggx = Ggx { alpha_x: alpha, alpha_y: alpha };
            let wo = direction(0.5, 0.4);
            let found = fit(settings, &ggx, wo, 7).matrix;
            let mut judge =
                Fitter::new(&FitSettings { metric: Metric::L3, ..self::settings(Solver::Bfgs, 1024, 32, 60) });
            let target = judge.seen.target(&ggx, wo);
            let lobe = Lobe { brdf: &ggx, wo, target: &target };
            let mut beat = unstopped;
            let mut pulse = Pulse::new(&mut beat);
            let mut loss = judge.seen.distance.to(&lobe, &mut pulse).expect("nothing stops it");
            let mut of = |m: DMat3| loss.value(&(target.frame.transpose() * m), &mut pulse).expect("nothing stops it");
            [of(from_row_major(&found)), of(DMat3::IDENTITY)]
        };
        let [found, identity] = descended(0.7);
        assert!(found < 0.35 * identity, "{found} {identity}");
        for alpha in [1e-4, 0.03] {
            let [found, identity] = descended(alpha);
            assert!(found.is_finite() && found < 1.1 * identity, "{alpha}: {found} {identity}");
        }
    }

    /// The largest settings that a recipe may have take minutes an entry. Every beat can stop them, and a beat comes for
    /// each 2^23 projections of a sample on a direction: while the lobe is tabulated, within an evaluation and within a
    /// step.
    #[test]
    fn an_entry_of_any_size_is_stopped_within_a_moment() {
        let ggx = Ggx { alpha_x: 0.4, alpha_y: 0.1 };
        let (samples, directions) = (16_384, 256);
        // The tabulation of both sample sets, and one evaluation; of `sgd` the sorts of its one step, if it sorts.
        let least = |solver: Solver, metric: Metric| {
            let sorts = match (solver, metric) {
                (Solver::Sgd, Metric::Sw1) => 16,
                (Solver::Sgd, Metric::L3) => 0,
                _ => 1,
            };
            let tabulations = if metric == Metric::Sw1 { 2 } else { 1 };
            ((tabulations * TARGET_SAMPLES_PER_SAMPLE + sorts) * samples as usize * directions as usize) >> 23
        };
        let pairs = Solver::ALL.iter().flat_map(|solver| Metric::ALL.iter().map(move |metric| (*solver, *metric)));
        for (solver, metric) in pairs {
            let settings = FitSettings { metric, ..settings(solver, samples, directions, 1) };
            let stopped_at = |stop: usize| {
                let mut beats = 0;
                let mut beat = || {
                    beats += 1;
                    if beats == stop { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
                };
                let entry = Fitter::new(&settings).fit(&ggx, direction(1.0, 0.6), 0, &mut Pulse::new(&mut beat));
                (beats, entry)
            };
            let (beats, entry) = stopped_at(usize::MAX);
            assert!(entry.is_some() && beats >= least(solver, metric), "{solver} {metric}: {beats} beats");
            for stop in [1, beats / 2, beats].into_iter().filter(|stop| *stop > 0) {
                assert_eq!(stopped_at(stop), (stop, None), "{solver} {metric}");
            }
        }
    }
}
