//! The integral of `c x dc` along the image of a light's edge, in closed form.
//!
//! Proof. In the frame of K's eigenvectors the cone is `l1 x^2 = p y^2 + q z^2`, with `p = -l2` and `q = -l3`. With
//! `Y = sqrt(l1 / p)`, `Z = sqrt(l1 / q)` and the sign `sx` of x, the arc is `P(t) = (sx, Y cos t, Z sin t)` up to scale.
//! Then `r x dr = P x P' / |P|^2 dt`, with `P x P' = (Y Z, -sx Z cos t, -sx Y sin t)`. Let `D = sqrt(l1 - l2)`,
//! `E = sqrt(l1 - l3)` and `G = sqrt(l2 - l3)`. The integral is elementary; brackets are differences between the ends:
//!
//! ```text
//! along v1     l1 / (D E) [angle of (D y, E z)]
//! along v2     l2 / (D G) [artanh(G z / (D x))]
//! along v3    -l3 / (E G) [arctan(G y / (E x))]
//! ```
//!
//! The addition theorems combine each bracket into one angle. With `N = a x c`, its sine is `D E N1 / l1`, `D G N2 / p`
//! (hyperbolic) or `E G N3 / q`. Unit vectors of the cone satisfy `D^2 y^2 + E^2 z^2 = l1`, `D^2 x^2 - G^2 z^2 = p` and
//! `E^2 x^2 + G^2 y^2 = q`. So the cosine is `m_i`, and the components of the integral are `psi(m_i) N_i`.

use super::cone::EdgeCone;
use crate::normals::outline::Corner;
use ltcforge_fit::math::{Scalar, Triple, cross, dot, minus, plus, scaled};

/// The contribution of the edge from `a` to `b` to the integral of `c x dc`, without the plane triangle's `a.c x b.c`.
///
/// The integral around a light is the sum of these contributions. The plane part is summed separately, around an origin
/// near the light, because it cancels to a small area for a small light.
pub(super) fn curved_part<T: Scalar>(alpha: [T; 2], wo: Triple<T>, a: &Corner<T>, b: &Corner<T>) -> Triple<T> {
    let apart = minus(b.w, a.w);
    if dot(apart, apart) < T::SAME2 {
        return [T::ZERO; 3];
    }
    minus(exact(alpha, wo, a, b, apart), cross(a.c, b.c))
}

/// The integral of `c x dc` along an edge's image, from `a.c` to `b.c`.
///
/// An edge lies on `w . n = 0`, `n = a x b`. With `w = 2 (h . wo) h - wo`, its normals `h` lie on the cone
/// `h^T (wo n^T + n wo^T - k I) h = 0`, `k = wo . n`, and their images `c` lie on the cone of [`EdgeCone`]. The
/// integral is `psi(M) (a.c x b.c)` with `M = (a.c . b.c) I - (a.c . K b.c) K^-1` and `psi` of [`per_sine`].
/// `docs/normals.md` has the derivation.
///
/// Along K's first eigenvector `psi` is the angle around the cone divided by its sine. The angle can exceed half a
/// turn. It has the direction of the edge. If its cosine is negative, it is written as half a turn plus an angle that
/// is zero at exactly half a turn.
fn exact<T: Scalar>(alpha: [T; 2], wo: Triple<T>, a: &Corner<T>, b: &Corner<T>, apart: Triple<T>) -> Triple<T> {
    // Replaces a x b, whose rounding errors are as large as the errors of a and b.
    let n = cross(a.w, apart);
    let sense = if dot(wo, n) < T::ZERO { -T::ONE } else { T::ONE };
    let cone = EdgeCone::new(alpha, wo, scaled(n, sense));
    let [first, second, third] = cone.values;
    let axis = cone.axis();
    let per_axis2 = T::ONE / dot(axis, axis).max(T::of(1e-36));

    // The components of a x b along each of K's eigenvectors.
    let normal = cross(a.c, b.c);
    let on_axis = dot(axis, normal);
    let rest = minus(normal, scaled(axis, on_axis * per_axis2));
    let shifted = minus(cone.image(rest), scaled(rest, second));
    let level = minus(shifted, scaled(axis, dot(shifted, axis) * per_axis2));
    // If the two eigenvalues are equal, any division between their eigenvectors is valid.
    let gap = (second - third).max(-T::UNCERTAINTY * third);
    let on_third = scaled(level, -T::ONE / gap);
    let on_second = minus(rest, on_third);

    // The eigenvalues of M.
    let apart2 = dot(apart, apart);
    let bend = cone.bend([a.length, b.length], apart2);
    let ends = dot(a.c, b.c);
    let [cos_first, cos_second, cos_third] = [second * third, first * third, first * second].map(|x| ends - bend * x);

    let by_angle = first / ((first - second) * (first - third)).sqrt();
    let per_axis = per_axis2.sqrt();
    let beside = on_axis * per_axis;
    let acute = per_sine(cos_first.abs().min(T::ONE));
    // A short edge never runs nearly all around the axis. An angle against the direction of the edge is a rounding
    // error.
    let is_short = apart2 < T::of(1e3) * T::UNCERTAINTY * T::UNCERTAINTY;
    let is_far = apart2 > T::of(0.2) || !is_short && beside.abs() > T::of(0.01) * by_angle;
    let along_first = if cos_first < T::ZERO {
        sense * T::of(0.5) * T::TAU * by_angle - acute * beside
    } else if beside * sense < T::ZERO && is_far {
        sense * T::TAU * by_angle + acute * beside
    } else {
        acute * beside
    };
    let sharp = per_sine(cos_third.abs().min(T::ONE));
    let along_third = if cos_third < T::ZERO {
        let sine2 = (first - third) * gap * dot(on_third, on_third);
        -T::of(0.5) * T::TAU * third / sine2.max(T::of(1e-36)).sqrt() - sharp
    } else {
        sharp
    };
    let sum = plus(scaled(axis, along_first * per_axis), scaled(on_second, per_sine(cos_second.max(T::ONE))));
    plus(sum, scaled(on_third, along_third))
}

