//! The borders of lights as seen from the shaded point, and their parts above the surface.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::DVec3;

use crate::shaped::Form;
use ltcforge_fit::math::{atan2, sin_cos};

/// A piece of a light's border.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Piece {
    /// A straight piece from one point to another.
    Straight([DVec3; 2]),
    /// `centre + cos t x + sin t y`, from one `t` to another.
    Arc { centre: DVec3, half_axes: [DVec3; 2], turns: [f64; 2] },
}

impl Piece {
    /// The whole ellipse in quarters, clockwise as seen from the side of `half_axes[0] x half_axes[1]`.
    fn ellipse(centre: DVec3, [x, y]: [DVec3; 2]) -> Vec<Self> {
        let quarter = |i: u32| FRAC_PI_2 * f64::from(i);
        let arc = |i: u32| Self::Arc { centre, half_axes: [x, -y], turns: [quarter(i), quarter(i + 1)] };
        (0..4).map(arc).collect()
    }

    /// The point at `t` in [0, 1], and its derivative.
    pub(super) fn at(&self, t: f64) -> (DVec3, DVec3) {
        match *self {
            Self::Straight([from, to]) => (from + (to - from) * t, to - from),
            Self::Arc { centre, half_axes: [x, y], turns: [from, to] } => {
                let (sin, cos) = sin_cos(from + (to - from) * t);
                (centre + x * cos + y * sin, (y * cos - x * sin) * (to - from))
            }
        }
    }

    pub(super) fn ends(&self) -> [DVec3; 2] {
        match *self {
            Self::Straight(ends) => ends,
            Self::Arc { .. } => [0.0, 1.0].map(|t| self.at(t).0),
        }
    }

    /// The point where [`Self::halves`] meet, up to length.
    pub(super) fn middle(&self) -> DVec3 {
        match self {
            Self::Straight([from, to]) => (*from + *to).normalize_or_zero(),
            Self::Arc { .. } => self.at(0.5).0,
        }
    }

    /// The two halves. The halves of a straight piece between unit vectors have the same length as seen from the
    /// origin.
    pub(super) fn halves(&self) -> [Self; 2] {
        match *self {
            Self::Straight([from, to]) => {
                let middle = self.middle();
                [Self::Straight([from, middle]), Self::Straight([middle, to])]
            }
            Self::Arc { centre, half_axes, turns: [from, to] } => {
                let middle = 0.5 * (from + to);
                [[from, middle], [middle, to]].map(|turns| Self::Arc { centre, half_axes, turns })
            }
        }
    }

    /// The parts above the surface. Straight parts have unit vectors as ends.
    pub(super) fn above_surface(&self) -> Vec<Self> {
        match *self {
            Self::Straight([from, to]) => {
                if from.z <= 0.0 && to.z <= 0.0 {
                    return Vec::new();
                }
                let crossing = || {
                    let crossing = from * to.z.abs() + to * from.z.abs();
                    DVec3::new(crossing.x, crossing.y, 0.0).normalize_or_zero()
                };
                let end = |end: DVec3| if end.z > 0.0 { end.normalize() } else { crossing() };
                vec![Self::Straight([end(from), end(to)])]
            }
            Self::Arc { centre, half_axes: half_axes @ [x, y], turns: [from, to] } => {
                // The height is centre.z + rise cos(t - top).
                let (rise, top) = (x.z.hypot(y.z), atan2(y.z, x.z));
                let mut cuts = vec![from, to];
                if centre.z.abs() < rise {
                    let half = atan2((rise * rise - centre.z * centre.z).sqrt(), -centre.z);
                    let crossings = [top - half, top + half];
                    let around = (-2..=2).flat_map(|turn| crossings.map(|t| t + TAU * f64::from(turn)));
                    cuts.extend(around.filter(|t| (t - from) * (t - to) < 0.0));
                    cuts.sort_by(|a, b| ((a - from) * (to - from)).total_cmp(&((b - from) * (to - from))));
                }
                let part = |pair: &[f64]| Self::Arc { centre, half_axes, turns: [pair[0], pair[1]] };
                cuts.windows(2).map(part).filter(|part| part.at(0.5).0.z > 0.0).collect()
            }
        }
    }
}

/// The border of a polygon.
pub(super) fn of_polygon(vertices: &[DVec3]) -> Vec<Piece> {
    vertices.iter().zip(vertices.iter().cycle().skip(1)).map(|(from, to)| Piece::Straight([*from, *to])).collect()
}

