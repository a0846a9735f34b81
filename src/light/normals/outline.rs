//! The outline of a light above the surface, and its image among the normals.

use std::ops::Range;

use crate::fit::math::{Scalar, Triple, dot, minus, plus, scaled, unit};

/// A corner of a light's outline.
#[derive(Debug, Clone, Copy)]
pub(super) struct Corner<T> {
    /// Its direction from the shaded point.
    pub(super) w: Triple<T>,
    /// Its image: the normal `c = A^-1 (wo + w)` that reflects `wo` to `w`, on the unit sphere.
    pub(super) c: Triple<T>,
    /// The length of `A^-1 (wo + w)`.
    pub(super) length: T,
}

impl<T: Scalar> Corner<T> {
    /// The corner in the direction of `v`.
    pub(super) fn new(v: Triple<T>, alpha: [T; 2], wo: Triple<T>) -> Self {
        let w = unit(v);
        let c = unstretched(plus(wo, w), alpha);
        let length = dot(c, c).sqrt().max(T::SHORTEST);
        Self { w, c: scaled(c, T::ONE / length), length }
    }

    /// Half the length of the sum of two corners' directions: the cosine of half the angle between them.
    fn half_cosine(&self, to: &Self) -> T {
        let sum = plus(self.w, to.w);
        (T::of(0.5) * dot(sum, sum).sqrt()).max(T::of(1e-6))
    }

    /// The corner at `t` of the edge to another corner, in (0, 1), by the parameter of the image's standard form.
    ///
    /// An arc of a circle between the unit vectors a and b is `(1-t)^2 a + 2 t (1-t) (a + b) / (2 k) + t^2 b` over
    /// `(1-t)^2 + 2 t (1-t) k + t^2`, `k = |a + b| / 2`. Hence its image, up to length, is
    /// `(1-t)^2 A^-1 (wo + a) + 2 t (1-t) A^-1 (k wo + (a + b) / (2 k)) + t^2 A^-1 (wo + b)`. Standard form has ends of
    /// unit length: there, each point is the image of the arc's for another `t`.
    fn towards(&self, to: &Self, t: T, alpha: [T; 2], wo: Triple<T>) -> Self {
        let (x, y) = ((T::ONE - t) * to.length.sqrt(), t * self.length.sqrt());
        let middle = scaled(plus(self.w, to.w), x * y / self.half_cosine(to));
        Self::new(plus(plus(scaled(self.w, x * x), middle), scaled(to.w, y * y)), alpha, wo)
    }
}

/// `A^-1 h`.
fn unstretched<T: Scalar>(h: Triple<T>, [alpha_x, alpha_y]: [T; 2]) -> Triple<T> {
    [h[0] / alpha_x, h[1] / alpha_y, h[2]]
}

/// Into how many parts edges are split, for the weight; their integral is exact as it is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Parts {
    /// An edge of the light.
    pub(super) edge: u32,
    /// The edge that is on the horizon or nearest to it.
    pub(super) horizon: u32,
}

/// The outline of a light above the surface.
///
/// The weight is zero on the horizon, so an edge there, or one that is nearly there, has a rule of its own and more parts than
/// the others. Which edge that is changes as lights move, and an edge that is the horizon's and one that is not are the same
/// where the light touches the surface. So that nothing jumps, that rule counts by a share, and by the rest the edge counts as
/// the others.
#[derive(Debug, Clone)]
pub(super) struct Outline<T> {
    /// In the polygon's order. Fewer than three where nothing is above the surface.
    pub(super) corners: Vec<Corner<T>>,
    /// The corners at which the parts of the edge on or near the horizon begin; none if it is no edge's turn.
    pub(super) setting: Range<usize>,
    /// By how much it counts as the horizon, in [0, 1].
    pub(super) share: T,
}

/// An edge is near the horizon where its higher end is lower than this part of the light's height above the surface, and the
/// nearer the lower that is.
const NEAR: f64 = 0.25;

