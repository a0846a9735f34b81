//! Predicts the time of a fit and the error of its table from the recipe.

use serde::Serialize;

use super::{axes::PerAxis, cost::fit_seconds, layout::Interpolation, math::pow, recipe::Recipe};

/// The predicted time of a fit, and the predicted error and size of its table.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Expectation {
    /// Seconds of one thread, on the machine of [`fit_seconds`].
    pub seconds: f64,
    /// Mean error between nodes, relative to the lobe's width: `between.width.mean` of the report.
    pub error: f64,
    /// Bytes of matrices and terms.
    pub bytes: u64,
}

/// The error due to a finite number of samples: `2.56 samples^-1.3`. Fitted to a full run of the measurements in
/// docs/tradeoff.md, from 64 to 2048 samples.
const SAMPLES: [f64; 2] = [2.56, -1.3];
/// The error due to a finite number of directions: `0.04 directions^-2`. Fitted to the same run, from 4 to 32
/// directions.
const DIRECTIONS: [f64; 2] = [0.04, -2.0];

/// The error that the report measures for an exact lobe. It comes from the report's own samples.
const EXACT: f64 = 0.0039;
/// The error of interpolation in `theta`, per squared step, if lobes are exact at the nodes.
const EXACT_THETA: f64 = 0.17;
/// The error of interpolation in `alpha`, per squared step, if entries are chosen for the error between nodes. For
/// other layouts see [`roughness_interpolation`].
const EXACT_ALPHA_CHOSEN: f64 = 0.5;
const EXACT_ALPHA: [f64; 2] = [0.2, 0.45];

/// Predicts the time, error and size of a recipe's table.
///
/// `error = limit + sum over axes of c h^2 + 2.56 samples^-1.3 + 0.04 directions^-2`. The layout determines `limit` and
/// `c`. `h` is the step between nodes in the spacing of the layout, relative to the whole domain. The solver's steps
/// and the precision have no effect. The errors after ten and after sixty steps of `bfgs` differ by less than 1 %, and
/// tables in f16 are as accurate as tables in f32. The formula is calibrated with LTCs of GGX over the whole domain,
/// fitted by `bfgs`. For a part of the domain the limit differs. For other scattering models and lobe models, the error
/// is multiplied by a constant factor. Lobes that are LTCs are not fitted: their error is the error of interpolation
/// plus 0.0039 from the report's own samples (measured on tables of `fuzz` with 6 to 48 nodes per axis). The prediction
/// does not depend on `fresnel`.
#[must_use]
pub fn expectation(recipe: &Recipe) -> Expectation {
    let Interpolation { limit, step: c } = recipe.layout.rules().interpolation();
    let h = recipe.layout.steps(&recipe.range, &recipe.resolution);
    let interpolation =
        c.alpha * h.alpha * h.alpha + c.ratio * h.ratio * h.ratio + c.theta * h.theta * h.theta + c.phi * h.phi * h.phi;
    let power = |x: u32, [factor, exponent]: [f64; 2]| factor * pow(f64::from(x), exponent);
    let effort = power(recipe.fit.samples, SAMPLES) + power(recipe.fit.directions, DIRECTIONS);
    let over_ggx = recipe.brdf.kind().rules().prediction_factors().error * recipe.lobe.rules().error_over_ltc();
    let error = if recipe.is_searched() {
        over_ggx * (limit + interpolation + effort)
    } else {
        EXACT + exact_interpolation(recipe, h)
    };
    Expectation { seconds: fit_seconds(recipe), error, bytes: recipe.bytes() }
}

/// The error of interpolation with steps `h`, for a table whose lobes are exact at the nodes.
fn exact_interpolation(recipe: &Recipe, h: PerAxis<f64>) -> f64 {
    let alpha = match recipe.layout.free_numbers() {
        Some(_) => EXACT_ALPHA_CHOSEN * h.alpha * h.alpha,
        None => roughness_interpolation(recipe.range.alpha[0].sqrt(), h.alpha),
    };
    alpha + EXACT_THETA * h.theta * h.theta
}