/// The border of the visible part of a light; empty for a line.
pub(super) fn of_shape(form: &Form) -> Vec<Piece> {
    match *form {
        Form::Ellipse { centre, half_axes, .. } => Piece::ellipse(centre, half_axes),
        Form::Sphere { centre, radius } => sphere(centre, radius),
        Form::Tube { ends, radius } => tube(ends, radius),
        Form::Line { .. } => Vec::new(),
    }
}

/// The part of a border above the surface, closed along the horizon.
///
/// A light is convex, so the horizon cuts off one connected part of its border.
pub(super) fn above_surface(border: &[Piece]) -> Vec<Piece> {
    let above: Vec<Piece> = border.iter().flat_map(Piece::above_surface).collect();
    let mut closed = Vec::with_capacity(above.len() + 1);
    for (piece, next) in above.iter().zip(above.iter().cycle().skip(1)) {
        closed.push(*piece);
        let (end, start) = (piece.ends()[1], next.ends()[0]);
        // Only cuts at the horizon leave a gap. Other ends differ only by rounding.
        let flat = |v: DVec3| if v.z == 0.0 { v } else { DVec3::new(v.x, v.y, 0.0).normalize_or_zero() };
        let is_gap = end.normalize().distance(start.normalize()) > 1e-15 && end.z.abs() < 1e-9 * end.length();
        if is_gap {
            closed.push(Piece::Straight([flat(end), flat(start)]));
        }
    }
    closed
}

/// The outline of a sphere: the circle where tangents from the origin touch it.
fn circle_of_sphere(centre: DVec3, radius: f64) -> (DVec3, f64) {
    let sine2 = radius * radius / centre.length_squared();
    (centre * (1.0 - sine2), radius * (1.0 - sine2).max(0.0).sqrt())
}

fn sphere(centre: DVec3, radius: f64) -> Vec<Piece> {
    let (middle, outline_radius) = circle_of_sphere(centre, radius);
    let (x, y) = centre.normalize().any_orthonormal_pair();
    Piece::ellipse(middle, [x * outline_radius, y * outline_radius])
}

/// The outline of a tube: an arc of each end's circle, joined by straight pieces in the planes through the origin that
/// touch both spheres.
///
/// With the distance `d` of the line, the planes have the normals `n = (radius u +- sqrt(d^2 - radius^2) v) / d`. The
/// unit vector `u` points towards the line, and `v` is perpendicular to both. The planes touch a sphere at its centre
/// minus `radius n`. If the origin is within the radius of the extended line, the sphere at the nearer end hides the
/// rest.
fn tube(ends: [DVec3; 2], radius: f64) -> Vec<Piece> {
    let along = ends[1] - ends[0];
    let Some(axis) = along.try_normalize() else { return sphere(ends[0], radius) };
    let beside = ends[0] - axis * ends[0].dot(axis);
    let distance = beside.length();
    if distance <= radius {
        let is_first_nearer = ends[0].length_squared() < ends[1].length_squared();
        return sphere(ends[usize::from(!is_first_nearer)], radius);
    }
    let (u, v) = (beside / distance, axis.cross(beside / distance));
    let side = (distance * distance - radius * radius).sqrt();
    let touched = |end: DVec3, sign: f64| end - (u * radius + v * (sign * side)) * (radius / distance);
    // The arc of an end's circle from the plane on the side of `sign`, around the outer side, to the other plane.
    let arc = |end: DVec3, outwards: DVec3, sign: f64| {
        let (centre, outline_radius) = circle_of_sphere(end, radius);
        let towards = end.normalize();
        let x = (outwards - towards * outwards.dot(towards)).normalize_or_zero();
        // `v` is perpendicular to the end, to the line, and so to `x`.
        let y = v * -sign;
        let from = touched(end, sign) - centre;
        let angle = atan2(from.dot(y), from.dot(x));
        Piece::Arc { centre, half_axes: [x * outline_radius, y * outline_radius], turns: [angle, -angle] }
    };
    let straight = |sign: f64, [from, to]: [DVec3; 2]| Piece::Straight([touched(from, sign), touched(to, sign)]);
    vec![straight(1.0, ends), arc(ends[1], axis, 1.0), straight(-1.0, [ends[1], ends[0]]), arc(ends[0], -axis, -1.0)]
}
