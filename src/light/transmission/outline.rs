//! The outline of the visible part of a light through the interface.
//!
//! | clip | kept part | closed by |
//! |---|---|---|
//! | the surface | `wi.z < 0` | a great arc |
//! | normals above the surface, `h.z > 0` | `-wi.z > wo.z / eta` (eta > 1), `-wi.z < wo.z / eta` (eta < 1) | `Horizon`, a great arc of normals |
//! | normals that face the viewer, `wo . h > 0`, eta > 1 | `wo . wi < -1 / eta` | `Grazing`, a great arc of normals |
//! | normals that face the light, `wi . h < 0`, eta < 1 | `wo . wi < -eta` | `Critical`, a conic |
//!
//! For `eta > 1`, every normal that faces the viewer also faces the light. For `eta < 1`, every normal that faces the
//! light also faces the viewer.

use super::{
    arc::{Arc, ArcKind, Circle, Extent},
    clip::clip,
    interface::Interface,
};
use ltcforge_fit::{
    Sides,
    math::{Scalar, Triple, cross, dot, minus, plus, scaled, unit},
};

/// The smallest squared length of an edge. A shorter edge has no direction in f32.
const SHORTEST2: f64 = 1e-14;

/// The arcs around the visible part of a convex polygon, counterclockwise as seen from outside of the sphere of
/// directions. Empty if nothing is visible.
pub(super) fn outline<T: Scalar>(interface: &Interface<T>, vertices: &[Triple<T>], sides: Sides) -> Vec<Arc<T>> {
    let edges = below(vertices, sides);
    if edges.is_empty() {
        return edges;
    }
    let sigma = interface.sigma;
    let above = Circle { axis: [T::ZERO, T::ZERO, sigma], offset: -sigma * interface.wo[2] / interface.eta };
    let (kind, cosine) = if interface.is_denser() {
        (ArcKind::Grazing, T::ONE / interface.eta)
    } else {
        (ArcKind::Critical, interface.eta)
    };
    let facing = Circle { axis: scaled(interface.wo, -T::ONE), offset: cosine };

    let in_light = |w| edges.iter().all(|edge| edge.circle.depth(w) > T::ZERO);
    let arcs = clip(&edges, above, ArcKind::Horizon, in_light);
    clip(&arcs, facing, kind, |w| in_light(w) && above.depth(w) > T::ZERO)
}

/// The edges of the part of a polygon below the surface.
fn below<T: Scalar>(vertices: &[Triple<T>], sides: Sides) -> Vec<Arc<T>> {
    let mut corners: Vec<Triple<T>> = Vec::with_capacity(vertices.len() + 2);
    for (a, b) in pairs(vertices) {
        if a[2] < T::ZERO {
            corners.push(unit(a));
        }
        if (a[2] < T::ZERO) != (b[2] < T::ZERO) {
            corners.push(unit(crossing(a, b)));
        }
    }
    let Some(first) = corners.first().copied() else { return Vec::new() };
    let (mut area, mut middle) = ([T::ZERO; 3], [T::ZERO; 3]);
    for (a, b) in pairs(&corners) {
        area = plus(area, cross(minus(a, first), minus(b, first)));
        middle = plus(middle, a);
    }
    if dot(area, middle) < T::ZERO {
        if sides == Sides::One {
            return Vec::new();
        }
        corners.reverse();
    }
    // Very short edges are left out, and the corners of the other edges joined.
    let mut joined: Vec<Triple<T>> = Vec::with_capacity(corners.len());
    for (a, b) in pairs(&corners) {
        let apart = minus(b, a);
        if dot(apart, apart) >= T::of(SHORTEST2) {
            joined.push(a);
        }
    }
    if joined.len() < 3 {
        return Vec::new();
    }
    let edge = |(from, to): (Triple<T>, Triple<T>)| {
        let kind = if from[2] < T::ZERO || to[2] < T::ZERO { ArcKind::Edge } else { ArcKind::Surface };
        // Replaces from x to, whose rounding errors are as large as the errors of the ends.
        let axis = unit(cross(from, minus(to, from)));
        Arc { circle: Circle { axis, offset: T::ZERO }, from, to, kind, extent: Extent::Short }
    };
    pairs(&joined).map(edge).collect()
}

/// Pairs of each element and the next, cyclically.
fn pairs<T: Copy>(around: &[T]) -> impl Iterator<Item = (T, T)> {
    around.iter().copied().zip(around.iter().copied().cycle().skip(1))
}

/// The direction in which an edge crosses the surface. Its vertices are on either side.
fn crossing<T: Scalar>(a: Triple<T>, b: Triple<T>) -> Triple<T> {
    let (a_share, b_share) = (b[2].abs(), a[2].abs());
    [a[0] * a_share + b[0] * b_share, a[1] * a_share + b[1] * b_share, T::ZERO]
}
