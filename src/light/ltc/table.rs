//! The light that a surface reflects, computed with a table.

use glam::DMat3;

use super::{AboveSurface, CosineSpace};
use crate::{
    AreaLight, LightError, ReflectedLight,
    gaussians::{SphericalGaussian, reflected_by},
    rules::surface_and_view,
    shaped::Form,
};
use ltcforge_fit::{Configuration, Ltc, Table, blend_weight, blended, brdf::LobeTerms, math::from_row_major};

/// Computes the part of the LTC or Gaussian over the light, times the table's amplitude and Fresnel term. If entries
/// have two lobes, the Fresnel term belongs to the second lobe.
///
/// An LTC is integrated over every shape exactly. A Gaussian is integrated over the polygon of
/// [`ShapedLight::outline`](crate::ShapedLight::outline). The Fresnel factor is assumed to be the same in all
/// directions of the lobe, as in the shaders.
///
/// # Errors
/// [`LightError::Domain`] for a roughness outside [0, 1] or a view direction on or below the horizon,
/// [`LightError::NoTerms`] for a table without terms, [`LightError::Singular`] for a singular matrix.
pub fn by_table<'a>(
    table: &Table,
    at: &Configuration,
    light: impl Into<AreaLight<'a>>,
) -> Result<ReflectedLight, LightError> {
    by_table_as(table, at, light, TableUse::default())
}

/// The options of light from a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct TableUse {
    /// Cuts an LTC and the light at the surface: see [`AboveSurface`]. Otherwise an LTC receives some light from below
    /// the surface. Gaussians are always cut.
    pub cut: bool,
    /// Computes one integral, of the blend of an entry's two lobes. Otherwise each lobe has its own integral.
    pub blend: bool,
}

/// Like [`by_table`], with options.
///
/// # Errors
/// The errors of [`by_table`].
pub fn by_table_as<'a>(
    table: &Table,
    at: &Configuration,
    light: impl Into<AreaLight<'a>>,
    TableUse { cut, .. }: TableUse,
) -> Result<ReflectedLight, LightError> {
    let light = light.into();
    surface_and_view(at)?;
    let found = table.lookup(at);
    let (Some(amplitude), Some(fresnel)) = (found.amplitude, found.fresnel) else { return Err(LightError::NoTerms) };
    let matrix = from_row_major(&found.matrix);
    let Some(gaussian) = table.lobe.gaussian() else {
        let of_first = covered(&matrix, light, cut)?;
        let of_second = found.second.map(|second| covered(&from_row_major(&second), light, cut)).transpose()?;
        let fresnel = fresnel * of_second.unwrap_or(of_first);
        return Ok(ReflectedLight { energy: amplitude * of_first, fresnel });
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

/// The light that a material with Schlick's Fresnel factor reflects, from one integral of the blend of an entry's two
/// lobes.
///
/// # Errors
/// The errors of [`by_table`], and [`LightError::OneLobe`] for a table with one lobe per entry.
pub fn by_blend<'a>(
    table: &Table,
    at: &Configuration,
    light: impl Into<AreaLight<'a>>,
    [f0, f90]: [f64; 2],
    TableUse { cut, .. }: TableUse,
) -> Result<f64, LightError> {
    surface_and_view(at)?;
    let found = table.lookup(at);
    let (Some(amplitude), Some(fresnel)) = (found.amplitude, found.fresnel) else { return Err(LightError::NoTerms) };
    let second = found.second.ok_or(LightError::OneLobe)?;
    let weight = blend_weight(LobeTerms { amplitude, fresnel }, f0, f90);
    let matrix = blended(&from_row_major(&found.matrix), &from_row_major(&second), weight);
    Ok((f0 * (amplitude - fresnel) + f90 * fresnel) * covered(&matrix, light.into(), cut)?)
}

/// The light weighted by F82's edge weight, from the table's edge term: see [`ReflectedLight::metal`].
///
/// # Errors
/// The errors of [`by_table`], and [`LightError::NoEdge`] for a table without the edge term. Tables of Gaussians never
/// have this term.
pub fn edge_by_table<'a>(
    table: &Table,
    at: &Configuration,
    light: impl Into<AreaLight<'a>>,
    used: TableUse,
) -> Result<f64, LightError> {
    let found = table.lookup(at);
    let (Some(amplitude), Some(edge)) = (found.amplitude, found.edge) else { return Err(LightError::NoEdge) };
    let reflected = by_table_as(table, at, light, used)?;
    Ok(if amplitude > 0.0 { edge * (reflected.energy / amplitude) } else { 0.0 })
}

/// The part of an LTC over a light. With `cut` the LTC is cut at the surface.
pub(crate) fn covered(matrix: &DMat3, light: AreaLight<'_>, cut: bool) -> Result<f64, LightError> {
    let ltc = Ltc::new(*matrix).ok_or(LightError::Singular)?;
    Ok(match light {
        AreaLight::Polygon(light) if !cut => ltc.polygon(light.vertices(), light.sides()),
        _ => covered_in(CosineSpace::from(&ltc), light, cut),
    })
}

/// The part of the distribution over a light. With `cut` the distribution is cut at the surface.
pub(crate) fn covered_in(space: CosineSpace<f64>, light: AreaLight<'_>, cut: bool) -> f64 {
    if cut {
        return covered_above(&space.above_surface(), light);
    }
    match light {
        AreaLight::Polygon(light) => space.polygon(light.vertices(), light.sides()),
        AreaLight::Shaped(light) => match *light.form() {
            Form::Ellipse { centre, half_axes, sides } => space.ellipse(centre, half_axes, sides),
            Form::Sphere { centre, radius } => space.sphere(centre, radius),
            Form::Tube { ends, radius } => space.tube(ends, radius),
            Form::Line { ends, width } => space.line(ends, width),
        },
    }
}

fn covered_above(above: &AboveSurface<f64>, light: AreaLight<'_>) -> f64 {
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
