//! The integral of `c x dc` along the image of a light's edge, in closed form.

use super::{
    eigen::{Eigenframe, eigenframe},
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

/// The same, also for an edge whose image is nearly straight, without the short cut for those.
#[cfg(test)]
pub(super) fn exact_part<T: Scalar>(alpha: [T; 2], wo: Triple<T>, a: &Corner<T>, b: &Corner<T>) -> Triple<T> {
    let apart = minus(b.w, a.w);
    if dot(apart, apart) < T::SAME2 {
        return [T::ZERO; 3];
    }
    minus(exact(alpha, wo, a, b, apart), cross(a.c, b.c))
}

/// `a x b (acos(a . b) / |a x b| - 1)`: what the arc of a great circle from `a` to `b` adds to `a x b`.
///
/// With `z = |a - b|^2 / 4`, half of the versed sine of the angle, the bracket is `asin(sqrt z) / sqrt(z (1 - z)) - 1 =
/// 2/3 z + 8/15 z^2 + ...`; here a polynomial that is 6e-7 off at most. Beyond a right angle the supplement is used.
pub(super) fn arc_bend<T: Scalar>(a: Triple<T>, b: Triple<T>) -> Triple<T> {
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
    let [xx, yy, zz, xy, xz, yz] = k;
    let norm2 = xx * xx + yy * yy + zz * zz + T::of(2.0) * (xy * xy + xz * xz + yz * yz);
    let per_norm = T::ONE / norm2.sqrt().max(T::of(1e-30));
    let Eigenframe { values, vectors: v } = eigenframe(k.map(|x| x * per_norm));
    let l1 = values[0].max(T::of(1e-12));
    let l2 = values[1].min(T::ZERO);
    let l3 = values[2].min(l2);

    let from = v.map(|axis| dot(a.c, axis));
    let to = v.map(|axis| dot(b.c, axis));
    let normal = cross(a.c, b.c);
    let normal = v.map(|axis| dot(normal, axis));
    let (d2, e2, g2) = (l1 - l2, l1 - l3, l2 - l3);
    let (d, e, g) = (d2.sqrt(), e2.sqrt(), g2.sqrt());

    // The arc runs around v1 in the sense of the edge; atan2 sees only its ends.
    let sense = if from[0] < T::ZERO { -turns } else { turns };
    let psi = T::atan2(d * e * normal[0], d2 * from[1] * to[1] + e2 * from[2] * to[2]);
    let is_wrapped = psi * sense < T::ZERO && (psi.abs() > T::of(0.01) || dot(a.w, b.w) < T::of(0.9));
    let psi = if is_wrapped { psi + sense * T::TAU } else { psi };
    let along1 = l1 / (d * e) * psi;

    // artanh(q) / (d g), by its series where q is small: g may be zero.
    let slope = normal[1] / (d2 * from[0] * to[0] - g2 * from[2] * to[2]);
    let q = d * g * slope;
    let q2 = q * q;
    let along2 = if q2 < T::of(0.0025) {
        slope * (T::ONE + q2 * (T::of(1.0 / 3.0) + q2 * T::of(0.2)))
    } else {
        let ratio = ((T::ONE + q) / (T::ONE - q)).max(T::of(1e-30)).min(T::of(1e30));
        T::of(0.5) * ratio.ln() / (d * g)
    };

    // atan2 / (e g), likewise.
    let bottom = e2 * from[0] * to[0] + g2 * from[1] * to[1];
    let top = e * g * normal[2];
    let along3 = if bottom > T::ZERO && top.abs() < T::of(0.03) * bottom {
        let r2 = top * top / (bottom * bottom);
        normal[2] / bottom * (T::ONE - r2 * (T::of(1.0 / 3.0) - r2 * T::of(0.2)))
    } else {
        T::atan2(top, bottom) / (e * g).max(T::of(1e-30))
    };
    let sum = minus(scaled(v[0], along1), scaled(v[1], l2 * along2));
    minus(sum, scaled(v[2], l3 * along3))
}
