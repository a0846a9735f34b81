//! The time that a fit takes, estimated from its recipe.

use super::recipe::{FitSettings, Recipe};

/// Seconds of one evaluation of loss and gradient, for each sample and direction. All constants here are seconds of one
/// thread, measured on one machine. On other machines only their proportions count.
const EVALUATION_SECONDS: f64 = 2.4e-9;
/// Seconds of one evaluation for each direction, whatever the number of samples: the histograms.
const DIRECTION_SECONDS: f64 = 0.48e-6;
/// Seconds of an entry for each sample, beside its evaluations: the lobe is sampled twice, each time with two samples
/// for each sample of the LTC.
const SAMPLING_SECONDS: f64 = 0.31e-6;
/// Seconds of an entry that do not depend on the settings.
const ENTRY_SECONDS: f64 = 65e-6;

/// The time that the fit of a whole recipe takes, in seconds of one thread on the machine of the constants.
#[must_use]
pub fn fit_seconds(recipe: &Recipe) -> f64 {
    lobes(recipe) * entry_seconds(&recipe.fit)
}

/// The time that one entry's fit takes, likewise.
fn entry_seconds(fit: &FitSettings) -> f64 {
    let evaluations = fit.solver.rules().evaluations(fit.steps);
    let (samples, directions) = (f64::from(fit.samples), f64::from(fit.directions));
    let evaluation = directions * (EVALUATION_SECONDS * samples + DIRECTION_SECONDS);
    f64::from(evaluations) * evaluation + SAMPLING_SECONDS * samples + ENTRY_SECONDS
}

/// The number of entries that are fitted. Where the surface is isotropic or seen from above, the entries of all phi
/// share one fit.
fn lobes(recipe: &Recipe) -> f64 {
    let nodes = recipe.nodes();
    let phi = nodes.phi.len();
    let of_row = |ratio: f64, theta: f64| if ratio == 1.0 || theta == 0.0 { 1 } else { phi };
    let rows = nodes.ratio.iter().flat_map(|ratio| nodes.theta.iter().map(move |theta| (*ratio, *theta)));
    nodes.alpha.len() as f64 * rows.map(|(ratio, theta)| of_row(ratio, theta)).sum::<usize>() as f64
}
