//! The integral of a distribution over lights other than polygons: ellipses, spheres, lines and tubes.
//!
//! Each integral is the integral of the clamped cosine over the light transformed by `M^-1`, seen from the origin. An
//! ellipse and the outline of a sphere become cones over ellipses, see [`Cone`]. A line stays a line. The outline of a
//! tube becomes two arcs of cones over ellipses, and two straight edges.

#![allow(clippy::neg_cmp_op_on_partial_ord, reason = "NaN counts as what the comparison denies")]

use super::cone::Cone;
use ltcforge_fit::{
    Clip, Ltc, Sides,
    math::{Scalar, Triple, cross, dot, minus, plus, scaled, unit},
};

/// The linear map to the space where a distribution is the clamped cosine.
#[derive(Debug, Clone, Copy)]
pub struct CosineSpace<T> {
    pub(super) rows: [Triple<T>; 3],
    pub(super) determinant: T,
}

impl<T: Scalar> CosineSpace<T> {
    /// The map with the rows of `M^-1`, up to a positive factor.
    #[must_use]
    pub fn new(rows: [Triple<T>; 3]) -> Self {
        Self { rows, determinant: dot(rows[2], cross(rows[0], rows[1])) }
    }

    /// Like [`Self::new`], with the determinant from the caller.
    pub(super) fn with_determinant(rows: [Triple<T>; 3], determinant: T) -> Self {
        Self { rows, determinant }
    }

    /// The rows of `M^-1`, up to a positive factor.
    #[must_use]
    pub fn rows(&self) -> [Triple<T>; 3] {
        self.rows
    }

    /// The determinant of [`Self::rows`].
    #[must_use]
    pub fn determinant(&self) -> T {
        self.determinant
    }

    /// Maps a vector to the space of the clamped cosine.
    #[must_use]
    pub fn of(&self, v: Triple<T>) -> Triple<T> {
        self.rows.map(|row| dot(row, v))
    }

    /// The part of the distribution over a convex polygon, in [0, 1]. Zero for fewer than three vertices.
    #[must_use]
    pub fn polygon<V: Copy + Into<Triple<T>>>(&self, vertices: &[V], sides: Sides) -> T {
        let Some(last) = vertices.last() else { return T::ZERO };
        let mut clip = Clip::begin(self.of((*last).into()));
        for vertex in vertices {
            clip.edge_to(self.of((*vertex).into()));
        }
        let sum = clip.finish();
        // A matrix with a negative determinant reverses the polygon's winding.
        let lit = if self.determinant < T::ZERO { -sum } else { sum };
        let covered = if sides == Sides::Two { sum.abs() } else { lit };
        covered.max(T::ZERO).min(T::ONE)
    }

    /// The part of the distribution over the ellipse `centre + cos t x + sin t y`, for any two half axes. The lit side
    /// is the side of `x cross y`.
    #[must_use]
    pub fn ellipse<V: Into<Triple<T>>>(&self, centre: V, half_axes: [V; 2], sides: Sides) -> T {
        let (centre, half_axes) = (centre.into(), half_axes.map(V::into));
        // The origin is on the lit side if the ellipse's normal points towards the origin.
        if sides == Sides::One && !(dot(centre, cross(half_axes[0], half_axes[1])) < T::ZERO) {
            return T::ZERO;
        }
        self.cone(centre, half_axes).map_or(T::ZERO, |cone| cone.covered())
    }

    pub(super) fn cone(&self, centre: Triple<T>, half_axes: [Triple<T>; 2]) -> Option<Cone<T>> {
        Cone::new(self.of(centre), half_axes.map(|axis| self.of(axis)))
    }

    /// The part of the distribution over a sphere; 1 if the origin is inside of the sphere.
    #[must_use]
    pub fn sphere(&self, centre: impl Into<Triple<T>>, radius: T) -> T {
        let centre = centre.into();
        if dot(centre, centre) <= radius * radius {
            return T::ONE;
        }
        self.outline(centre, radius).map_or(T::ZERO, |cone| cone.covered())
    }

