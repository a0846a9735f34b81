//! The integral of a distribution over a polygon, in closed form.
//!
//! Seen from the origin, a polygon's edges are arcs of great circles. The integral of the clamped cosine over the
//! polygon is the z of its vector form factor, `1/(2 pi) sum acos(a . b) (a x b).z / |a x b|` over its edges from `a`
//! to `b` on the unit sphere, once the part below the horizon is cut off [Lambert 1760; Heitz, Dupuy, Hill, Neubelt
//! 2016, equation 11].
//!
//! For a small polygon the terms `(a x b).z` cancel: each is of the size of an edge, their sum is of the size of the
//! area. Around a closed outline the terms `((a - o) x (b - o)).z` have the same sum for any `o`. With `o` on the
//! polygon, they are as small as their sum. So an edge adds this term, and `(a x b).z (acos(a . b) / |a x b| - 1)` for
//! its bend.
//!
//! A convex polygon crosses the horizon at most twice. So edges can be cut and added one after another, and one arc
//! along the horizon closes the outline. No list of clipped vertices is made.

use glam::DVec3;

use super::{
    Ltc,
    cone::{Cone, Horizon, Turn},
};
use crate::math::{Scalar, cross, dot, minus, unit};

/// Most vertices of a light in the shaders. A light that is cut at the horizon has one more.
pub const MAX_VERTICES: usize = 8;

/// The sides from which a polygon can be seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sides {
    /// Only the side from which the vertices run clockwise.
    One,
    /// Both sides.
    Two,
}

/// The integral of the clamped cosine over a convex polygon, added up edge by edge.
#[derive(Debug, Clone, Copy)]
pub struct Clip<T> {
    /// Twice pi times the integral so far.
    sum: T,
    /// A vertex on the unit sphere.
    origin: [T; 3],
    previous: [T; 3],
    /// `previous` on the unit sphere.
    previous_unit: [T; 3],
    /// Where the outline dips below the horizon and where it comes back, on the unit circle.
    leaves: [T; 3],
    enters: [T; 3],
}

impl<T: Scalar> Clip<T> {
    /// Begins at a vertex: [`Clip::edge_to`] is then called for each of the others in turn, and for this one last.
    #[must_use]
    pub fn begin(vertex: [T; 3]) -> Self {
        let (origin, nowhere) = (unit(vertex), [T::ZERO; 3]);
        Self { sum: T::ZERO, origin, previous: vertex, previous_unit: origin, leaves: nowhere, enters: nowhere }
    }

    /// Adds the part of the edge to the next vertex that lies above the horizon.
    pub fn edge_to(&mut self, vertex: [T; 3]) {
        let (a, b) = (self.previous, vertex);
        let (a_unit, b_unit) = (self.previous_unit, unit(vertex));
        let (a_is_up, b_is_up) = (a[2] > T::ZERO, b[2] > T::ZERO);
        if a_is_up && b_is_up {
            self.sum = self.sum + self.arc(a_unit, b_unit);
        } else if a_is_up {
            self.leaves = unit([b[0] * a[2] - a[0] * b[2], b[1] * a[2] - a[1] * b[2], T::ZERO]);
            self.sum = self.sum + self.arc(a_unit, self.leaves);
        } else if b_is_up {
            self.enters = unit([a[0] * b[2] - b[0] * a[2], a[1] * b[2] - b[1] * a[2], T::ZERO]);
            self.sum = self.sum + self.arc(self.enters, b_unit);
        }
        (self.previous, self.previous_unit) = (b, b_unit);
    }

    /// Adds the part above the horizon of a cone's border, anticlockwise from the place of the last vertex to that of the next.
    pub(super) fn border_to(&mut self, cone: &Cone<T>, vertex: [T; 3]) {
        let (from, to) = (cone.turn_of(self.previous), cone.turn_of(vertex));
        let (from_is_up, to_is_up) = (self.previous[2] > T::ZERO, vertex[2] > T::ZERO);
        match cone.horizon() {
            Horizon::Cuts { top, half_arc: [cos, sin] } => {
                let rise = [top[0] * cos + top[1] * sin, top[1] * cos - top[0] * sin];
                let dip = [top[0] * cos - top[1] * sin, top[1] * cos + top[0] * sin];
                let reaches = |crossing| round(from, crossing) < round(from, to);
                let (leaves, enters) = match (from_is_up, to_is_up) {
                    (true, true) | (false, false) => (reaches(dip), reaches(rise)),
                    (true, false) => (true, false),
                    (false, true) => (false, true),
                };
                // A border that does both begins above and dips, or rises and dips again.
                if leaves {
                    self.leaves = unit(cone.direction(dip));
                }
                if enters {
                    self.enters = unit(cone.direction(rise));
                }
                match (leaves, enters) {
                    (false, false) if !from_is_up => {}
                    (true, true) if from_is_up => {
                        self.border(cone, from, dip);
                        self.border(cone, rise, to);
                    }
                    _ => self.border(cone, if enters { rise } else { from }, if leaves { dip } else { to }),
                }
            }
            Horizon::Above => self.border(cone, from, to),
            Horizon::Below => {}
        }
        (self.previous, self.previous_unit) = (vertex, unit(vertex));
    }

