//! Approximates the image of a light's edge by four arcs of great circles.

use super::{outline::Corner, view::View};
use ltcforge_fit::math::{Scalar, Triple, cross, dot, minus, plus, scaled};

/// The angle divided by its sine, as a function of `h = 1 + cosine`, up to an angle of pi:
/// `psi = (pi / sqrt 2 + a h + b h^2) / sqrt h + c + d h`. The first term is the limit near pi.
/// `cargo run -p ltcforge-studies -- polynomials` finds the numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct AnglePerSine {
    /// a and b.
    pub(super) over_root: [f64; 2],
    /// c and d.
    pub(super) plain: [f64; 2],
}

/// Relative error: at most 8e-4.
pub(super) const ROUGH: AnglePerSine =
    AnglePerSine { over_root: [0.415_202_7, 0.0], plain: [-0.972_074_3, -0.093_373_5] };
/// Relative error: at most 1.3e-4.
pub(super) const CLOSE: AnglePerSine =
    AnglePerSine { over_root: [0.505_486_3, 0.039_751_6], plain: [-0.993_498_8, -0.202_236_1] };

/// Keeps the quotient finite for an angle of pi.
const STRAIGHT: f64 = 2e-7;

impl AnglePerSine {
    /// The quotient for the angle between two unit vectors.
    pub(super) fn between<T: Scalar>(&self, a: Triple<T>, b: Triple<T>) -> T {
        let h = dot(a, b) + T::of(1.0 + STRAIGHT);
        let [a, b] = self.over_root.map(T::of);
        let [c, d] = self.plain.map(T::of);
        (T::of(std::f64::consts::PI * std::f64::consts::FRAC_1_SQRT_2) + h * (a + h * b)) / h.sqrt() + (c + h * d)
    }
}

/// The point where the two arcs of a half meet, beyond the midpoint of the chord, in multiples of the control point.
/// The multiple is the first number plus the second times the squared length of the control point.
/// `cargo run -p ltcforge-studies -- arcs` finds both.
pub const BULGE: [f64; 2] = [3.4, 0.6];
/// The squared distance below which two ends are equal in all relevant digits. The point that splits the image between
/// them then has no effect.
const NEAR2: f64 = 1e-8;

/// Keeps the control point finite for an edge through the shaded point, where `w_a + w_c` is zero. In f32 the rounding
/// of this sum has about the same effect: for an edge whose distance is 1e-6 of its length, the mean error of the
/// visible part is .001 in f64 and .005 in f32.
const STRAIGHT_EDGE: f64 = 1e-12;

/// The image of an edge, by four arcs of great circles.
#[derive(Debug, Clone, Copy)]
pub(super) struct Arcs<T> {
    /// The integral of `c x dc` along the arcs.
    pub(super) flux: Triple<T>,
    /// The point where the two halves meet, equally far from both ends.
    pub(super) middle: Triple<T>,
    /// The points between the arcs of each half, slightly outside of the image.
    pub(super) quarters: [Triple<T>; 2],
}

/// The image of the edge between two corners.
///
/// The image is a conic with the control points `a`, `b` and `c`; its ends have unit length (`docs/normals.md`, "The
/// integral of an edge"). The point n, equally far from both ends, splits it into halves. Two arcs approximate each
/// half. They meet in q, slightly outside of the half, such that they enclose the same area as the half.
pub(super) fn four_arcs<T: Scalar>(
    psi: &AnglePerSine,
    bulge: [f64; 2],
    view: &View<T>,
    from: &Corner<T>,
    to: &Corner<T>,
) -> Arcs<T> {
    let (a, c) = (from.c, to.c);
    let b = control_point(view, from, to);
    // The curve is a + 2 t b + t^2 c. Its distances to both ends are equal where (a - c) . (a + 2 t b + t^2 c) = 0.
    let apart = minus(a, c);
    let bend = dot(b, apart) / (T::of(0.5) * (dot(apart, apart) + T::of(NEAR2)));
    let t = bend + (bend * bend + T::ONE).sqrt();
    let (left, right) = (plus(a, scaled(b, t)), plus(b, scaled(c, t)));
    let middle = plus(left, scaled(right, t));
    let length = dot(middle, middle).max(T::of(1e-30)).sqrt();
    let n = scaled(middle, T::ONE / length);
    let half = |end: Triple<T>, control: Triple<T>| {
        let [least, more] = bulge.map(T::of);
        let bulge = (least + more * dot(control, control) / length) / length.sqrt();
        let q = plus(plus(end, n), scaled(control, bulge));
        scaled(q, T::ONE / dot(q, q).max(T::of(1e-30)).sqrt())
    };
    let (q, r) = (half(a, left), half(c, right));
    let flux = plus(two_arcs(psi, a, q, n), two_arcs(psi, n, r, c));
    Arcs { flux, middle: n, quarters: [q, r] }
}

/// The control point b of the image of the edge between two corners, scaled such that the ends have unit length:
/// `((y / 2 - 2) A^-1 wo + A^-1 (wo + w_a) + A^-1 (wo + w_c)) / sqrt(y L_a L_c)` with `y = |w_a + w_c|^2` and the
/// lengths L of the images before they are normalised.
fn control_point<T: Scalar>(view: &View<T>, from: &Corner<T>, to: &Corner<T>) -> Triple<T> {
    let sum = plus(from.w, to.w);
    let y = dot(sum, sum) + T::of(STRAIGHT_EDGE);
    let ends = plus(from.unscaled(), to.unscaled());
    let middle = plus(ends, scaled(view.image(view.wo), T::of(0.5) * y - T::of(2.0)));
    scaled(middle, T::ONE / (y * (from.length * to.length)).sqrt())
}

/// The integral of `c x dc` along the arcs of great circles from a to q and from q to n.
///
/// The integral is `psi(a, q) a x q + psi(q, n) q x n`, written as the product of q with a sum of differences. This
/// keeps the digits of short arcs.
fn two_arcs<T: Scalar>(psi: &AnglePerSine, a: Triple<T>, q: Triple<T>, n: Triple<T>) -> Triple<T> {
    cross(q, minus(scaled(minus(n, q), psi.between(q, n)), scaled(minus(a, q), psi.between(a, q))))
}