    /// The cone of a sphere. Domain: the origin is outside of the sphere.
    fn outline(&self, centre: Triple<T>, radius: T) -> Option<Cone<T>> {
        let (centre, half_axes) = Self::disk_of_sphere(centre, radius);
        self.cone(centre, half_axes)
    }

    /// The centre and half axes of the disk with the outline of a sphere, up to a factor. The disk faces the origin.
    /// Domain: the origin is outside of the sphere.
    pub(super) fn disk_of_sphere(centre: Triple<T>, radius: T) -> (Triple<T>, [Triple<T>; 2]) {
        let towards = unit(centre);
        let sine2 = radius * radius / dot(centre, centre);
        let (x, y) = basis(towards);
        let half_axes = [x, y].map(|axis| scaled(axis, sine2.sqrt()));
        (scaled(towards, (T::ONE - sine2).max(T::ZERO).sqrt()), half_axes)
    }

    /// The part of the distribution over a line, in the limit of a small width. The line faces the origin everywhere,
    /// and the result is proportional to its width.
    ///
    /// The strip around `p(s)` with the half width `h`, perpendicular to the line and the view, becomes the strip
    /// around `M^-1 p(s)` with the half width `M^-1 h`. Its integral is `2/pi` times `M^-1 h . (p x dp/ds)`, which is
    /// constant along the line, times the integral of `max(p_z, 0) / |p|^4 ds` [Heitz and Hill 2017]. Let `u` be the
    /// angle from the line's point nearest to the origin, which has the distance `d` and the direction `o`, and let `t`
    /// be the line's direction. The integrand is then `(o_z cos u + t_z sin u) cos u / d^2 du`, over the angles above
    /// the horizon, `u_0` to `u_1`:
    ///
    /// ```text
    /// 1 / (2 d^2) (o_z D + (o_z cos S + t_z sin S) sin D),    D = u_1 - u_0,  S = u_0 + u_1
    /// ```
    #[must_use]
    pub fn line<V: Into<Triple<T>>>(&self, ends: [V; 2], width: T) -> T {
        let [a, b] = ends.map(V::into);
        // For a line that points at the origin, normal and distance are rounding errors. These errors cancel if normal
        // and distance are computed from the difference of the ends, and if both ends use the same values.
        let (middle, along) = (scaled(plus(a, b), T::of(0.5)), minus(b, a));
        let lit = cross(middle, along);
        let (mut p, mut q) = (self.of(a), self.of(b));
        let along = self.of(along);
        let normal = cross(self.of(middle), along);
        let area2 = dot(normal, normal);
        let length = dot(along, along).sqrt();
        let factor = (dot(lit, lit).sqrt() * self.determinant).abs() * length / area2.max(T::SHORTEST * T::SHORTEST);
        if !(area2 > T::SHORTEST * T::SHORTEST) || (p[2] <= T::ZERO && q[2] <= T::ZERO) {
            return T::ZERO;
        }
        let t = scaled(along, T::ONE / length);
        let o = cross(t, scaled(normal, T::ONE / area2.sqrt()));
        // The part below the horizon is cut off.
        let crossing = || scaled(minus(scaled(p, q[2]), scaled(q, p[2])), T::ONE / (q[2] - p[2]));
        if p[2] < T::ZERO {
            p = crossing();
        } else if q[2] < T::ZERO {
            q = crossing();
        }
        let distance = area2.sqrt() / length;
        let [[cos_0, sin_0], [cos_1, sin_1]] = [p, q].map(|end| unit2([distance, dot(end, t)]));
        let turn = [cos_0 * cos_1 + sin_0 * sin_1, cos_0 * sin_1 - sin_0 * cos_1];
        let angle = T::atan2_upper(turn[1].abs(), turn[0]);
        let cos_sum = cos_0 * cos_1 - sin_0 * sin_1;
        let sin_sum = sin_0 * cos_1 + cos_0 * sin_1;
        let integral = o[2] * angle + (o[2] * cos_sum + t[2] * sin_sum) * turn[1].abs();
        (width * factor * integral / T::TAU).max(T::ZERO).min(T::ONE)
    }

