//! The outline of a light above the surface, and its image among the normals.

use std::ops::Range;

use ltcforge_fit::math::{Scalar, Triple, dot, minus, plus, scaled, unit};

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
pub(super) struct EdgeParts {
    /// An edge of the light.
    pub(super) edge: u32,
    /// The edge that is on the horizon or nearest to it; twice as many where it is wide.
    pub(super) horizon: u32,
}

/// The outline of a light above the surface.
///
/// The weight is zero on the horizon, so an edge there, or one that is nearly there, has a rule of its own and more
/// parts than the others. Which edge that is changes as lights move, and an edge that is the horizon's and one that is
/// not are the same where the light touches the surface. So that nothing jumps, that rule counts by a share, and by the
/// rest the edge counts as the others.
#[derive(Debug, Clone)]
pub(super) struct Outline<T> {
    /// In the polygon's order. Fewer than three where nothing is above the surface.
    pub(super) corners: Vec<Corner<T>>,
    /// The corners at which the parts of the edge on or near the horizon begin; none if it is no edge's turn.
    pub(super) setting: Range<usize>,
    /// By how much it counts as the horizon, in [0, 1].
    pub(super) share: T,
    /// How wide it is, in [0, 1]: above zero each of its parts is split in two.
    pub(super) wide: T,
    /// How many of its parts share an integral.
    pub(super) parts_per_integral: usize,
}

/// An edge is near the horizon where its higher end is lower than this part of the light's height above the surface,
/// and the nearer the lower that is.
const NEAR: f64 = 0.25;
/// An edge on or near the horizon is wide from the first of these distances between the directions of its ends, and in
/// full from the second: 74 and 128 degrees.
const WIDE: [f64; 2] = [1.2, 1.8];

impl<T: Scalar> Outline<T> {
    /// The part of a convex polygon that is above the surface, `z > 0`.
    pub(super) fn new(vertices: &[Triple<T>], parts: EdgeParts, alpha: [T; 2], wo: Triple<T>) -> Self {
        let (ends, is_cut) = above(vertices);
        let (at, share) = setting(&ends, is_cut);
        let corner = |v: &Triple<T>| Corner::new(*v, alpha, wo);
        let corners = Vec::with_capacity(ends.len() + 16);
        let mut outline = Self { corners, setting: 0..0, share, wide: T::ZERO, parts_per_integral: 1 };
        for (i, (from, to)) in ends.iter().zip(ends.iter().cycle().skip(1)).enumerate() {
            let start = outline.corners.len();
            let (from, to) = (corner(from), corner(to));
            outline.corners.push(from);
            if Some(i) == at {
                if parts.horizon > 1 {
                    outline.wide = share * width(&from, &to);
                    outline.parts_per_integral = if outline.wide > T::ZERO { 4 } else { 2 };
                }
                split(&mut outline.corners, &from, &to, parts.horizon, outline.wide, alpha, wo);
                outline.setting = start..outline.corners.len();
            } else {
                split(&mut outline.corners, &from, &to, parts.edge, T::ZERO, alpha, wo);
            }
        }
        outline
    }
}

/// The vertices above the surface, in order, and where the outline crosses it, if it does: that is first and last then,
/// so that the last edge is along the horizon.
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

/// Which edge has the horizon's rule, and by how much. `ends` are the corners of an outline; if it `is_cut`, its last
/// edge is along the horizon.
///
/// With an edge's nearness nu, 1 for the horizon, and its extent e, the distance of its ends' directions, it is the
/// edge with the largest `nu^2 e`, by the share `(largest - second largest) / sum of nu e`. So an edge that has just
/// begun to rise at a corner has no share, and one that sets loses its share to the horizon little by little.
fn setting<T: Scalar>(ends: &[Triple<T>], is_cut: bool) -> (Option<usize>, T) {
    let height = ends.iter().fold(T::ZERO, |most, v| most.max(v[2]));
    let (mut nearest, mut most, mut second, mut extents) = (None, T::ZERO, T::ZERO, T::ZERO);
    for i in 0..ends.len() {
        let (from, to) = (ends[i], ends[(i + 1) % ends.len()]);
        let is_horizon = is_cut && i + 1 == ends.len();
        let lowness = T::ONE - from[2].max(to[2]) / (T::of(NEAR) * height).max(T::of(1e-36));
        let near = if is_horizon { T::ONE } else { lowness.max(T::ZERO) };
        let apart = minus(unit(to), unit(from));
        let near_extent = near * dot(apart, apart).sqrt();
        let by_extent = near * near_extent;
        extents = extents + near_extent;
        if by_extent > most {
            (nearest, second, most) = (Some(i), most, by_extent);
        } else {
            second = second.max(by_extent);
        }
    }
    (nearest, (most - second) / extents.max(T::of(1e-36)))
}

/// How wide an edge is, from 0 to 1, without a kink.
fn width<T: Scalar>(from: &Corner<T>, to: &Corner<T>) -> T {
    let [least, most] = WIDE.map(T::of);
    let apart = minus(to.w, from.w);
    let t = ((dot(apart, apart).sqrt() - least) / (most - least)).max(T::ZERO).min(T::ONE);
    t * t * (T::of(3.0) - T::of(2.0) * t)
}

/// Adds the corners within an edge that split it into `parts`; if it is at all `wide`, also one within each part. Where
/// the edge begins to be wide, that starts at the corner between two parts, and it moves to the middle of its own as
/// the edge gets wider, so that nothing jumps.
fn split<T: Scalar>(
    corners: &mut Vec<Corner<T>>,
    from: &Corner<T>,
    to: &Corner<T>,
    parts: u32,
    wide: T,
    alpha: [T; 2],
    wo: Triple<T>,
) {
    let at = |part: T| from.towards(to, part / T::of(f64::from(parts)), alpha, wo);
    for part in 0..parts {
        let begin = T::of(f64::from(part));
        if part > 0 {
            corners.push(at(begin));
        }
        if wide > T::ZERO {
            let half = T::of(0.5) * wide;
            corners.push(at(if part % 2 > 0 { begin + half } else { begin + (T::ONE - half) }));
        }
    }
}

/// The direction in which the edge between vertices on either side of the horizon meets it.
fn crossing<T: Scalar>(a: Triple<T>, b: Triple<T>) -> Triple<T> {
    let (a_share, b_share) = (b[2].abs(), a[2].abs());
    [a[0] * a_share + b[0] * b_share, a[1] * a_share + b[1] * b_share, T::ZERO]
}
