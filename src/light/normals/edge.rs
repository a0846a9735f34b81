//! The integral of `c x dc` along the image of a light's edge, in closed form.

use super::{
    cone::{Cone, ConeArc},
    outline::Corner,
};
use crate::fit::math::{Scalar, Triple, cross, dot, minus, plus, scaled};

/// An edge whose ends are this near to each other, squared, has no direction in f32.
const SHORTEST2: f64 = 1e-14;
/// An image is flat where the determinant of its two ends and its control point is below this, and its ends are less
/// than 60 degrees apart: its segment's area is then an inscribed triangle's times a factor, 3e-5 of a whole lobe off at
/// most.
const FLAT: f64 = 0.01;
const FLAT_COSINE: f64 = 0.5;

/// What the edge from `a` to `b` adds to the integral of `c x dc`, beyond the plane triangle's `a.c x b.c`.
///
/// Lights are sums of such edges. The plane part is summed separately, around an origin near the light, because it
/// cancels to a small area in a small light.
pub(super) fn curved_part<T: Scalar>(alpha: [T; 2], wo: Triple<T>, a: &Corner<T>, b: &Corner<T>) -> Triple<T> {
    let apart = minus(b.w, a.w);
    if dot(apart, apart) < T::of(SHORTEST2) {
        return [T::ZERO; 3];
    }
    let control = a.control(b, alpha, wo);
    if is_flat(a.c, b.c, control) {
        return flat(a.c, b.c, control);
    }
    minus(exact(alpha, wo, a, b, apart), cross(a.c, b.c))
}

/// Whether the image from `a` to `b` with a control point is nearly straight.
pub(in crate::light) fn is_flat<T: Scalar>(a: Triple<T>, b: Triple<T>, control: Triple<T>) -> bool {
    dot(control, cross(a, b)).abs() < T::of(FLAT)
        && dot(a, b) > T::of(FLAT_COSINE)
        && dot(control, plus(a, b)) > T::of(0.5)
}

/// `a x b (acos(a . b) / |a x b| - 1)`: what the arc of a great circle from `a` to `b` adds to `a x b`.
///
/// With `z = |a - b|^2 / 4`, half of the versed sine of the angle, the bracket is `asin(sqrt z) / sqrt(z (1 - z)) - 1 =
/// 2/3 z + 8/15 z^2 + ...`; here a polynomial that is 6e-7 off at most. Beyond a right angle the supplement is used.
pub(in crate::light) fn arc_bend<T: Scalar>(a: Triple<T>, b: Triple<T>) -> Triple<T> {
    let across = cross(a, b);
    let is_acute = dot(a, b) >= T::ZERO;
    let chord = if is_acute { minus(a, b) } else { plus(a, b) };
    let z = dot(chord, chord) * T::of(0.25);
    let series = [0.524_055_84, -0.089_545_56, 2.271_551, -3.406_860_7, 3.516_457_1];
    let [c2, c3, c4, c5, c6] = series.map(T::of);
    let bend =
        z * (T::of(0.666_755_35) + z * (T::of(0.529_126_37) + z * (c2 + z * (c3 + z * (c4 + z * (c5 + z * c6))))));
    let bend = if is_acute {
        bend
    } else {
        // pi / sin - (pi - angle) / sin, and - 1.
        T::TAU * T::of(0.5) / dot(across, across).max(T::of(1e-18)).sqrt() - bend - T::of(2.0)
    };
    scaled(across, bend)
}

/// The same for the nearly straight image of an edge, a conic arc with the control point `control` in standard form.
///
/// The area between a conic arc of weight `w` and its chord is a factor times that of the triangle of its ends and its
/// middle: pi/2 for half an ellipse (w = 0), 4/3 for a parabola (w = 1), 1 for two straight lines (w to infinity). The
/// rational function is 3e-4 off at most.
pub(in crate::light) fn flat<T: Scalar>(a: Triple<T>, b: Triple<T>, control: Triple<T>) -> Triple<T> {
    let between = plus(a, b);
    let middle = plus(between, scaled(control, T::of(2.0)));
    let middle = scaled(middle, T::ONE / dot(middle, middle).sqrt());
    let w = T::of(2.0) * dot(control, between) / dot(between, between);
    let square = T::of(0.159_346_5) * w;
    let factor = (T::of(std::f64::consts::FRAC_PI_2) + w * (T::of(1.168_051_6) + square))
        / (T::ONE + w * (T::of(1.014_469_6) + square));
    let chord = arc_bend(a, b);
    let halves = plus(arc_bend(a, middle), arc_bend(middle, b));
    // (middle - a) x (b - a), negative, is the plane part of a to middle to b beyond a to b.
    let plane = cross(minus(middle, a), minus(b, middle));
    plus(chord, scaled(plus(plane, minus(halves, chord)), factor))
}

/// The integral of `c x dc` along an edge's image, whatever its shape.
///
/// An edge lies on `w . n = 0`, `n = a x b`. With `w = 2 (h . wo) h - wo` its normals `h` lie on the cone
/// `h^T (wo n^T + n wo^T - k I) h = 0`, `k = wo . n`, and their images `c` on the cone of `K = A (..) A`. In K's
/// eigenframe, `l1 > 0 >= l2 >= l3`, the integral is elementary. `docs/normals.md` derives it.
fn exact<T: Scalar>(
    [alpha_x, alpha_y]: [T; 2],
    wo: Triple<T>,
    a: &Corner<T>,
    b: &Corner<T>,
    apart: Triple<T>,
) -> Triple<T> {
    // Not a x b, whose rounding errors are as large as those of a and b themselves.
    let n = cross(a.w, apart);
    let turns = if dot(wo, n) < T::ZERO { -T::ONE } else { T::ONE };
    let n = scaled(n, turns);
    let (x, y, z) = (wo[0] * n[0], wo[1] * n[1], wo[2] * n[2]);
    let k = [
        alpha_x * alpha_x * (x - y - z),
        alpha_y * alpha_y * (y - x - z),
        z - x - y,
        alpha_x * alpha_y * (wo[0] * n[1] + wo[1] * n[0]),
        alpha_x * (wo[0] * n[2] + wo[2] * n[0]),
        alpha_y * (wo[1] * n[2] + wo[2] * n[1]),
    ];
    let cone = Cone::new(k);
    let arc = ConeArc { from: cone.seen(a.c), to: cone.seen(b.c), normal: cone.seen(cross(a.c, b.c)) };

    // The arc runs around v1 in the sense of the edge; atan2 sees only its ends.
    let sense = if arc.from[0] < T::ZERO { -turns } else { turns };
    let psi = cone.angle(&arc);
    let is_wrapped = psi * sense < T::ZERO && (psi.abs() > T::of(0.01) || dot(a.w, b.w) < T::of(0.9));
    cone.integral(&arc, if is_wrapped { psi + sense * T::TAU } else { psi })
}