    /// Adds a part of a cone's border, in place of the chord between its ends: with `o` as in [`Clip::arc`].
    fn border(&mut self, cone: &Cone<T>, from: Turn<T>, to: Turn<T>) {
        let [p, q] = [from, to].map(|turn| unit(cone.direction(turn)));
        let moved = cross(minus(p, self.origin), minus(q, self.origin))[2] - cross(p, q)[2];
        self.sum = self.sum + cone.border(from, to) + moved;
    }

    /// The integral, in [-1, 1]; negative when the vertices, seen from the origin, run anticlockwise.
    #[must_use]
    pub fn finish(self) -> T {
        // Without a crossing both are the zero vector.
        let is_cut = self.leaves != self.enters;
        let closing = if is_cut { self.arc(self.leaves, self.enters) } else { T::ZERO };
        (self.sum + closing) / T::TAU
    }

    /// An edge's part of the sum. Its angle comes from sine and cosine, which is accurate for every length of arc;
    /// `acos` is not.
    fn arc(&self, a: [T; 3], b: [T; 3]) -> T {
        let c = cross(a, b);
        let sin = dot(c, c).sqrt();
        let bend = if sin > T::SHORTEST { T::atan2_upper(sin, dot(a, b)) / sin - T::ONE } else { T::ZERO };
        cross(minus(a, self.origin), minus(b, self.origin))[2] + c[2] * bend
    }
}

/// A number that grows with the angle from one turn anticlockwise to another, from 0 to 4.
fn round<T: Scalar>(from: Turn<T>, to: Turn<T>) -> T {
    let cos = from[0] * to[0] + from[1] * to[1];
    let sin = from[0] * to[1] - from[1] * to[0];
    if sin < T::ZERO { T::of(3.0) + cos } else { T::ONE - cos }
}

impl Ltc {
    /// The part of the distribution that a convex polygon covers, seen from the origin: in [0, 1].
    ///
    /// `I(P) = I_cosine(M^-1 P)` [Heitz 2016, section 3]. Zero for fewer than three vertices. Domain: finite vertices.
    #[must_use]
    pub fn polygon(&self, vertices: &[DVec3], sides: Sides) -> f64 {
        let inverse = self.inverse();
        // A matrix that mirrors reverses the polygon's winding.
        let side = if inverse.determinant() < 0.0 { -1.0 } else { 1.0 };
        let Some(last) = vertices.last() else { return 0.0 };
        let mut clip = Clip::begin((inverse * *last).to_array());
        for vertex in vertices {
            clip.edge_to((inverse * *vertex).to_array());
        }
        let covered = match sides {
            Sides::One => side * clip.finish(),
            Sides::Two => clip.finish().abs(),
        };
        covered.clamp(0.0, 1.0)
    }

    /// The vector form factor of a convex polygon in cosine space, without a horizon, towards the polygon: of the length
    /// `sin^2 sigma` of a cap of half angle sigma. What the horizon leaves of it, [`super::clipped_form_factor`] guesses by
    /// the sphere of the same vector form factor [Hill and Heitz 2016].
    ///
    /// Zero for fewer than three vertices. Domain: finite vertices; a polygon that the origin does not lie in.
    #[must_use]
    pub fn vector_form_factor(&self, vertices: &[DVec3]) -> DVec3 {
        let corners: Vec<DVec3> = vertices.iter().map(|v| (self.inverse() * *v).normalize_or_zero()).collect();
        let next = corners.iter().cycle().skip(1);
        let edge = |(a, b): (&DVec3, &DVec3)| {
            let across = a.cross(*b);
            let sin = across.length();
            if sin > 0.0 { across * (f64::atan2_upper(sin, a.dot(*b)) / sin) } else { DVec3::ZERO }
        };
        let flux = corners.iter().zip(next).map(edge).sum::<DVec3>() / std::f64::consts::TAU;
        if flux.dot(corners.iter().sum()) < 0.0 { -flux } else { flux }
    }
}

#[cfg(any(test, feature = "testing"))]
pub mod quadrature;
#[cfg(test)]
mod tests;
