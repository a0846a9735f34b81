//! The integral of `c x dc` along the image of an arc, in closed form.

use super::bend::arc_bend;
use super::{
    arc::{Arc, ArcKind, Extent},
    cone::{Cone, ConeArc},
    flat::{flat, is_flat},
    interface::Interface,
};
use ltcforge_fit::math::{Scalar, Triple, cross, dot, minus, scaled, unit};

/// A negative angle about an axis is a rounded zero if its absolute value is below this. Otherwise, a whole turn is
/// added.
const ROUNDED_ANGLE: f64 = 0.01;
/// The smallest cosine between the ends of a short great arc.
const SHORT_COSINE: f64 = 0.5;

/// The contribution of an arc's image to the integral of `c x dc`, without the plane triangle's `from x to`.
pub(super) fn curved_part<T: Scalar>(
    interface: &Interface<T>,
    arc: &Arc<T>,
    from: Triple<T>,
    to: Triple<T>,
) -> Triple<T> {
    match arc.kind {
        ArcKind::Horizon => great_arc([T::ZERO, T::ZERO, T::ONE], arc.extent, from, to),
        ArcKind::Grazing => great_arc(unit(interface.stretched), arc.extent, from, to),
        ArcKind::Edge | ArcKind::Surface | ArcKind::Critical => match arc.control(interface) {
            Some(control) if is_flat(from, to, control) => flat(from, to, control),
            _ => conic(interface, arc, from, to),
        },
    }
}

/// The contribution of a great arc clockwise about `normal`.
fn great_arc<T: Scalar>(normal: Triple<T>, extent: Extent, from: Triple<T>, to: Triple<T>) -> Triple<T> {
    if extent == Extent::Whole {
        return scaled(normal, -T::TAU);
    }
    let across = cross(from, to);
    let (sin, cos) = (-dot(normal, across), dot(from, to));
    if extent == Extent::Short && cos > T::of(SHORT_COSINE) && sin > -T::of(ROUNDED_ANGLE) {
        return arc_bend(from, to);
    }
    let angle = T::atan2(sin, cos);
    let angle = match angle < T::ZERO {
        true if angle > -T::of(ROUNDED_ANGLE) && extent == Extent::Short => T::ZERO,
        true => angle + T::TAU,
        false => angle,
    };
    minus(scaled(normal, -angle), across)
}

/// The contribution of an arc of a quadratic cone.
///
/// For unit normals `h` the refracted direction is `eta wi = m h - wo`. It has length `eta` if
/// `m^2 - 2 m (wo . h) + 1 - eta^2 = 0`. The circle `p . wi = q` demands `m (p . h) = k` with `k = wo . p + eta q`. The
/// first equation times `(p . h)^2` becomes `h^T [k^2 I - k (wo p' + p wo') + (1 - eta^2) p p'] h = 0`, which is the
/// cone of `-K`.
fn conic<T: Scalar>(interface: &Interface<T>, arc: &Arc<T>, from: Triple<T>, to: Triple<T>) -> Triple<T> {
    let p = arc.circle.axis;
    let k = dot(interface.wo, p) + interface.eta * arc.circle.offset;
    if k.abs() < T::UNCERTAINTY && arc.extent != Extent::Whole {
        // The cone is a plane, the plane of the circle. This happens if the edge is in line with the view.
        return arc_bend(from, to);
    }
    let (view, axis, contrast) = (interface.stretched, interface.stretch(p), interface.contrast());
    let element = |i: usize, j: usize| k * (view[i] * axis[j] + axis[i] * view[j]) - contrast * axis[i] * axis[j];
    let diagonal = |i: usize, a: T| element(i, i) - k * k * a * a;
    let [alpha_x, alpha_y] = interface.alpha;
    let cone = Cone::new([
        diagonal(0, alpha_x),
        diagonal(1, alpha_y),
        diagonal(2, T::ONE),
        element(0, 1),
        element(0, 2),
        element(1, 2),
    ]);

    // The direction in which the image goes around the cone's axis.
    let arc_on_cone = ConeArc { from: cone.local(from), to: cone.local(to), normal: cone.local(cross(from, to)) };
    let sense = if k < T::ZERO { -interface.sigma } else { interface.sigma };
    let sense = if arc_on_cone.from[0] < T::ZERO { -sense } else { sense };
    if arc.extent == Extent::Whole {
        return cone.whole(sense);
    }
    let psi = cone.angle(&arc_on_cone);
    // An angle against this direction is either a rounded zero or lacks a whole turn. The midpoint distinguishes the
    // two.
    let is_rounded = || {
        let middle = cone.local(interface.normal(T::ONE, arc.middle()));
        psi.abs() < T::of(ROUNDED_ANGLE) && cone.are_on_one_side(arc_on_cone.from, middle)
    };
    let is_wrapped = psi * sense < T::ZERO && !is_rounded();
    let exact = cone.integral(&arc_on_cone, if is_wrapped { psi + sense * T::TAU } else { psi });
    minus(exact, cross(from, to))
}
