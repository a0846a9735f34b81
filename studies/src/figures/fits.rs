//! The fits of the figures: single lobes and tables.

use std::ops::ControlFlow;

use glam::DVec3;
use ltcforge::{
    files::recipe_document::{DEFAULT_ENTRY_LIMIT, Preset, parse},
    fit::{FitSettings, FittedEntry, Fitter, Metric, Plan, Simplex, Solver, StopCheck, brdf::Ggx, fit_entries},
};

use super::error::FigureError;

/// The LTC with the least distance to a lobe.
pub(super) fn fitted(ggx: &Ggx, wo: DVec3) -> Result<FittedEntry, FigureError> {
    let mut go_on = || ControlFlow::Continue(());
    Fitter::new(&Preset::Paper.fit()).fit(ggx, wo, 0, &mut StopCheck::new(&mut go_on)).ok_or(FigureError::Stopped)
}

/// Steps of the simplex from an arbitrary start. A good start needs far fewer.
const STEPS: u32 = 400;

/// Settings for searches from a given start. The paper's solver is gradient descent. Here the simplex minimises both
/// metrics, so the fits differ only in the metric.
pub(super) fn from_any_start(metric: Metric) -> FitSettings {
    FitSettings {
        metric,
        solver: Solver::NelderMead,
        steps: STEPS,
        simplex: Some(Simplex::default()),
        ..Preset::Paper.fit()
    }
}

/// The plan of a recipe, and its fitted entries. Fits run on the current rayon pool.
pub(super) fn entries(recipe: &str) -> Result<(Plan, Vec<FittedEntry>), FigureError> {
    let plan = Plan::new(&parse(recipe.as_bytes(), DEFAULT_ENTRY_LIMIT)?);
    let entries = fit_entries(&plan, &|_| ControlFlow::Continue(())).ok_or(FigureError::Stopped)?;
    Ok((plan, entries))
}
