//! The light that a surface reflects, by adaptive quadrature: slow, and as exact as one likes.
//!
//! Quadrature over a light's area misses sharp lobes, which are points of it, and needs more and more points for
//! needles. So the light's image is integrated over in a space ([`space::Space`]) where the lobe is broad. For GGX that
//! is the space of normals stretched by `1 / alpha` ([`super::normals`]): every lobe is the same cosine there, and the
//! integrand as smooth as the weight of shadowing. Other lobes around a reflection are as broad there; diffuse
//! reflection, sheen and tabulated BRDFs are broad among the directions of light themselves.
//!
//! The image is integrated over in two steps (`outline.rs`): along its outline, and along the ray from a tip within the
//! image to the outline. An edge is halved until its image is short, which finds the few points of a light that a
//! mirror reflects.
//!
//! An outline has straight pieces and arcs of ellipses (`border.rs`): those of disks, spheres and tubes are exact, and
//! no polygon stands for them. A line light has no outline; its reflection is an integral along it.
//!
//! This shares no line with the closed form but the mapping of directions to normals.

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

/// How exact [`truth`] is, for each part of an edge.
pub const TRUTH_TOLERANCE: f64 = 1e-9;

/// The light that a surface of GGX reflects, to [`TRUTH_TOLERANCE`].
///
/// A line is the limit of a thin tube: its reflection is proportional to its width, up to one.
///
/// # Errors
/// [`LightError::Domain`] for a roughness outside [0, 1] or a view direction on or below the horizon.
pub fn truth<'a>(at: &Configuration, light: impl Into<AreaLight<'a>>) -> Result<ReflectedLight, LightError> {
    truth_within(TRUTH_TOLERANCE, at, light)
}

/// The same, with another tolerance for each part of an edge.
///
/// # Errors
/// As [`truth`].
pub fn truth_within<'a>(
    tolerance: f64,
    at: &Configuration,
    light: impl Into<AreaLight<'a>>,
) -> Result<ReflectedLight, LightError> {
    truth_of(&BrdfKind::Ggx.into(), tolerance, at, light)
}

/// The light that a surface of any scattering model reflects, with a tolerance for each part of an edge.
///
/// For a model without Fresnel factor, [`ReflectedLight::fresnel`] is weighed by Schlick's fifth power of the angle
/// between view and half vector all the same, as the terms of its tables are. A model that reflects more light than it
/// receives has an energy above one. The reflection of a line is proportional to its width, for a lobe around a
/// reflection up to one.
///
/// # Errors
/// As [`truth`], and [`LightError::NoBrdfFile`] for a tabulated model without its numbers.
pub fn truth_of<'a>(
    brdf: &BrdfModel,
    tolerance: f64,
    at: &Configuration,
    light: impl Into<AreaLight<'a>>,
) -> Result<ReflectedLight, LightError> {
    let [energy, fresnel] = weighed(brdf, tolerance, at, light.into(), Weight::Schlick)?;
    Ok(ReflectedLight { energy, fresnel })
}

/// The same light weighed by [`edge_weight`](ltcforge_fit::brdf::edge_weight) of the angle between view and half vector, by
/// which F82 differs from Schlick's factor: see [`ReflectedLight::metal`].
///
/// # Errors
/// As [`truth_of`].
pub fn edge_truth_of<'a>(
    brdf: &BrdfModel,
    tolerance: f64,
    at: &Configuration,
    light: impl Into<AreaLight<'a>>,
) -> Result<f64, LightError> {
    weighed(brdf, tolerance, at, light.into(), Weight::Edge).map(|[_, edge]| edge)
}

/// The reflected light, and the same weighed.
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

/// The reflected light and its weighed part, in [0, `most`].
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
    // The lit side is that from which the outline runs clockwise; seen from there, the sum is positive.
    bounded(match (sides, sum[0] < 0.0) {
        (_, false) => sum,
        (Sides::Two, true) => sum.map(|x| -x),
        (Sides::One, true) => [0.0; 2],
    })
}
