//! What a fit costs, as the recipe tells it before anything is fitted.

use super::recipe::{FitSettings, Recipe};

/// An evaluation of loss and gradient, for each sample and direction. Like all below it was measured on one machine,
/// in seconds of one thread; on others their proportions count.
const EVALUATION_SECONDS: f64 = 4.5e-9;
/// And for each direction: its histograms.
const DIRECTION_SECONDS: f64 = 0.9e-6;
/// What else an entry takes for each sample: sampling the lobe, twice, four samples each.
const SAMPLING_SECONDS: f64 = 1.25e-6;
/// And in any case.
const ENTRY_SECONDS: f64 = 54e-6;

/// What the fit of a whole recipe takes, seconds of one thread on the machine of the constants.
#[must_use]
pub fn fit_seconds(recipe: &Recipe) -> f64 {
    lobes(recipe) * entry_seconds(&recipe.fit)
}

/// What one entry's fit takes.
fn entry_seconds(fit: &FitSettings) -> f64 {
    let evaluations = fit.solver.rules().evaluations(fit.steps);
    let (samples, directions) = (f64::from(fit.samples), f64::from(fit.directions));
    let evaluation = directions * (EVALUATION_SECONDS * samples + DIRECTION_SECONDS);
    f64::from(evaluations) * evaluation + SAMPLING_SECONDS * samples + ENTRY_SECONDS
}

/// Entries that are fitted: where the surface is isotropic or seen from above, those of all phi share one fit.
fn lobes(recipe: &Recipe) -> f64 {
    let nodes = recipe.nodes();
    let phi = nodes.phi.len();
    let of_row = |ratio: f64, theta: f64| if ratio == 1.0 || theta == 0.0 { 1 } else { phi };
    let rows = nodes.ratio.iter().flat_map(|ratio| nodes.theta.iter().map(move |theta| (*ratio, *theta)));
    nodes.alpha.len() as f64 * rows.map(|(ratio, theta)| of_row(ratio, theta)).sum::<usize>() as f64
}
