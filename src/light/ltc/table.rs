//! The light that a surface reflects, by a table.

use super::CosineSpace;
use crate::{
    AreaLight, LightError, ReflectedLight,
    gaussians::{SphericalGaussian, reflected_by},
    rules::surface_and_view,
    shaped::Form,
};
use ltcforge_fit::{Configuration, Ltc, Table, math::from_row_major};

/// The part that the light covers of the LTC or of the Gaussian that stands for the lobe, times the table's amplitude
/// and its Fresnel term.
///
/// An LTC is integrated over every shape itself, a Gaussian over the polygon that
/// [`ShapedLight::outline`](crate::ShapedLight::outline) tells. Fresnel's weight is taken to be the same in every
/// direction of the lobe, as in the shaders.
///
/// # Errors
/// [`LightError::Domain`] for a roughness outside [0, 1] or a view direction on or below the horizon,
/// [`LightError::NoTerms`] and [`LightError::Singular`] for a table that does not tell.
pub fn by_table<'a>(
    table: &Table,
    at: &Configuration,
    light: impl Into<AreaLight<'a>>,
) -> Result<ReflectedLight, LightError> {
    surface_and_view(at)?;
    let light = light.into();
    let found = table.lookup(at);
    let (Some(amplitude), Some(fresnel)) = (found.amplitude, found.fresnel) else { return Err(LightError::NoTerms) };
    let matrix = from_row_major(&found.matrix);
    let Some(gaussian) = table.lobe.gaussian() else {
        let ltc = Ltc::new(matrix).ok_or(LightError::Singular)?;
        let covered = covered(&ltc, light);
        return Ok(ReflectedLight { energy: amplitude * covered, fresnel: fresnel * covered });
    };
    let determinant = matrix.determinant();
    if determinant == 0.0 || !determinant.is_finite() {
        return Err(LightError::Singular);
    }
    let columns = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|column| column.to_array());
    let (vertices, sides) = light.polygon()?;
    let shape = SphericalGaussian::of_columns(gaussian, columns);
    let [energy, fresnel] = reflected_by(&shape, [amplitude, fresnel], &vertices, sides);
    Ok(ReflectedLight { energy, fresnel })
}

/// The same light weighed by F82's edge, in proportion to the table's edge term: see [`ReflectedLight::metal`].
///
/// # Errors
/// As [`by_table`], and [`LightError::NoEdge`] for a table without that term, which those of Gaussians are.
pub fn edge_by_table<'a>(
    table: &Table,
    at: &Configuration,
    light: impl Into<AreaLight<'a>>,
) -> Result<f64, LightError> {
    let found = table.lookup(at);
    let (Some(amplitude), Some(edge)) = (found.amplitude, found.edge) else { return Err(LightError::NoEdge) };
    let reflected = by_table(table, at, light)?;
    Ok(if amplitude > 0.0 { edge * (reflected.energy / amplitude) } else { 0.0 })
}

/// The part of an LTC that a light covers.
pub(crate) fn covered(ltc: &Ltc, light: AreaLight<'_>) -> f64 {
    let space = CosineSpace::from(ltc);
    match light {
        AreaLight::Polygon(light) => ltc.polygon(light.vertices(), light.sides()),
        AreaLight::Shaped(light) => match *light.form() {
            Form::Ellipse { centre, half_axes, sides } => space.ellipse(centre, half_axes, sides),
            Form::Sphere { centre, radius } => space.sphere(centre, radius),
            Form::Tube { ends, radius } => space.tube(ends, radius),
            Form::Line { ends, width } => space.line(ends, width),
        },
    }
}
