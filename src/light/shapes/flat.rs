//! Rectangles, ellipses and lines.

use std::f64::consts::TAU;

use glam::DVec3;

use crate::{LightError, PolygonLight};
use ltcforge_fit::{Sides, math::sin_cos};

/// The number of vertices of the polygon that replaces an ellipse.
pub const ELLIPSE_VERTICES: u32 = 32;

/// The rectangle or parallelogram `centre + x half[0] + y half[1]` for x and y in [-1, 1]. Its lit side is the side of
/// `half[0] x half[1]`.
///
/// # Errors
/// The errors of [`PolygonLight::new`].
pub fn rectangle(centre: DVec3, half: [DVec3; 2], sides: Sides) -> Result<PolygonLight, LightError> {
    let [x, y] = half;
    PolygonLight::new(vec![centre - x - y, centre - x + y, centre + x + y, centre + x - y], sides)
}

/// The ellipse `centre + cos t half[0] + sin t half[1]` as a polygon of [`ELLIPSE_VERTICES`] vertices, with the area of
/// the ellipse. Its lit side is the side of `half[0] x half[1]`.
///
/// The polygon's vertices are 0.0032 radii outside of the ellipse, and the midpoints of its edges 0.0016 inside. For
/// ellipses around lobes of roughness 0.01 to 1, the error of the visible part is 1.7e-5 on average and 4.2e-4 at most.
/// For roughness down to 1e-4 it is 3.8e-5 and 1.1e-3.
///
/// # Errors
/// The errors of [`PolygonLight::new`].
pub fn ellipse(centre: DVec3, half: [DVec3; 2], sides: Sides) -> Result<PolygonLight, LightError> {
    let step = TAU / f64::from(ELLIPSE_VERTICES);
    // The area of a regular polygon relative to its circle is sin(step) / step.
    let outwards = (step / sin_cos(step).0).sqrt();
    let vertex = |i: u32| {
        // The vertices run backwards, which is clockwise as seen from the lit side.
        let (sin, cos) = sin_cos(-step * f64::from(i));
        centre + (half[0] * cos + half[1] * sin) * outwards
    };
    PolygonLight::new((0..ELLIPSE_VERTICES).map(vertex).collect(), sides)
}

/// The disk around `centre` whose lit side is the side of `normal`, a vector of any length; see [`ellipse`].
///
/// # Errors
/// [`LightError::Length`] for a negative radius or a normal without a direction, and the errors of
/// [`PolygonLight::new`].
pub fn disk(centre: DVec3, normal: DVec3, radius: f64, sides: Sides) -> Result<PolygonLight, LightError> {
    check_length("the radius", radius)?;
    let Some(normal) = normal.try_normalize() else {
        return Err(LightError::Length { what: "the normal's length", value: normal.length() });
    };
    let (x, y) = normal.any_orthonormal_pair();
    ellipse(centre, [x * radius, y * radius], sides)
}

/// A line light: the limit of a thin tube between two points with the diameter `width`. The reflected light of thin
/// tubes is proportional to radiance times width.
///
/// Like a tube, the strip faces the shaded point everywhere and is visible from every side. A line that points at the
/// shaded point has no visible area.
///
/// # Errors
/// [`LightError::Length`] for a negative width, [`LightError::NotFinite`].
pub fn line(ends: [DVec3; 2], width: f64) -> Result<PolygonLight, LightError> {
    check_length("the width", width)?;
    let across = ends[0].cross(ends[1]).normalize_or_zero() * (0.5 * width);
    let [a, b] = ends;
    PolygonLight::new(vec![a - across, a + across, b + across, b - across], Sides::Two)
}

pub(super) fn check_length(what: &'static str, value: f64) -> Result<(), LightError> {
    if value.is_finite() && value >= 0.0 { Ok(()) } else { Err(LightError::Length { what, value }) }
}