/// `psi(x) = acos(x) / sqrt(1 - x^2)`, the angle divided by its sine, as a function of the cosine. For `x > 1` it
/// continues as `ln(x + sqrt(x^2 - 1)) / sqrt(x^2 - 1)`. Domain: x >= 0.
///
/// `psi` is smooth at one. Near one, it is a series in `1 - x`, with the factor `(n + 1) / (2 n + 3)` from term to
/// term.
fn per_sine<T: Scalar>(x: T) -> T {
    let v = T::ONE - x;
    if v.abs() < T::of(0.02) {
        let next = |sum: T, n: u32| T::ONE + sum * v * T::of(f64::from(n + 1) / f64::from(2 * n + 3));
        return (0..9).rev().fold(T::ONE, next);
    }
    let sine = (v.abs() * (T::ONE + x)).sqrt();
    if v > T::ZERO { T::atan2(sine, x) / sine } else { (x + sine).ln() / sine }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::normals::view::View;
    use ltcforge_fit::math::{direction, unit};

    /// Compares with inverse functions of the standard library, on both sides of one and of the ends of the series.
    #[test]
    fn an_angle_per_sine_is_that_of_the_standard_library() {
        for x in [0.0, 0.3, 0.9, 0.97, 0.9801, 0.985, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 1.015, 1.0199, 1.03, 2.0, 50.0, 1e6]
        {
            let expected = match x {
                1.0 => 1.0,
                x if x < 1.0 => f64::acos(x) / (1.0 - x * x).sqrt(),
                x => f64::acosh(x) / (x * x - 1.0).sqrt(),
            };
            // The standard library loses digits near one.
            let tolerance = if (x - 1.0_f64).abs() < 1e-6 { 1e-7 } else { 1e-13 };
            assert!((per_sine(x) - expected).abs() < tolerance * expected, "{x}: {} {expected}", per_sine(x));
            let single = f64::from(per_sine(x as f32));
            assert!((single - expected).abs() < 3e-6 * expected.max(1e-3), "{x}: {single} {expected}");
        }
    }

    /// Tests short edges near the centre of lobes, many at grazing angles. If the angle is small, a rounding error must
    /// not add a whole turn. (In f32, an edge through the exact centre, where the angle is pi, can pass on the other
    /// side of the centre.)
    #[test]
    fn short_edges_have_no_whole_turns_in_f32() {
        let fraction = |i: u32, step: f64| (f64::from(i) * step).fract();
        let mut small = 0;
        for i in 1..=400_000 {
            let [a, b, c, d, e, f, g] =
                [0.754_877_67, 0.569_840_29, 0.438_447_19, 0.309_016_99, 0.221_232_9, 0.672_9, 0.829_47]
                    .map(|s| fraction(i, s));
            let alpha = [10_f64.powf(-4.0 * a), 10_f64.powf(-4.0 * a - b).max(1e-5)];
            let wo = direction((10_f64.powf(-3.0 * c)).acos(), std::f64::consts::TAU * d).to_array();
            let normal = direction(e.sqrt().asin(), std::f64::consts::TAU * f).to_array();
            let h = unit([alpha[0] * normal[0], alpha[1] * normal[1], normal[2]]);
            let wi = minus(scaled(h, 2.0 * dot(h, wo)), wo);
            let along = scaled(unit(cross(wi, direction(g.acos(), 7.0 * g).to_array())), 10_f64.powf(-6.9 + 3.0 * g));
            let single = |v: Triple<f64>| v.map(|x| x as f32);
            let view = View::new(alpha, wo);
            let ends = [minus(wi, along), plus(wi, along)].map(|v| Corner::new(&view, v));
            let singles = [minus(wi, along), plus(wi, along)]
                .map(|v| Corner::new(&View::new(alpha.map(|x| x as f32), single(wo)), single(v)));
            let exact = curved_part(alpha, wo, &ends[0], &ends[1]);
            let found = curved_part(alpha.map(|x| x as f32), single(wo), &singles[0], &singles[1]).map(f64::from);
            if dot(exact, exact) < 0.1 {
                let off = minus(found, exact);
                assert!(dot(off, off) < 1.0, "{i}: {alpha:?} {wo:?} {along:?} {found:?} {exact:?}");
                small += 1;
            }
        }
        assert!(small > 300_000, "{small}");
    }
}
