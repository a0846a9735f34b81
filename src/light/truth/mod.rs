//! The light that a surface reflects, by adaptive quadrature. It is slow, but as accurate as its tolerance.
//!
//! A quadrature over a light's area misses sharp lobes, which are tiny spots on the light, and needs ever more points
//! for needles. So the integral is over the light's image in a space ([`space::Space`]) where the lobe is broad. For
//! GGX this is the space of normals stretched by `1 / alpha` ([`super::normals`]). Every lobe is the same cosine there,
//! and the integrand is as smooth as the weight of shadowing. Other lobes around a reflection are as broad there.
//! Diffuse reflection, sheen and tabulated BRDFs are broad in the space of light directions.
//!
//! The integral over the image has two steps (`outline.rs`): along its outline, and along the ray from a tip in the
//! image to the outline. An edge is halved until its image is short. This finds the few points of a light that a mirror
//! reflects.
//!
//! An outline has straight pieces and arcs of ellipses (`border.rs`). The outlines of disks, spheres and tubes are
//! exact, without polygons. A line light has no outline; its reflection is an integral along it.
//!
//! This module shares no code with the closed form, except the map from directions to normals.

mod border;
mod directions;
mod microfacets;
mod outline;
mod quadrature;
mod space;
#[cfg(test)]
mod tests;
mod texels;

use self::{
    directions::Directions,
    microfacets::{GgxNormals, Normals},
    space::{Space, Weight},
};
use super::{AreaLight, LightError, ReflectedLight, rules::surface_and_view, shaped::Form};
use ltcforge_fit::{BrdfKind, BrdfModel, Configuration, Sides};

#[cfg(test)]
pub(super) use self::quadrature::integral;
pub(super) use self::texels::texel_lights;

/// The tolerance of [`truth`] for each part of an edge.
pub const TRUTH_TOLERANCE: f64 = 1e-9;

/// The light that a GGX surface reflects, to [`TRUTH_TOLERANCE`].
///
/// A line is the limit of a thin tube. Its reflection is proportional to its width, up to one.
///
/// # Errors
/// [`LightError::Domain`] for a roughness outside [0, 1] or a view direction on or below the horizon.
pub fn truth<'a>(at: &Configuration, light: impl Into<AreaLight<'a>>) -> Result<ReflectedLight, LightError> {
    truth_within(TRUTH_TOLERANCE, at, light)
}

/// Like [`truth`], with another tolerance for each part of an edge.
///
/// # Errors
/// The errors of [`truth`].
pub fn truth_within<'a>(
    tolerance: f64,
    at: &Configuration,
    light: impl Into<AreaLight<'a>>,
) -> Result<ReflectedLight, LightError> {
    truth_of(&BrdfKind::Ggx.into(), tolerance, at, light)
}

/// The light that a surface of any scattering model reflects, with a tolerance for each part of an edge.
///
/// For all models, [`ReflectedLight::fresnel`] is weighted by Schlick's fifth power of the cosine between view and half
/// vector, like the terms of their tables. A model that reflects more light than it receives has an energy above one.
/// The reflection of a line is proportional to its width, and for a lobe around a reflection at most one.
///
/// # Errors
/// The errors of [`truth`], and [`LightError::NoBrdfFile`] for a tabulated model without its values.
pub fn truth_of<'a>(
    brdf: &BrdfModel,
    tolerance: f64,
    at: &Configuration,
    light: impl Into<AreaLight<'a>>,
) -> Result<ReflectedLight, LightError> {
    let [energy, fresnel] = weighed(brdf, tolerance, at, light.into(), Weight::Schlick)?;
    Ok(ReflectedLight { energy, fresnel })
}

/// The light weighted by [`edge_weight`](ltcforge_fit::brdf::edge_weight) of the cosine between view and half vector.
/// This weight is the shape of the difference between F82 and Schlick's factor: see [`ReflectedLight::metal`].
///
/// # Errors
/// The errors of [`truth_of`].
pub fn edge_truth_of<'a>(
    brdf: &BrdfModel,
    tolerance: f64,
    at: &Configuration,
    light: impl Into<AreaLight<'a>>,
) -> Result<f64, LightError> {
    weighed(brdf, tolerance, at, light.into(), Weight::Edge).map(|[_, edge]| edge)
}

/// The reflected light, and its weighted part.
fn weighed(
    brdf: &BrdfModel,
    tolerance: f64,
    at: &Configuration,
    light: AreaLight<'_>,
    weight: Weight,
) -> Result<[f64; 2], LightError> {
    if !brdf.is_complete() {
        return Err(LightError::NoBrdfFile);
    }
    let (alpha, wo) = surface_and_view(at)?;
    if brdf.kind() == BrdfKind::Ggx {
        return Ok(reflected(&GgxNormals::new(alpha, wo, weight), light, 1.0, tolerance));
    }
    let surface = brdf.surface(alpha);
    Ok(if brdf.follows_reflection() {
        reflected(&Normals::new(&*surface, alpha, wo, weight), light, 1.0, tolerance)
    } else {
        reflected(&Directions::new(&*surface, wo, weight), light, f64::INFINITY, tolerance)
    })
}

/// The reflected light and its weighted part, in [0, `most`].
fn reflected(space: &impl Space, light: AreaLight<'_>, most: f64, tolerance: f64) -> [f64; 2] {
    let bounded = |parts: [f64; 2]| parts.map(|part| part.clamp(0.0, most));
    let (border, sides) = match light {
        AreaLight::Polygon(light) => (border::of_polygon(light.vertices()), light.sides()),
        AreaLight::Shaped(light) => match *light.form() {
            Form::Line { ends, width } => return bounded(outline::along_line(space, ends, width, tolerance)),
            Form::Ellipse { sides, .. } => (border::of_shape(light.form()), sides),
            Form::Sphere { .. } | Form::Tube { .. } => (border::of_shape(light.form()), Sides::Two),
        },
    };
    let sum = outline::within(space, &border::above_surface(&border), tolerance);
    // The outline runs clockwise as seen from the lit side; the sum is positive there.
    bounded(match (sides, sum[0] < 0.0) {
        (_, false) => sum,
        (Sides::Two, true) => sum.map(|x| -x),
        (Sides::One, true) => [0.0; 2],
    })
}
