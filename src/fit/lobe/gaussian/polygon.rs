//! The integral of a Gaussian over a polygon.

use super::SphericalGaussian;
use crate::{
    lobe::ltc::Sides,
    math::{Scalar, Triple, cross, dot, minus, plus, scaled},
};

/// Each edge has two extra points, at this distance in deviations before and after its foot (the point closest to the
/// centre). Of the distances from 0.5 to 1.2, this one has the smallest error for random lights. With more points, the
/// result would be closer to the Gaussian but farther from GGX's lobe, which has longer tails.
const BESIDE_FOOT: f64 = 0.7;
/// Limits of the squared cosine between the axis and an edge's foot. Below the first limit, the edge's midpoint
/// replaces its foot. Between the limits, midpoint and foot are blended.
const FAR: [f64; 2] = [0.005, 0.02];
/// An end of an edge counts as fully behind the axis if the cosine of its angle to the axis is below minus this value.
const BEHIND: f64 = 0.25;

/// Half of the error function, from -1/2 to 1/2, within 2.5e-4 [Abramowitz and Stegun 1964, 7.1.27].
fn half_erf<T: Scalar>(x: T) -> T {
    let z = x.abs().min(T::of(8.0));
    let p = (((T::of(0.078_108) * z + T::of(0.000_972)) * z + T::of(0.230_389)) * z + T::of(0.278_393)) * z + T::ONE;
    let p2 = p * p;
    let half = T::of(0.5) - T::of(0.5) / (p2 * p2);
    if x < T::ZERO { -half } else { half }
}

/// The integral of a Gaussian of weight one over a convex polygon, in [0, 1].
///
/// `(x, y) -> (erf x, erf y) / 2` maps the plane to a square of area one, and `exp(-x^2 - y^2) / pi dx dy` to the area
/// of the square. The result is the area of the polygon's image. Each edge is approximated by straight lines between
/// its ends and two points around its foot, the point closest to the centre. Points far from the centre are mapped to
/// the sides and corners of the square. In the limit of a mirror, the result is therefore exactly 1 or 0.
#[must_use]
pub fn covered<T: Scalar>(lobe: &SphericalGaussian<T>, vertices: &[Triple<T>], sides: Sides) -> T {
    let Some(last) = vertices.last() else { return T::ZERO };
    if sides == Sides::One && is_anticlockwise(vertices) {
        return T::ZERO;
    }
    let square = Square { lobe, origin: lobe.at(*last).map(half_erf) };
    let mut before = square.projected(*last);
    let mut cut = None;
    let mut area = T::ZERO;
    for vertex in vertices {
        let now = square.projected(*vertex);
        if before.w[2] > T::ZERO || now.w[2] > T::ZERO {
            let (mut from, mut to) = (before, now);
            let (enters, leaves) = cut.unwrap_or((now, now));
            if before.w[2] <= T::ZERO {
                from = square.projected(crossing(before.w, now.w));
                cut = Some((from, leaves));
            }
            if now.w[2] <= T::ZERO {
                to = square.projected(crossing(before.w, now.w));
                cut = Some((enters, to));
            }
            area = area + square.under(from, to);
        }
        before = now;
    }
    if let Some((enters, leaves)) = cut {
        area = area + square.under(leaves, enters);
    }
    area.abs().min(T::ONE)
}

/// True if the vertices of a polygon run anticlockwise as seen from the origin.
fn is_anticlockwise<T: Scalar>(vertices: &[Triple<T>]) -> bool {
    let Some(start) = vertices.first() else { return false };
    let normal = vertices
        .windows(2)
        .fold([T::ZERO; 3], |sum, edge| plus(sum, cross(minus(edge[0], *start), minus(edge[1], *start))));
    dot(normal, *start) < T::ZERO
}

/// The direction in which an edge crosses the horizon. Domain: one vertex is above the horizon, the other is not.
fn crossing<T: Scalar>(a: Triple<T>, b: Triple<T>) -> Triple<T> {
    let (from, to) = (b[2].abs(), a[2].abs());
    [a[0] * from + b[0] * to, a[1] * from + b[1] * to, T::ZERO]
}

/// The square to which the error function maps a Gaussian's plane.
struct Square<'a, T> {
    lobe: &'a SphericalGaussian<T>,
    /// A point near the outline. Areas are computed relative to this point, so they lose no digits.
    origin: [T; 2],
}

/// A direction of any length, and its image relative to the origin.
#[derive(Clone, Copy)]
struct Projected<T> {
    w: Triple<T>,
    image: [T; 2],
}

