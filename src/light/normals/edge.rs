//! The integral of `c x dc` along the image of a light's edge, in closed form.

use super::{
    cone::{Cone, ConeArc},
    outline::Corner,
};
use crate::fit::math::{Scalar, Triple, cross, dot, minus, plus, scaled};

/// What the edge from `a` to `b` adds to the integral of `c x dc`, beyond the plane triangle's `a.c x b.c`.
///
/// Lights are sums of such edges. The plane part is summed separately, around an origin near the light, because it
/// cancels to a small area in a small light.
pub(super) fn curved_part<T: Scalar>(alpha: [T; 2], wo: Triple<T>, a: &Corner<T>, b: &Corner<T>) -> Triple<T> {
    let apart = minus(b.w, a.w);
    if dot(apart, apart) < T::SAME2 {
        return [T::ZERO; 3];
    }
    minus(exact(alpha, wo, a, b, apart), cross(a.c, b.c))
}

/// What each of two parts, from a to m and from m to b, adds beyond its plane triangle, of the image of an edge whose `whole` is
/// known.
///
/// A part is the arc of the great circle between its ends, and of what the two arcs leave of the whole it has a share by the cube
/// of its chord, as lies between an arc and a chord of any curve. The shares decide only which part has which weight.
pub(super) fn shared<T: Scalar>([a, m, b]: [Triple<T>; 3], whole: Triple<T>) -> [Triple<T>; 2] {
    let arcs = [arc_bend(a, m), arc_bend(m, b)];
    // a x b less a x m and m x b.
    let plane = scaled(cross(minus(m, a), minus(b, a)), -T::ONE);
    let rest = minus(plus(whole, plane), plus(arcs[0], arcs[1]));
    let cubes = [minus(m, a), minus(b, m)].map(|chord| {
        let length2 = dot(chord, chord);
        length2 * length2.sqrt()
    });
    let per_cube = T::ONE / (cubes[0] + cubes[1]).max(T::of(1e-36));
    [0, 1].map(|i| plus(arcs[i], scaled(rest, cubes[i] * per_cube)))
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

/// The integral of `c x dc` along an edge's image.
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
