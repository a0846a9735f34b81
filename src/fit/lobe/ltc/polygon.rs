//! The integral of a distribution over a polygon, in closed form.
//!
//! Seen from the origin, a polygon's edges are arcs of great circles. The integral of the clamped cosine over the
//! polygon is the z of its vector form factor, `1/(2 pi) sum acos(a . b) (a x b).z / |a x b|` over its edges from `a`
//! to `b` on the unit sphere. The part below the horizon is cut off first [Lambert 1760; Heitz, Dupuy, Hill, Neubelt
//! 2016, equation 11].
//!
//! For a small polygon the terms `(a x b).z` cancel: each term is as large as an edge, but their sum is as small as the
//! area. Around a closed outline the terms `((a - o) x (b - o)).z` have the same sum for any `o`. With `o` on the
//! polygon, they are as small as their sum. Each edge therefore adds this term, plus
//! `(a x b).z (acos(a . b) / |a x b| - 1)` for its curvature.
//!
//! A convex polygon crosses the horizon at most twice. Edges can therefore be cut and added one after another, and one
//! arc along the horizon closes the outline. No list of clipped vertices is needed.

use glam::DVec3;

use super::Ltc;
use crate::math::{Scalar, cross, dot, minus, unit};

/// The largest number of vertices of a light in the shaders. A light cut at the horizon can have one more vertex.
pub const MAX_VERTICES: usize = 8;

/// The sides from which a polygon is visible.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sides {
    /// Only the side from which the vertices run clockwise.
    One,
    /// Both sides.
    Two,
}

/// The integral of the clamped cosine over a convex polygon, accumulated edge by edge.
#[derive(Debug, Clone, Copy)]
pub struct Clip<T> {
    /// Twice pi times the integral so far.
    sum: T,
    /// A vertex on the unit sphere.
    origin: [T; 3],
    previous: [T; 3],
    /// `previous` on the unit sphere.
    previous_unit: [T; 3],
    /// The points where the outline crosses the horizon downwards and upwards, on the unit circle.
    leaves: [T; 3],
    enters: [T; 3],
}

impl<T: Scalar> Clip<T> {
    /// Begins at a vertex. Call [`Clip::edge_to`] for each other vertex in turn, and for this vertex last.
    #[must_use]
    pub fn begin(vertex: [T; 3]) -> Self {
        let (origin, nowhere) = (unit(vertex), [T::ZERO; 3]);
        Self { sum: T::ZERO, origin, previous: vertex, previous_unit: origin, leaves: nowhere, enters: nowhere }
    }

    /// Adds the edge to the next vertex, without the part below the horizon.
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

    /// The last vertex.
    #[must_use]
    pub fn previous(&self) -> [T; 3] {
        self.previous
    }

    /// Moves to a vertex without adding an edge. Call [`Clip::border`] to add a curved border up to this vertex.
    pub fn go_to(&mut self, vertex: [T; 3]) {
        (self.previous, self.previous_unit) = (vertex, unit(vertex));
    }

    /// Sets the direction in which the outline crosses the horizon downwards.
    pub fn leave(&mut self, direction: [T; 3]) {
        self.leaves = unit(direction);
    }

    /// Sets the direction in which the outline crosses the horizon upwards.
    pub fn enter(&mut self, direction: [T; 3]) {
        self.enters = unit(direction);
    }

    /// Adds a curved border between two directions. The whole border must be above the horizon. `integral` is the
    /// integral of `(p x dp)_z / |p|^2` along the border.
    pub fn border(&mut self, ends: [[T; 3]; 2], integral: T) {
        // The border replaces the chord between its ends. `origin` has the same purpose as in `arc`.
        let [p, q] = ends.map(unit);
        let moved = cross(minus(p, self.origin), minus(q, self.origin))[2] - cross(p, q)[2];
        self.sum = self.sum + integral + moved;
    }

    /// The integral, in [-1, 1]. It is negative if the vertices run anticlockwise as seen from the origin.
    #[must_use]
    pub fn finish(self) -> T {
        // `leaves` and `enters` are both zero if nothing crosses the horizon.
        let is_cut = self.leaves != self.enters;
        let closing = if is_cut { self.arc(self.leaves, self.enters) } else { T::ZERO };
        (self.sum + closing) / T::TAU
    }

    /// The contribution of an edge to the sum. Its angle is computed from sine and cosine. Unlike `acos`, this is
    /// accurate for arcs of every length.
    fn arc(&self, a: [T; 3], b: [T; 3]) -> T {
        let c = cross(a, b);
        let sin = dot(c, c).sqrt();
        let bend = if sin > T::SHORTEST { T::atan2_upper(sin, dot(a, b)) / sin - T::ONE } else { T::ZERO };
        cross(minus(a, self.origin), minus(b, self.origin))[2] + c[2] * bend
    }
}

impl Ltc {
    /// The part of the distribution over a convex polygon seen from the origin, in [0, 1].
    ///
    /// `I(P) = I_cosine(M^-1 P)` [Heitz et al. 2016, section 3]. Zero for fewer than three vertices. Domain: finite
    /// vertices.
    #[must_use]
    pub fn polygon(&self, vertices: &[DVec3], sides: Sides) -> f64 {
        let inverse = self.inverse();
        // A matrix with a negative determinant reverses the polygon's winding.
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

    /// The vector form factor of a convex polygon in cosine space. It ignores the horizon and points towards the
    /// polygon. For a cap of half angle sigma, its length is `sin^2 sigma`. [`super::clipped_form_factor`] approximates
    /// the part of the polygon above the horizon by a cap with the same vector form factor [Hill and Heitz 2016].
    ///
    /// Zero for fewer than three vertices. Domain: finite vertices; a polygon that does not contain the origin.
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
pub mod cases;
#[cfg(test)]
mod tests;
