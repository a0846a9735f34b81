//! What the figures fit: single lobes, and tables.

use std::ops::ControlFlow;

use glam::DVec3;

use super::error::FigureError;
use crate::{
    files::recipe_document::{DEFAULT_ENTRY_LIMIT, Preset, parse},
    fit::{FittedEntry, Fitter, Plan, Pulse, brdf::Ggx, fit_entries},
};

/// The LTC that is nearest to a lobe.
pub(super) fn fitted(ggx: &Ggx, wo: DVec3) -> Result<FittedEntry, FigureError> {
    let mut go_on = || ControlFlow::Continue(());
    Fitter::new(&Preset::Paper.fit()).fit(ggx, wo, 0, &mut Pulse::new(&mut go_on)).ok_or(FigureError::Stopped)
}

/// The plan of a recipe and its fitted entries, on the current rayon pool.
pub(super) fn entries(recipe: &str) -> Result<(Plan, Vec<FittedEntry>), FigureError> {
    let plan = Plan::new(&parse(recipe.as_bytes(), DEFAULT_ENTRY_LIMIT)?);
    let entries = fit_entries(&plan, &|_| ControlFlow::Continue(())).ok_or(FigureError::Stopped)?;
    Ok((plan, entries))
}
