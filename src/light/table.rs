//! What a surface reflects of a light by a table.

use super::{
    LightError, PolygonLight, Reflected,
    gaussians::{SphericalGaussian, reflected_by},
    model::surface_and_view,
};
use crate::fit::{Configuration, Ltc, Table, math::from_row_major};

/// The part that the light covers of the LTC or of the Gaussian that stands for the lobe, times the table's amplitude and
/// its Fresnel term.
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
    let matrix = from_row_major(&found.matrix);
    let Some(gaussian) = table.lobe.gaussian() else {
        let ltc = Ltc::new(matrix).ok_or(LightError::Singular)?;
        let covered = ltc.polygon(light.vertices(), light.sides());
        return Ok(Reflected { energy: amplitude * covered, fresnel: fresnel * covered });
    };
    let determinant = matrix.determinant();
    if determinant == 0.0 || !determinant.is_finite() {
        return Err(LightError::Singular);
    }
    let columns = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|column| column.to_array());
    let vertices: Vec<[f64; 3]> = light.vertices().iter().map(glam::DVec3::to_array).collect();
    let shape = SphericalGaussian::of_columns(gaussian, columns);
    let [energy, fresnel] = reflected_by(&shape, [amplitude, fresnel], &vertices, light.sides());
    Ok(Reflected { energy, fresnel })
}