impl<T: Scalar> Outline<T> {
    /// The part of a convex polygon that is above the surface, `z > 0`.
    pub(super) fn new(vertices: &[Triple<T>], parts: Parts, alpha: [T; 2], wo: Triple<T>) -> Self {
        let (ends, is_cut) = above(vertices);
        let (at, share) = setting(&ends, is_cut);
        let corner = |v: &Triple<T>| Corner::new(*v, alpha, wo);
        let mut outline = Self { corners: Vec::with_capacity(ends.len() + 8), setting: 0..0, share };
        for (i, (from, to)) in ends.iter().zip(ends.iter().cycle().skip(1)).enumerate() {
            let (start, count) = (outline.corners.len(), if Some(i) == at { parts.horizon } else { parts.edge });
            let (from, to) = (corner(from), corner(to));
            outline.corners.push(from);
            split(&mut outline.corners, &from, &to, count, alpha, wo);
            if Some(i) == at {
                outline.setting = start..outline.corners.len();
            }
        }
        outline
    }
}

/// The vertices above the surface, in order, and where the outline crosses it, if it does: that is first and last then, so that
/// the last edge is along the horizon.
fn above<T: Scalar>(vertices: &[Triple<T>]) -> (Vec<Triple<T>>, bool) {
    let count = vertices.len();
    let is_up = |i: usize| vertices[i % count][2] > T::ZERO;
    let Some(first) = (0..count).find(|i| is_up(*i)) else { return (Vec::new(), false) };
    let Some(below) = (first..first + count).find(|i| !is_up(*i) && is_up(i + 1)) else {
        return (vertices.to_vec(), false);
    };
    let mut ends = vec![crossing(vertices[below % count], vertices[(below + 1) % count])];
    let ups = (below + 1..).take_while(|i| is_up(*i)).map(|i| vertices[i % count]);
    ends.extend(ups);
    let last = below + ends.len();
    ends.push(crossing(vertices[(last - 1) % count], vertices[last % count]));
    (ends, true)
}

/// Which edge has the horizon's rule, and by how much. `ends` are the corners of an outline; if it `is_cut`, its last edge is
/// along the horizon.
///
/// Of the other edges, the one that is nearest to the horizon may have it, as far as it is nearer than all others. If the
/// light is cut, the horizon's extent r among those of all edges near it, each by its nearness, decides between the two:
/// where an edge sets corner after corner, r grows from 0 to 1.
fn setting<T: Scalar>(ends: &[Triple<T>], is_cut: bool) -> (Option<usize>, T) {
    let height = ends.iter().fold(T::ZERO, |most, v| most.max(v[2]));
    let extent = |i: usize| {
        let apart = minus(unit(ends[(i + 1) % ends.len()]), unit(ends[i]));
        dot(apart, apart).sqrt()
    };
    let (mut nearest, mut nearness, mut second, mut extents) = (None, T::ZERO, T::ZERO, T::ZERO);
    for i in 0..ends.len() - usize::from(is_cut) {
        let top = ends[i][2].max(ends[(i + 1) % ends.len()][2]);
        let near = T::ONE - top / (T::of(NEAR) * height).max(T::of(1e-36));
        if near <= T::ZERO {
            continue;
        }
        extents = extents + near * extent(i);
        if near > nearness {
            (nearest, second, nearness) = (Some(i), nearness, near);
        } else {
            second = second.max(near);
        }
    }
    let share = nearness - second;
    if !is_cut {
        return (nearest, share);
    }
    let horizon = extent(ends.len() - 1);
    let r = horizon / (horizon + extents).max(T::of(1e-36));
    let other = share * (T::ONE - r);
    if r > other { (Some(ends.len() - 1), r - other) } else { (nearest, other - r) }
}

/// Adds the corners within an edge that split it into `parts`.
fn split<T: Scalar>(
    corners: &mut Vec<Corner<T>>,
    from: &Corner<T>,
    to: &Corner<T>,
    parts: u32,
    alpha: [T; 2],
    wo: Triple<T>,
) {
    for part in 1..parts {
        corners.push(from.towards(to, T::of(f64::from(part) / f64::from(parts)), alpha, wo));
    }
}

/// The direction in which the edge between vertices on either side of the horizon meets it.
fn crossing<T: Scalar>(a: Triple<T>, b: Triple<T>) -> Triple<T> {
    let (a_share, b_share) = (b[2].abs(), a[2].abs());
    [a[0] * a_share + b[0] * b_share, a[1] * a_share + b[1] * b_share, T::ZERO]
}
