//! What a surface reflects of a light by a table of LTCs.

use super::{LightError, PolygonLight, Reflected, model::surface_and_view};
use crate::fit::{Configuration, Ltc, Table, math::from_row_major};

/// The part of the lobe's LTC that the light covers, times the table's amplitude and its Fresnel term.
///
/// Fresnel's weight is taken to be the same in every direction of the lobe, as in the shaders.
///
/// # Errors
/// [`LightError::Domain`] for a roughness outside [0, 1] or a view direction on or below the horizon,
/// [`LightError::NoTerms`] and [`LightError::Singular`] for a table that does not tell.
pub fn by_table(table: &Table, at: &Configuration, light: &PolygonLight) -> Result<Reflected, LightError> {
    surface_and_view(at)?;
    let found = table.lookup(at);
    let (Some(amplitude), Some(fresnel)) = (found.amplitude, found.fresnel) else { return Err(LightError::NoTerms) };
    let ltc = Ltc::new(from_row_major(&found.matrix)).ok_or(LightError::Singular)?;
    let covered = ltc.polygon(light.vertices(), light.sides());
    Ok(Reflected { energy: amplitude * covered, fresnel: fresnel * covered })
}
