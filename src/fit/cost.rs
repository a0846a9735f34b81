//! Estimates the time of a fit from its recipe.

use super::{
    brdf::BrdfKind,
    lobe::LobeModel,
    metric::Metric,
    recipe::{FitSettings, Recipe},
    solver::{Effort, Solver},
};

/// Seconds for each sample of an entry, in addition to the solver's time. The lobe is sampled twice, each time with two
/// samples for each sample of the LTC. All times here and in `solver` are seconds of one thread, measured on one
/// machine. On other machines only the ratios of the times are valid.
const SAMPLING_SECONDS: f64 = 0.31e-6;
/// The fraction of a step's time that the scattering model takes, for solvers that evaluate the model in each step.
const STEP_SAMPLING: f64 = 0.25;
/// Seconds for each entry that do not depend on the settings.
const ENTRY_SECONDS: f64 = 65e-6;

/// The predicted time to fit a whole recipe, in seconds of one thread on the measured machine.
#[must_use]
pub fn fit_seconds(recipe: &Recipe) -> f64 {
    // The second lobe of an entry needs a second fit.
    let fits = if recipe.brdf.fresnel().second().is_some() { 2.0 } else { 1.0 };
    fits * lobes(recipe) * entry_seconds(recipe.brdf.kind(), recipe.lobe, &recipe.fit)
}

/// The predicted time to fit one entry, in seconds of one thread on the measured machine.
fn entry_seconds(brdf: BrdfKind, lobe: LobeModel, fit: &FitSettings) -> f64 {
    let effort = Effort {
        metric: fit.metric,
        samples: fit.samples as usize,
        directions: fit.directions as usize,
        steps: fit.steps,
        seed: fit.seed,
    };
    // Solver `sgd`, and all solvers with metric `l3`, evaluate the model in each step.
    let of_sample = brdf.rules().prediction_factors().sample;
    let is_fixed = fit.metric == Metric::Sw1 && fit.solver != Solver::Sgd;
    let of_step = if is_fixed { 1.0 } else { 1.0 + STEP_SAMPLING * (of_sample - 1.0) };
    let sampling = SAMPLING_SECONDS * of_sample * f64::from(fit.samples);
    let is_searched = !(lobe == LobeModel::Ltc && brdf.is_ltc());
    let search = if is_searched { of_step * fit.solver.rules().seconds(lobe, &effort) } else { 0.0 };
    search + sampling + ENTRY_SECONDS
}

/// The number of fits. All phi share one fit if the surface is isotropic or viewed along its normal.
fn lobes(recipe: &Recipe) -> f64 {
    let nodes = recipe.nodes();
    let phi = nodes.phi.len();
    let of_row = |ratio: f64, theta: f64| if ratio == 1.0 || theta == 0.0 { 1 } else { phi };
    let rows = nodes.ratio.iter().flat_map(|ratio| nodes.theta.iter().map(move |theta| (*ratio, *theta)));
    // In a table of materials, each ratio belongs to one material, so the ratios alone count the materials.
    let alphas = if recipe.layout.is_of_materials() { 1 } else { nodes.alpha.len() };
    alphas as f64 * rows.map(|(ratio, theta)| of_row(ratio, theta)).sum::<usize>() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Fitter, Metric, Solver, brdf::Ggx, math::direction, stop_check::work_of};

    /// Tests that the prediction is 1 to 10 ns for each projection of a sample on a direction. `ltcforge-studies costs`
    /// measures the real time.
    #[test]
    fn the_seconds_of_each_solver_follow_its_work() {
        let ggx = Ggx { alpha_x: 0.4, alpha_y: 0.1 };
        let found = |solver: Solver| {
            LobeModel::ALL.iter().filter(move |lobe| solver.finds(**lobe)).map(move |lobe| (solver, *lobe))
        };
        for (solver, lobe) in Solver::ALL.iter().copied().flat_map(found) {
            for (samples, directions) in [(1024, 8), (1024, 64), (8192, 16)] {
                let fit =
                    FitSettings { metric: Metric::Sw1, solver, samples, directions, steps: 20, seed: 0, simplex: None };
                let work = work_of(|stop_check| {
                    Fitter::new(&fit).of(lobe).fit(&ggx, direction(1.0, 0.6), 0, stop_check).expect("nothing stops it");
                });
                let nanoseconds = 1e9 * entry_seconds(BrdfKind::Ggx, lobe, &fit) / work as f64;
                assert!(
                    (1.0..10.0).contains(&nanoseconds),
                    "{solver} {lobe} {samples} x {directions}: {nanoseconds} ns"
                );
            }
        }
    }
}