    /// The part of the distribution over a tube with round ends; 1 if the origin is inside of the tube. The tube
    /// contains all points up to `radius` from the line between `ends`.
    ///
    /// The outline of this tube consists of arcs of two spheres and of edges in the two planes that touch both spheres.
    /// If the origin is within the radius of the extended line, the sphere at the nearer end hides the rest.
    #[must_use]
    pub fn tube<V: Into<Triple<T>>>(&self, ends: [V; 2], radius: T) -> T {
        let ends = ends.map(V::into);
        let [[first_right, first_left], [second_right, second_left]] = match self.edges_of_tube(ends, radius) {
            Ok(touched) => touched.map(|end| end.map(|point| self.of(point))),
            Err(nearest) => return self.sphere(nearest, radius),
        };
        let (Some(first), Some(second)) = (self.outline(ends[0], radius), self.outline(ends[1], radius)) else {
            return T::ZERO;
        };
        let mut clip = Clip::begin(first_right);
        clip.edge_to(second_right);
        second.add_border(&mut clip, second_left);
        clip.edge_to(first_left);
        first.add_border(&mut clip, first_right);
        clip.finish().max(T::ZERO).min(T::ONE)
    }

    /// The points where the two planes through the origin touch the spheres of a tube, right and left for each end.
    /// Returns an error with the centre of a sphere if this sphere hides the rest or contains the origin.
    pub(super) fn edges_of_tube(&self, ends: [Triple<T>; 2], radius: T) -> Result<[[Triple<T>; 2]; 2], Triple<T>> {
        let along = minus(ends[1], ends[0]);
        let length = dot(along, along).sqrt();
        let axis = unit(along);
        let foot = (-dot(ends[0], axis)).max(T::ZERO).min(length);
        let nearest = plus(ends[0], scaled(axis, foot));
        let beside = minus(ends[0], scaled(axis, dot(ends[0], axis)));
        let distance2 = dot(beside, beside);
        if dot(nearest, nearest) <= radius * radius || !(length > T::ZERO) || distance2 <= radius * radius {
            return Err(nearest);
        }
        // The planes with unit normals (r u +- sqrt(d^2 - r^2) v) / d touch the spheres. u is the unit vector from the
        // origin to the line, at distance d, and v is perpendicular to both.
        let towards = scaled(beside, radius / distance2);
        let sideways = scaled(cross(axis, beside), (distance2 - radius * radius).sqrt() / distance2);
        let sideways = if self.determinant < T::ZERO { scaled(sideways, -T::ONE) } else { sideways };
        let touched = |end: Triple<T>, normal: Triple<T>| minus(end, scaled(normal, radius));
        let (left, right) = (plus(towards, sideways), minus(towards, sideways));
        Ok(ends.map(|end| [touched(end, right), touched(end, left)]))
    }
}

/// The unit vector of a vector.
fn unit2<T: Scalar>([x, y]: [T; 2]) -> [T; 2] {
    let length = (x * x + y * y).sqrt().max(T::SHORTEST);
    [x / length, y / length]
}

/// Two unit vectors perpendicular to `n` and each other.
fn basis<T: Scalar>(n: Triple<T>) -> (Triple<T>, Triple<T>) {
    let is_upright = n[2].abs() > T::of(0.7);
    let axis = if is_upright { [T::ONE, T::ZERO, T::ZERO] } else { [T::ZERO, T::ZERO, T::ONE] };
    let x = unit(cross(axis, n));
    (x, cross(n, x))
}

/// The map of a distribution to the space of the clamped cosine.
impl From<&Ltc> for CosineSpace<f64> {
    fn from(ltc: &Ltc) -> Self {
        Self::new(ltc.inverse().transpose().to_cols_array_2d())
    }
}

#[cfg(test)]
mod tests;
