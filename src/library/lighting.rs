//! What a surface reflects of an area light.

use super::Error;
use crate::{
    fit::{Configuration, Table},
    light::{PolygonLight, Reflected, WeightRule, by_normals, by_table},
};

/// What a surface reflects of a light of radiance one, in closed form and without a table; see
/// [`mod@crate::light`] for lights of other shapes, other rules and the truth by quadrature.
///
/// # Errors
/// [`Error::Light`] for a roughness outside [0, 1] or a view direction on or below the horizon.
pub fn light(at: &Configuration, light: &PolygonLight) -> Result<Reflected, Error> {
    Ok(by_normals(at, light, WeightRule::Fan)?)
}

/// The same by a table of LTCs, as a shader would.
///
/// # Errors
/// [`Error::Light`] as [`light()`], and for a table without amplitude and Fresnel term.
pub fn light_by_table(table: &Table, at: &Configuration, light: &PolygonLight) -> Result<Reflected, Error> {
    Ok(by_table(table, at, light)?)
}
