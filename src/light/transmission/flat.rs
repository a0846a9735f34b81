//! Images of nearly straight arcs.

use super::bend::arc_bend;
use ltcforge_fit::math::{Scalar, Triple, cross, dot, minus, plus, scaled};

/// An image is flat if the determinant of its two ends and its control point is below this, and its ends are less than
/// 60 degrees apart. The area of its segment is then an inscribed triangle's area times a factor. The error is at most
/// 3e-5 of a whole lobe.
const FLAT: f64 = 0.01;
const FLAT_COSINE: f64 = 0.5;

/// True if the image from `a` to `b` with a control point is nearly straight.
pub(super) fn is_flat<T: Scalar>(a: Triple<T>, b: Triple<T>, control: Triple<T>) -> bool {
    dot(control, cross(a, b)).abs() < T::of(FLAT)
        && dot(a, b) > T::of(FLAT_COSINE)
        && dot(control, plus(a, b)) > T::of(0.5)
}

/// The integral along the nearly straight image of an arc, minus `a x b`. The image is a conic arc with the control
/// point `control` in standard form.
///
/// The area between a conic arc of weight `w` and its chord is a factor times the area of the triangle of its ends and
/// its midpoint. The factor is pi/2 for half an ellipse (w = 0), 4/3 for a parabola (w = 1), and 1 for two straight
/// lines (w to infinity). The rational function has an error of at most 3e-4.
pub(super) fn flat<T: Scalar>(a: Triple<T>, b: Triple<T>, control: Triple<T>) -> Triple<T> {
    let between = plus(a, b);
    let middle = plus(between, scaled(control, T::of(2.0)));
    let middle = scaled(middle, T::ONE / dot(middle, middle).sqrt());
    let w = T::of(2.0) * dot(control, between) / dot(between, between);
    let square = T::of(0.159_346_5) * w;
    let factor = (T::of(std::f64::consts::FRAC_PI_2) + w * (T::of(1.168_051_6) + square))
        / (T::ONE + w * (T::of(1.014_469_6) + square));
    let chord = arc_bend(a, b);
    let halves = plus(arc_bend(a, middle), arc_bend(middle, b));
    // The plane part from a through the middle to b, minus the plane part from a to b.
    let plane = cross(minus(middle, a), minus(b, middle));
    plus(chord, scaled(plus(plane, minus(halves, chord)), factor))
}
