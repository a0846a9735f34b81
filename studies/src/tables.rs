//! The tables that studies fit, and the materials for measuring them.

use std::{f64::consts::FRAC_PI_2, ops::ControlFlow};

use ltcforge::{
    BrdfKind, Configuration, LookedUp, Recipe, RecipeDocument as _, Table,
    fit::{Fitter, Plan, StopCheck, fit_plan, math::recurrence4},
};
use rayon::prelude::*;

/// The start of the sequence of materials. Reports use another sequence.
const SHIFT: [f64; 4] = [0.326_237_921_249_264, 0.899_494_936_611_665, 0.124_355_652_982_141, 0.652_475_842_498_528];
/// Samples, directions and steps for the fits of the best LTCs.
const BEST: [u32; 3] = [8192, 64, 120];

/// The table of a recipe, fitted on the current rayon pool.
///
/// # Panics
/// Never: nothing stops the fit.
#[must_use]
pub fn fitted(recipe: &Recipe) -> Table {
    fit_plan(&Plan::new(recipe), &|_| ControlFlow::Continue(())).expect("nothing stops it")
}

/// Materials and views as artists set them: evenly distributed in perceptual roughness from 0.05 to 1, in ratio from
/// 0.05 to 1, and in the view angles up to 89 degrees.
#[must_use]
pub fn materials(count: usize, is_isotropic: bool) -> Vec<Configuration> {
    let material = |i: usize| {
        let [a, ratio, theta, phi] = recurrence4(i, SHIFT);
        let roughness = 0.05 + 0.95 * a;
        let alpha = roughness * roughness;
        let ratio = if is_isotropic { 1.0 } else { 0.05 + 0.95 * ratio };
        let phi = if is_isotropic { 0.0 } else { phi * FRAC_PI_2 };
        Configuration { alpha_x: alpha, alpha_y: alpha * ratio, theta: 0.99 * FRAC_PI_2 * theta, phi }
    };
    (0..count).map(material).collect()
}

/// The best LTC at each configuration. It is fitted with more samples than any table.
///
/// # Panics
/// Never: the settings are within their bounds, and nothing stops the fit.
#[must_use]
pub fn best(places: &[Configuration]) -> Vec<(Configuration, LookedUp)> {
    let [samples, directions, steps] = BEST;
    let recipe = Recipe::builder().samples(samples).directions(directions).steps(steps).build();
    let fitter = Fitter::new(&recipe.expect("within bounds").fit());
    let fit = |fitter: &mut Fitter, at: &Configuration| {
        let surface = BrdfKind::Ggx.surface([at.alpha_x, at.alpha_y]);
        let wo = ltcforge::fit::math::direction(at.theta, at.phi);
        let mut go_on = || ControlFlow::Continue(());
        let entry = fitter.fit(&*surface, wo, 0, &mut StopCheck::new(&mut go_on)).expect("nothing stops it");
        let (amplitude, fresnel) = (Some(entry.amplitude), Some(entry.fresnel));
        (*at, LookedUp { matrix: entry.matrix, second: None, amplitude, fresnel, edge: None })
    };
    places.par_iter().with_max_len(1).map_init(|| fitter.another(), fit).collect()
}

/// The lookup of a table at each configuration.
#[must_use]
pub fn looked_up(table: &Table, places: &[Configuration]) -> Vec<(Configuration, LookedUp)> {
    places.iter().map(|at| (*at, table.lookup(at))).collect()
}
