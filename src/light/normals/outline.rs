//! The outline of a light above the surface, and its image among the normals.

use crate::fit::math::{Scalar, Triple, dot, plus, scaled, unit};

/// A corner of a light's outline.
#[derive(Debug, Clone, Copy)]
pub(super) struct Corner<T> {
    /// Its direction from the shaded point.
    pub(super) w: Triple<T>,
    /// Its image: the normal `c = A^-1 (wo + w)` that reflects `wo` to `w`, on the unit sphere.
    pub(super) c: Triple<T>,
    /// The length of `A^-1 (wo + w)`.
    length: T,
}

impl<T: Scalar> Corner<T> {
    /// The corner in the direction of `v`.
    fn new(v: Triple<T>, alpha: [T; 2], wo: Triple<T>) -> Self {
        let w = unit(v);
        let c = unstretched(plus(wo, w), alpha);
        let length = dot(c, c).sqrt().max(T::SHORTEST);
        Self { w, c: scaled(c, T::ONE / length), length }
    }

    /// Whether it is on the horizon, where an outline that the surface cuts meets it.
    pub(super) fn is_on_horizon(&self) -> bool {
        self.w[2] == T::ZERO
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
    /// The edge along the horizon that closes a light which is cut there.
    pub(super) horizon: u32,
}

/// The corners of the part of a convex polygon that is above the surface, `z > 0`, in the polygon's order. Empty where
/// nothing is.
pub(super) fn outline<T: Scalar>(vertices: &[Triple<T>], parts: Parts, alpha: [T; 2], wo: Triple<T>) -> Vec<Corner<T>> {
    let count = vertices.len();
    let is_up = |i: usize| vertices[i % count][2] > T::ZERO;
    let Some(first) = (0..count).find(|i| is_up(*i)) else { return Vec::new() };
    // Where the outline rises above the horizon, if it does.
    let rises = (first..first + count).find(|i| !is_up(*i) && is_up(i + 1));
    let corner = |v: Triple<T>| Corner::new(v, alpha, wo);
    let mut corners: Vec<Corner<T>> = Vec::with_capacity(count + 4);
    let mut add = |corner: Corner<T>, parts: u32| {
        if let Some(last) = corners.last().copied() {
            split(&mut corners, &last, &corner, parts, alpha, wo);
        }
        corners.push(corner);
    };
    let Some(below) = rises else {
        for v in vertices {
            add(corner(*v), parts.edge);
        }
        let (last, first) = (corners[corners.len() - 1], corners[0]);
        split(&mut corners, &last, &first, parts.edge, alpha, wo);
        return corners;
    };
    add(corner(crossing(vertices[below % count], vertices[(below + 1) % count])), 1);
    let mut at = below + 1;
    while is_up(at) {
        add(corner(vertices[at % count]), parts.edge);
        at += 1;
    }
    add(corner(crossing(vertices[(at - 1) % count], vertices[at % count])), parts.edge);
    let (last, first) = (corners[corners.len() - 1], corners[0]);
    split(&mut corners, &last, &first, parts.horizon, alpha, wo);
    corners
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

/// How far the surface cuts a light: 0 where it touches it, 1 where the light is deeper below it than an eighth of its
/// height above.
///
/// An edge that sets is one edge before, and a horizon of several parts after. This blends the two, so that no line is seen
/// where it happens.
pub(super) fn cut_share<T: Scalar>(vertices: &[Triple<T>]) -> T {
    let furthest = |sign: T| vertices.iter().fold(T::ZERO, |most, v| most.max(sign * v[2]));
    let (above, below) = (furthest(T::ONE), furthest(-T::ONE));
    if above > T::ZERO { (T::of(8.0) * below / above).min(T::ONE) } else { T::ZERO }
}

/// The direction in which the edge between vertices on either side of the horizon meets it.
fn crossing<T: Scalar>(a: Triple<T>, b: Triple<T>) -> Triple<T> {
    let (a_share, b_share) = (b[2].abs(), a[2].abs());
    [a[0] * a_share + b[0] * b_share, a[1] * a_share + b[1] * b_share, T::ZERO]
}
