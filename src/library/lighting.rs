//! Area lights: the light that a surface reflects.

use super::Error;
use ltcforge_fit::{Configuration, Table};
use ltcforge_light::{AreaLight, NormalsRule, ReflectedLight, TableUse, by_normals, by_table, by_table_as};

/// The reflection of a light of radiance one, in closed form and without a table. See [`mod@ltcforge_light`] for other
/// rules and the reference by quadrature. The light is a [`PolygonLight`](ltcforge_light::PolygonLight) or a
/// [`ShapedLight`](ltcforge_light::ShapedLight).
///
/// # Errors
/// [`Error::Light`] for a roughness outside [0, 1] or a view direction on or below the horizon.
pub fn light<'a>(at: &Configuration, light: impl Into<AreaLight<'a>>) -> Result<ReflectedLight, Error> {
    Ok(by_normals(at, light, NormalsRule::Balanced)?)
}

/// Like [`light()`], but with a table of LTCs, as a shader computes it. Disks, spheres, tubes and lines are not
/// replaced by polygons.
///
/// # Errors
/// [`Error::Light`] in the same cases as [`light()`], and for a table without amplitude and Fresnel term.
pub fn light_by_table<'a>(
    table: &Table,
    at: &Configuration,
    light: impl Into<AreaLight<'a>>,
) -> Result<ReflectedLight, Error> {
    Ok(by_table(table, at, light)?)
}

/// Like [`light_by_table()`], but cuts the lights and the lobe at the surface. An LTC without the cut also reflects
/// light from below the surface.
///
/// # Errors
/// [`Error::Light`] in the same cases as [`light_by_table()`].
pub fn light_by_table_above<'a>(
    table: &Table,
    at: &Configuration,
    light: impl Into<AreaLight<'a>>,
) -> Result<ReflectedLight, Error> {
    Ok(by_table_as(table, at, light, TableUse { cut: true, ..TableUse::default() })?)
}
