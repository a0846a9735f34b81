//! The outline of a light above the surface, and the images of its corners among the normals.

use super::view::View;
use ltcforge_fit::math::{Scalar, Triple, dot, plus, scaled, unit};

/// A corner of a light's outline.
#[derive(Debug, Clone, Copy)]
pub(super) struct Corner<T> {
    /// The direction from the shaded point.
    pub(super) w: Triple<T>,
    /// The image: the normal `c = A^-1 (wo + w)` that reflects `wo` to `w`, on the unit sphere.
    pub(super) c: Triple<T>,
    /// The length of `A^-1 (wo + w)`.
    pub(super) length: T,
}

impl<T: Scalar> Corner<T> {
    /// The corner in the direction of `v`.
    pub(super) fn new(view: &View<T>, v: Triple<T>) -> Self {
        let w = unit(v);
        let c = view.image(plus(view.wo, w));
        let length = dot(c, c).sqrt().max(T::SHORTEST);
        Self { w, c: scaled(c, T::ONE / length), length }
    }

    /// The image before it is normalised.
    pub(super) fn unscaled(&self) -> Triple<T> {
        scaled(self.c, self.length)
    }
}

/// The part of a convex polygon that is above the surface, `z > 0`.
#[derive(Debug, Clone)]
pub(super) struct Outline<T> {
    /// The corners in the polygon's order; empty if nothing is above the surface. If the outline crosses the surface,
    /// the first and the last corner are the crossings.
    pub(super) corners: Vec<Corner<T>>,
    /// True if the last edge lies on the horizon.
    is_cut: bool,
}

impl<T: Scalar> Outline<T> {
    pub(super) fn new(view: &View<T>, vertices: &[Triple<T>]) -> Self {
        let is_cut = vertices.iter().any(|v| v[2] <= T::ZERO);
        Self { corners: above(vertices).into_iter().map(|v| Corner::new(view, v)).collect(), is_cut }
    }

    /// The two corners of each edge.
    pub(super) fn edges(&self) -> impl Iterator<Item = (&Corner<T>, &Corner<T>)> {
        self.corners.iter().zip(self.corners.iter().cycle().skip(1))
    }

    /// True if the edge of this index lies on the horizon.
    pub(super) fn is_on_horizon(&self, edge: usize) -> bool {
        self.is_cut && edge + 1 == self.corners.len()
    }
}

/// The vertices above the surface, in order. If the outline crosses the surface, the crossings are first and last.
fn above<T: Scalar>(vertices: &[Triple<T>]) -> Vec<Triple<T>> {
    let count = vertices.len();
    let is_up = |i: usize| vertices[i % count][2] > T::ZERO;
    let Some(first) = (0..count).find(|i| is_up(*i)) else { return Vec::new() };
    let Some(below) = (first..first + count).find(|i| !is_up(*i) && is_up(i + 1)) else {
        return vertices.to_vec();
    };
    let mut ends = vec![crossing(vertices[below % count], vertices[(below + 1) % count])];
    let ups = (below + 1..).take_while(|i| is_up(*i)).map(|i| vertices[i % count]);
    ends.extend(ups);
    let last = below + ends.len();
    ends.push(crossing(vertices[(last - 1) % count], vertices[last % count]));
    ends
}

/// The direction in which an edge crosses the horizon. Its vertices are on either side.
fn crossing<T: Scalar>(a: Triple<T>, b: Triple<T>) -> Triple<T> {
    let (a_share, b_share) = (b[2].abs(), a[2].abs());
    [a[0] * a_share + b[0] * b_share, a[1] * a_share + b[1] * b_share, T::ZERO]
}