/// The error of interpolation in perceptual roughness `s`, from `low` to 1 in steps of `h`. Lobes change with the
/// logarithm of `s`, so the error at `s` is proportional to `(h / s)^2`. This is integrated from `a = max(h, low)` to
/// 1. The interval below `a` adds an error in proportion to its length.
fn roughness_interpolation(low: f64, h: f64) -> f64 {
    let [shorter, longer] = EXACT_ALPHA;
    let a = h.max(low);
    if a > 0.0 { shorter * h * h * (1.0 / a - 1.0) + longer * (a - low) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        BrdfKind, FITTER_VERSION, FitSettings, Layout, LobeFresnel, LobeModel, Metric, PerAxis, Plan, Precision,
        SecondLobe, Solver, StoredTerms, WeightedF0, assemble, fit_shard, report,
    };
    use std::{f64::consts::FRAC_PI_2, ops::ControlFlow};

    fn recipe(layout: Layout, resolution: [u32; 4], samples: u32) -> Recipe {
        let [alpha, ratio, theta, phi] = resolution;
        let quarter = [0.0, FRAC_PI_2];
        let whole = PerAxis { alpha: [0.0, 1.0], ratio: [0.0, 1.0], theta: quarter, phi: quarter };
        let range = layout.only_ranges().unwrap_or(whole);
        let nodes = |n: u32, [low, high]: [f64; 2]| if low < high { n } else { 1 };
        Recipe {
            fitter: FITTER_VERSION,
            given: crate::GivenNodes::default(),
            brdf: BrdfKind::Ggx.into(),
            lobe: LobeModel::Ltc,
            layout,
            resolution: PerAxis { alpha, ratio: nodes(ratio, range.ratio), theta, phi: nodes(phi, range.phi) },
            range,
            fit: FitSettings {
                metric: Metric::Sw1,
                solver: Solver::Bfgs,
                samples,
                directions: 8,
                steps: 20,
                seed: 0,
                simplex: None,
            },
            terms: StoredTerms::None,
            precision: Precision::F32,
        }
    }

    /// Tests tables that were not used for the calibration.
    #[test]
    fn small_tables_are_as_good_as_expected() {
        let whole = [([5, 3, 5, 3], 64), ([5, 4, 6, 5], 96)];
        let isotropic = [([64, 1, 64, 1], 64), ([48, 1, 64, 1], 96)];
        // Layout `materials` does not interpolate between materials. Between views it equals `reflected`.
        for &layout in Layout::ALL.iter().filter(|layout| !layout.is_of_materials()) {
            // The mean error of isotropic tables comes from a few lobes, so its limits are wider.
            let is_isotropic = layout.only_ranges().is_some();
            let (tables, likely) = if is_isotropic { (isotropic, 0.4..3.0) } else { (whole, 0.7..1.4) };
            for (resolution, samples) in tables {
                let recipe = recipe(layout, resolution, samples);
                let plan = Plan::new(&recipe);
                let fit =
                    |shard| fit_shard(&plan, shard, &mut |_| ControlFlow::Continue(())).expect("nothing stops it");
                let entries: Vec<_> = (0..plan.shards()).flat_map(fit).collect();
                let measured = report(&assemble(&plan, &entries), &recipe.range, 256).between.width.mean;
                let ratio = measured / expectation(&recipe).error;
                assert!(likely.contains(&ratio), "{layout:?} {resolution:?}: {measured}, {ratio} of the expected");
            }
        }
    }

    /// Tests each model with its default layout, on a few nodes.
    #[test]
    fn tables_of_every_model_are_as_good_as_expected() {
        let ltcs = BrdfKind::formulas().map(|kind| (kind, LobeModel::Ltc));
        let gaussians = LobeModel::ALL.iter().map(|lobe| (BrdfKind::Ggx, *lobe));
        for (kind, lobe) in ltcs.chain(gaussians) {
            let layout = if kind.follows_reflection() { Layout::Reflected } else { Layout::Kt2022 };
            let base = recipe(layout, [5, 3, 5, 3], 64);
            let one = PerAxis { ratio: [1.0, 1.0], phi: [0.0, 0.0], ..base.range };
            let isotropic =
                Recipe { range: one, resolution: PerAxis { alpha: 8, ratio: 1, theta: 8, phi: 1 }, ..base.clone() };
            let shape = if kind.is_isotropic() { isotropic } else { base };
            let recipe = Recipe { brdf: kind.into(), lobe, terms: StoredTerms::Schlick, ..shape };
            let plan = Plan::new(&recipe);
            let fit = |shard| fit_shard(&plan, shard, &mut |_| ControlFlow::Continue(())).expect("nothing stops it");
            let entries: Vec<_> = (0..plan.shards()).flat_map(fit).collect();
            let measured = report(&assemble(&plan, &entries), &recipe.range, 96).between.width.mean;
            let ratio = measured / expectation(&recipe).error;
            println!("{kind} {lobe}: {measured:.4}, {ratio:.2} of the expected");
            assert!((0.4..2.5).contains(&ratio), "{kind} {lobe}: {measured}, {ratio} of the expected");
        }
    }

    /// Lobes that are LTCs have only interpolation error, with few nodes and with many.
    #[test]
    fn tables_that_are_not_searched_for_are_as_good_as_expected() {
        let kt2022 = [(6, 8), (24, 6), (24, 32)].map(|nodes| (Layout::Kt2022, nodes));
        let chosen =
            Layout::ALL.iter().filter(|layout| layout.free_numbers().is_some()).map(|layout| (*layout, (12, 16)));
        let tables = kt2022
            .into_iter()
            .flat_map(|table| [1e-4, 0.01, 0.05].map(|low| (table, low)))
            .chain(chosen.map(|table| (table, 0.0)));
        for ((layout, (alpha, theta)), low) in tables {
            let base = recipe(layout, [alpha, 1, theta, 1], 64);
            let range = PerAxis { alpha: [low, 1.0], ratio: [1.0, 1.0], phi: [0.0, 0.0], ..base.range };
            let range = layout.only_ranges().unwrap_or(range);
            let resolution = PerAxis { alpha, ratio: 1, theta, phi: 1 };
            let recipe = Recipe { brdf: BrdfKind::Fuzz.into(), range, resolution, terms: StoredTerms::Schlick, ..base };
            let plan = Plan::new(&recipe);
            let fit = |shard| fit_shard(&plan, shard, &mut |_| ControlFlow::Continue(())).expect("nothing stops it");
            let entries: Vec<_> = (0..plan.shards()).flat_map(fit).collect();
            let measured = report(&assemble(&plan, &entries), &recipe.range, 96).between.width.mean;
            let ratio = measured / expectation(&recipe).error;
            println!("{layout} {alpha} x {theta} from {low}: {measured:.4}, {ratio:.2} of the expected");
            assert!((0.5..1.5).contains(&ratio), "{layout} {alpha} x {theta} from {low}: {measured}, {ratio}");
        }
    }

    /// Tests lobes of plastic and of a mix, and the first of two lobes.
    #[test]
    fn tables_of_other_materials_are_as_good_as_expected() {
        let f0 = |parts: &[f64]| {
            let mix = parts.iter().map(|&f0| WeightedF0 { f0, weight: 1.0 }).collect();
            LobeFresnel::mix(mix).expect("weights above zero")
        };
        let two = SecondLobe::ALL.map(LobeFresnel::Two);
        for fresnel in [f0(&[0.04]), f0(&[0.04, 1.0])].into_iter().chain(two) {
            let base = recipe(Layout::Reflected, [5, 4, 6, 5], 96);
            let brdf = base.brdf.clone().with_fresnel(fresnel.clone());
            let recipe = Recipe { brdf, terms: StoredTerms::Schlick, ..base };
            let plan = Plan::new(&recipe);
            let fit = |shard| fit_shard(&plan, shard, &mut |_| ControlFlow::Continue(())).expect("nothing stops it");
            let entries: Vec<_> = (0..plan.shards()).flat_map(fit).collect();
            let measured = report(&assemble(&plan, &entries), &recipe.range, 256).between.width.mean;
            let ratio = measured / expectation(&recipe).error;
            println!("{fresnel:?}: {measured:.4}, {ratio:.2} of the expected");
            assert!((0.7..1.4).contains(&ratio), "{fresnel:?}: {measured}, {ratio} of the expected");
        }
    }

    #[test]
    fn more_of_anything_is_expected_to_be_better_and_to_take_longer() {
        let base = expectation(&recipe(Layout::Reflected, [6, 4, 5, 4], 128));
        for (resolution, samples) in
            [([7, 4, 5, 4], 128), ([6, 5, 5, 4], 128), ([6, 4, 6, 4], 128), ([6, 4, 5, 5], 128), ([6, 4, 5, 4], 129)]
        {
            let more = expectation(&recipe(Layout::Reflected, resolution, samples));
            assert!(more.error < base.error && more.seconds > base.seconds, "{resolution:?} {samples}");
        }
    }
}