impl<T: Scalar> Square<'_, T> {
    fn projected(&self, w: Triple<T>) -> Projected<T> {
        let [x, y] = self.lobe.at(w).map(half_erf);
        Projected { w, image: [x - self.origin[0], y - self.origin[1]] }
    }

    /// The area between the origin and the image of an edge.
    fn under(&self, from: Projected<T>, to: Projected<T>) -> T {
        let beside = around_foot(self.lobe, from.w, to.w)
            .map(|t| self.projected(plus(from.w, scaled(minus(to.w, from.w), t))).image);
        let area = |a: [T; 2], b: [T; 2]| a[0] * b[1] - a[1] * b[0];
        T::of(0.5) * (area(from.image, beside[0]) + area(beside[0], beside[1]) + area(beside[1], to.image))
    }
}

/// 1 if an edge's foot is so far from the axis that its position is uncertain, 0 if the position is certain, and a
/// blend in between; see [`FAR`].
fn is_far<T: Scalar>(lobe: &SphericalGaussian<T>, from: Triple<T>, to: Triple<T>) -> T {
    let normal = cross(from, to);
    let (height, normal2) = (dot(normal, lobe.axis), dot(normal, normal).max(T::of(1e-36)));
    let far = (T::of(FAR[1]) - (T::ONE - height * height / normal2)) / T::of(FAR[1] - FAR[0]);
    far.max(T::ZERO).min(T::ONE)
}

/// The positions on an edge, from 0 to 1 and in order, of the points [`BESIDE_FOOT`] deviations before and after its
/// foot. They are clamped to the ends of the edge.
///
/// In the central projection around the axis an edge is straight. Let `(x, y, z)` be the products of a direction with
/// the rows and the axis. The edge runs along `e`, which is perpendicular to the first two numbers of `a x b`. It is
/// `s` deviations beyond its foot where `e . (x, y) = s z`.
///
/// - An edge with one end behind the axis turns by up to half a turn around the axis, mostly far away. Its two points
///   are the foot and the point at which it passes the axis. Between neighbouring points, the edge then turns by a
///   quarter turn at most, and the straight line between their images stays on the same side of the centre as the edge.
///   If an end is behind the axis by less than [`BEHIND`], both kinds of points are blended.
/// - The foot can be at a right angle to the axis, where its position depends on rounding. The midpoint of the edge
///   replaces such a foot.
fn around_foot<T: Scalar>(lobe: &SphericalGaussian<T>, from: Triple<T>, to: Triple<T>) -> [T; 2] {
    let coordinates = |w: Triple<T>| [dot(w, lobe.rows[0]), dot(w, lobe.rows[1]), dot(w, lobe.axis)];
    let (a, b) = (coordinates(from), coordinates(to));
    let line = cross(a, b);
    let length = (line[0] * line[0] + line[1] * line[1]).sqrt().max(T::of(1e-30));
    let along = |w: Triple<T>| (line[1] * w[0] - line[0] * w[1]) / length;
    let (start, end) = (along(a), along(b));
    let beyond_foot = |s: T| {
        let change = (end - start) - s * (b[2] - a[2]);
        let part = if change.abs() < T::of(1e-30) { T::of(0.5) } else { (s * a[2] - start) / change };
        part.max(T::ZERO).min(T::ONE)
    };
    let mixed = |from: T, to: T, share: T| from + (to - from) * share;
    let far = is_far(lobe, from, to);
    let [from, to] = [from, to].map(|w| dot(w, w).sqrt().max(T::of(1e-36)));
    let middle = from / (from + to);
    let beside = T::of(BESIDE_FOOT);
    let mut parts = [beyond_foot(-beside), beyond_foot(beside)];
    if (a[2] > T::ZERO) != (b[2] > T::ZERO) {
        let behind = -(a[2] / from).min(b[2] / to) / T::of(BEHIND);
        let behind = behind.min(T::ONE);
        let (foot, passing) = (beyond_foot(T::ZERO), a[2] / (a[2] - b[2]));
        // Of the two points, the foot is closer to the end in front of the axis.
        let [first, second] = if a[2] > T::ZERO { [foot, passing] } else { [passing, foot] };
        parts = [mixed(parts[0], first, behind), mixed(parts[1], second, behind)];
    }
    let [t, u] = parts.map(|part| mixed(part, middle, far));
    if t <= u { [t, u] } else { [u, t] }
}

#[cfg(test)]
mod tests {
    use super::half_erf;

    #[test]
    fn half_the_error_function_is_within_its_bound() {
        for i in -500..=500_i32 {
            let x = f64::from(i) / 100.0;
            assert!((half_erf(x) - 0.5 * libm::erf(x)).abs() < 2.6e-4, "{x}");
            assert!(half_erf(x) <= half_erf(x + 1e-3));
        }
    }
}
