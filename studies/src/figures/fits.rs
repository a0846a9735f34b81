//! The fits of the figures: single lobes and tables.

use std::ops::ControlFlow;

use glam::DVec3;
use ltcforge::{
    files::recipe_document::{DEFAULT_ENTRY_LIMIT, Preset, parse},
    fit::{FitSettings, FittedEntry, Fitter, Metric, Plan, Simplex, Solver, StopCheck, brdf::Ggx, fit_entries},
};

use super::error::FigureError;

/// The LTC with the least distance from a lobe.
pub(super) fn fitted(ggx: &Ggx, wo: DVec3) -> Result<FittedEntry, FigureError> {
    let mut go_on = || ControlFlow::Continue(());
    Fitter::new(&Preset::Paper.fit()).fit(ggx, wo, 0, &mut StopCheck::new(&mut go_on)).ok_or(FigureError::Stopped)
}

/// Steps of a simplex from an arbitrary start: far more than from a good start.
const STEPS: u32 = 400;

/// Settings for searches from a given start. The paper's solver is a descent. Here the simplex minimises both metrics,
/// so that only the metric differs.
pub(super) fn from_any_start(metric: Metric) -> FitSettings {
    FitSettings {
        metric,
        solver: Solver::NelderMead,
        steps: STEPS,
        simplex: Some(Simplex::default()),
        ..Preset::Paper.fit()
    }
}

/// The plan of a recipe and its fitted entries, on the current rayon pool.
pub(super) fn entries(recipe: &str) -> Result<(Plan, Vec<FittedEntry>), FigureError> {
    let plan = Plan::new(&parse(recipe.as_bytes(), DEFAULT_ENTRY_LIMIT)?);
    let entries = fit_entries(&plan, &|_| ControlFlow::Continue(())).ok_or(FigureError::Stopped)?;
    Ok((plan, entries))
}
