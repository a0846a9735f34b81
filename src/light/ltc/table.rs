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
    reflected(table, at, light.into(), Below::Shines)
}

/// As [`by_table`], by an LTC that ends at the surface: see [`AboveSurface`](super::AboveSurface). Gaussians end there
/// in either case.
///
/// # Errors
/// As [`by_table`].
pub fn by_table_above<'a>(
    table: &Table,
    at: &Configuration,
    light: impl Into<AreaLight<'a>>,
) -> Result<ReflectedLight, LightError> {
    reflected(table, at, light.into(), Below::Cut)
}

/// What becomes of light from below the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Below {
    /// An LTC lets some of it through.
    Shines,
    /// Both light and lobe end at the surface.
    Cut,
}

fn reflected(
    table: &Table,
    at: &Configuration,
    light: AreaLight<'_>,
    below: Below,
) -> Result<ReflectedLight, LightError> {
    surface_and_view(at)?;
    let found = table.lookup(at);
    let (Some(amplitude), Some(fresnel)) = (found.amplitude, found.fresnel) else { return Err(LightError::NoTerms) };
    let matrix = from_row_major(&found.matrix);
    let Some(gaussian) = table.lobe.gaussian() else {
        let ltc = Ltc::new(matrix).ok_or(LightError::Singular)?;
        let covered = match below {
            Below::Shines => covered(&ltc, light),
            Below::Cut => covered_above(&ltc, light),
        };
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

/// The part of an LTC that a light covers.
fn covered(ltc: &Ltc, light: AreaLight<'_>) -> f64 {
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

/// The part of an LTC that ends at the surface, likewise.
fn covered_above(ltc: &Ltc, light: AreaLight<'_>) -> f64 {
    let above = CosineSpace::from(ltc).above_surface();
    match light {
        AreaLight::Polygon(light) => above.polygon(light.vertices(), light.sides()),
        AreaLight::Shaped(light) => match *light.form() {
            Form::Ellipse { centre, half_axes, sides } => above.ellipse(centre, half_axes, sides),
            Form::Sphere { centre, radius } => above.sphere(centre, radius),
            Form::Tube { ends, radius } => above.tube(ends, radius),
            Form::Line { ends, width } => above.line(ends, width),
        },
    }
}
