//! Tubes: the outline of a cylinder as seen from a shaded point.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::flat::{ELLIPSE_VERTICES, check_length};
use crate::{LightError, PolygonLight};
use ltcforge_fit::{Sides, math::sin_cos};

/// The ends of a tube.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TubeEnds {
    /// Disks. The tube is a cylinder.
    Flat,
    /// Half spheres around the two points.
    Round,
}

/// The polygon of a tube's outline as seen from a shaded point. The tube has the radius `radius` around the line
/// between `ends`, and the same radiance in every direction. It is visible from every side.
///
/// The outline of a tube is the convex hull of two circles: the rims of a cylinder, or the outlines of the half
/// spheres. So the polygon is the hull of points on both circles: [`ELLIPSE_VERTICES`] on each, and the points where
/// the straight sides touch them. The sides are exact. The outlines of the ends are inside of the circles by up to 0.5
/// % of the radius. A tube of zero length with round ends is a sphere.
///
/// # Errors
/// [`LightError::Inside`] for a shaded point in the tube, [`LightError::Length`] for a negative radius,
/// [`LightError::NotFinite`].
pub fn tube(ends: [DVec3; 2], radius: f64, shape: TubeEnds) -> Result<PolygonLight, LightError> {
    check_length("the radius", radius)?;
    if let Some(index) = ends.iter().position(|end| !end.is_finite()) {
        return Err(LightError::NotFinite { index });
    }
    let axis = (ends[1] - ends[0]).normalize_or_zero();
    if shape == TubeEnds::Flat && axis == DVec3::ZERO {
        return Err(LightError::Length { what: "the length of a tube with flat ends", value: 0.0 });
    }
    let nearest = nearest_point(ends, radius, shape).ok_or(LightError::Inside)?;
    let points: Vec<DVec3> = match shape {
        TubeEnds::Flat => ends.iter().flat_map(|end| rim(*end, axis, radius)).collect(),
        TubeEnds::Round => ends.iter().flat_map(|end| horizon_of_sphere(*end, axis, radius)).collect(),
    };
    let mut outline = hull(&points, nearest);
    // A tube of radius zero is a line and has no visible area.
    outline.resize(outline.len().max(3), points[0]);
    PolygonLight::new(outline, Sides::Two)
}

/// The point of a tube nearest to the shaded point; `None` if the shaded point is inside or on the tube. The whole tube
/// is beyond the plane through this point, so a projection on this plane shows all of it.
fn nearest_point(ends: [DVec3; 2], radius: f64, shape: TubeEnds) -> Option<DVec3> {
    let along = ends[1] - ends[0];
    let axis = along.normalize_or_zero();
    let foot = ends[0] + axis * (-ends[0]).dot(axis).clamp(0.0, along.length());
    let nearest = match shape {
        TubeEnds::Round => foot * (1.0 - radius / foot.length()),
        TubeEnds::Flat => {
            let radial = -foot + axis * foot.dot(axis);
            foot + radial.normalize_or_zero() * radial.length().min(radius)
        }
    };
    let is_outside = match shape {
        TubeEnds::Round => foot.length() > radius,
        TubeEnds::Flat => nearest.length() > 1e-12 * foot.length(),
    };
    is_outside.then_some(nearest)
}

/// Points of the circle around `centre` with unit normal `axis`. They include the points where planes through the
/// origin parallel to `axis` touch it, if there are any.
fn rim(centre: DVec3, axis: DVec3, radius: f64) -> Vec<DVec3> {
    let (x, y) = axis.any_orthonormal_pair();
    // The origin relative to the axis, in the plane of the circle. Tangents from the origin touch at the angle
    // acos(radius / distance).
    let beside = DVec2::new(-centre.dot(x), -centre.dot(y));
    circle(centre, [x, y], radius, beside)
}

/// Points of the outline of a sphere. They include the points where planes through the origin parallel to `axis` touch
/// it.
fn horizon_of_sphere(centre: DVec3, axis: DVec3, radius: f64) -> Vec<DVec3> {
    let distance2 = centre.length_squared();
    // The circle where tangents from the origin touch the sphere.
    let nearer = radius * radius / distance2;
    let (outline_centre, outline_radius) = (centre * (1.0 - nearer), radius * (1.0 - nearer).sqrt());
    let towards = centre.normalize();
    let x = towards.cross(axis).try_normalize().unwrap_or_else(|| towards.any_orthonormal_vector());
    let y = towards.cross(x);
    let mut points = circle(outline_centre, [x, y], outline_radius, DVec2::ZERO);
    // A plane with unit normal n, perpendicular to the axis, with n . centre = radius touches at centre - radius n. If
    // the centre is at distance d from the axis along u, n = (radius u +- sqrt(d^2 - radius^2) v) / d.
    let beside = centre - axis * centre.dot(axis);
    let distance = beside.length();
    if axis != DVec3::ZERO && distance > radius {
        let u = beside / distance;
        let v = axis.cross(u);
        let side = (distance * distance - radius * radius).sqrt();
        points.extend([1.0, -1.0].map(|sign| centre - (u * radius + v * (sign * side)) * (radius / distance)));
    }
    points
}

/// Points of a circle, and the points where tangents from the point `from` of its plane touch it.
fn circle(centre: DVec3, [x, y]: [DVec3; 2], radius: f64, from: DVec2) -> Vec<DVec3> {
    let place = |angle: f64| {
        let (sin, cos) = sin_cos(angle);
        centre + (x * cos + y * sin) * radius
    };
    let around = (0..ELLIPSE_VERTICES).map(|i| place(TAU * f64::from(i) / f64::from(ELLIPSE_VERTICES)));
    let mut points: Vec<DVec3> = around.collect();
    let distance = from.length();
    if distance > radius {
        let towards = from / distance;
        let (cos, sin) = (radius / distance, (1.0 - (radius / distance).powi(2)).sqrt());
        points.extend([sin, -sin].map(|sin| {
            let at = towards * cos + towards.perp() * sin;
            centre + (x * at.x + y * at.y) * radius
        }));
    }
    points
}

/// The convex hull of directions, clockwise as seen from the origin. All directions are less than a right angle from
/// `axis`. Computed by Andrew's monotone chain in the plane perpendicular to `axis`.
fn hull(points: &[DVec3], axis: DVec3) -> Vec<DVec3> {
    let axis = axis.normalize();
    let (x, y) = axis.any_orthonormal_pair();
    let mut flat: Vec<(DVec2, DVec3)> =
        points.iter().map(|p| (DVec2::new(p.dot(x), p.dot(y)) / p.dot(axis), *p)).collect();
    flat.sort_by(|(a, _), (b, _)| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let chain = |points: &mut dyn Iterator<Item = (DVec2, DVec3)>| {
        let mut chain_points: Vec<(DVec2, DVec3)> = Vec::new();
        for point in points {
            while let [.., (a, _), (b, _)] = chain_points[..]
                && (b - a).perp_dot(point.0 - b) >= 0.0
            {
                chain_points.pop();
            }
            chain_points.push(point);
        }
        chain_points.pop();
        chain_points
    };
    let upper = chain(&mut flat.iter().copied());
    let lower = chain(&mut flat.iter().rev().copied());
    upper.into_iter().chain(lower).map(|(_, point)| point).collect()
}
