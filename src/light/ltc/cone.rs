//! The integral of the clamped cosine over the solid angle of an ellipse, in closed form.
//!
//! Seen from the origin, the ellipse `c + cos t x + sin t y` is a cone of directions. With `S = x x^T + y y^T - c c^T`,
//! a plane through the origin with normal `n` cuts the cone if and only if `n^T S n > 0`. So the eigenvectors of `S`
//! are the cone's axes. The eigenvector of the negative eigenvalue `-l3` points along its middle. Perpendicular to this
//! axis, the cone has the half axes `sqrt(l1 / l3)` and `sqrt(l2 / l3)` at distance one: an ellipse that faces the
//! origin [Heitz and Hill 2017, for the inverse of `S`]. No plane, inverse or vertex of the ellipse is needed.
//!
//! By Stokes' theorem, the integral is `1/(2 pi)` times the integral of `(p x dp)_z / |p|^2` along the border. In the
//! frame of the cone's axes, with `a, b, g = sqrt(l1), sqrt(l2), sqrt(l3)`, the border is `p = (a cos t, b sin t, g)`
//! and
//!
//! ```text
//! p x dp/dt = (-b g cos t, -a g sin t, a b),    |p|^2 = g^2 + a^2 cos^2 t + b^2 sin^2 t
//! ```
//!
//! With `A^2 = g^2 + a^2`, `B^2 = g^2 + b^2` and `k^2 = a^2 - b^2`, its three components have the antiderivatives
//!
//! ```text
//! -b g / (A k) artanh(k sin t / A),    a g / (B k) arctan(k cos t / B),    a b / (A B) arctan(B sin t / (A cos t))
//! ```
//!
//! Over a whole turn, they add up to `a b / (A B)` along the middle, which is the form factor without a horizon. If the
//! horizon cuts the cone, the border is the cone's arc above the horizon, closed by an arc of the horizon, which adds
//! its angle. So the integral is elementary and exact in both cases. No approximation by a sphere is needed.

#![allow(clippy::neg_cmp_op_on_partial_ord, reason = "NaN counts as what the comparison denies")]

use ltcforge_fit::{
    Clip,
    math::{Scalar, Triple, cross, dot, minus, plus, scaled},
};

/// The number of Newton steps to three digits. [`Scalar::NEWTON_STEPS`] more steps follow.
const FIRST_STEPS: u32 = 3;

/// A position on the border: cosine and sine of `t`.
pub(super) type Turn<T> = [T; 2];

/// The cone of directions towards an ellipse.
#[derive(Debug, Clone, Copy)]
pub struct Cone<T> {
    /// `a >= b` and `g`, up to a common factor.
    half: [T; 2],
    height: T,
    /// Unit vectors, right-handed: along the half axes, and along the middle towards the ellipse.
    axes: [Triple<T>; 3],
    /// `n^T S n` for the horizon's normal `n`.
    cut2: T,
    /// The height of the ellipse's centre.
    z: T,
}

/// The part of a cone's border above the horizon.
#[derive(Debug, Clone, Copy)]
pub(super) enum Horizon<T> {
    /// The whole border.
    Above,
    /// No part of the border.
    Below,
    /// The arc up to `half_arc` on both sides of the highest point `top`.
    Cuts { top: Turn<T>, half_arc: Turn<T> },
}

/// An arc of the border: difference and product of the sines of its ends, difference and product of the cosines, and
/// the sine of the angle between the ends.
struct Arc<T> {
    sines: [T; 2],
    cosines: [T; 2],
    sine: T,
}

impl<T: Scalar> Cone<T> {
    /// The cone of the ellipse `centre + cos t x + sin t y`, for any two half axes; `None` for an ellipse seen edge-on
    /// or without a size.
    #[must_use]
    pub fn new(centre: Triple<T>, half_axes: [Triple<T>; 2]) -> Option<Self> {
        let size = half_axes.iter().chain([&centre]).flatten().fold(T::ZERO, |size, x| size.max(x.abs()));
        if !(size > T::ZERO) {
            return None;
        }
        let [x, y, c] = [half_axes[0], half_axes[1], centre].map(|v| v.map(|component| component / size));
        let (x_y, y_c, c_x) = (cross(x, y), cross(y, c), cross(c, x));
        let volume = dot(c, x_y).abs();
        // The characteristic polynomial of -S is l^3 + trace l^2 + minors l - volume^2.
        let trace = dot(x, x) + dot(y, y) - dot(c, c);
        let minors = dot(x_y, x_y) - dot(y_c, y_c) - dot(c_x, c_x);
        let l3 = largest_root(trace, minors, volume * volume);
        if !(l3 > T::ZERO && volume > T::ZERO) {
            return None;
        }
        // S + l3 has the eigenvalue zero along the middle, so its adjugate is a multiple of middle middle^T. It is
        // computed from cross products, because for needles the elements of S + l3 lose the small eigenvalues.
        let column = |i: usize| {
            let of_s: Triple<T> = std::array::from_fn(|j| x[i] * x[j] + y[i] * y[j] - c[i] * c[j]);
            let mut column: Triple<T> =
                std::array::from_fn(|j| x_y[i] * x_y[j] - y_c[i] * y_c[j] - c_x[i] * c_x[j] - l3 * of_s[j]);
            column[i] = column[i] + l3 * (trace + l3);
            column
        };
        let columns: [Triple<T>; 3] = std::array::from_fn(column);
        let largest = if columns[0][0] > columns[1][1] {
            if columns[0][0] > columns[2][2] { 0 } else { 2 }
        } else if columns[1][1] > columns[2][2] {
            1
        } else {
            2
        };
        let middle = unit_of_any(columns[largest])?;
        let middle = if dot(middle, c) < T::ZERO { scaled(middle, -T::ONE) } else { middle };
        let (e, f) = across(middle);
        // S in the plane across the middle, and the rotation that diagonalises it.
        let of_s = |u: Triple<T>, v: Triple<T>| dot(u, x) * dot(v, x) + dot(u, y) * dot(v, y) - dot(u, c) * dot(v, c);
        let (ee, ef, ff) = (of_s(e, e), of_s(e, f), of_s(f, f));
        let half = T::of(0.5);
        let (mean, difference) = (half * (ee + ff), half * (ee - ff));
        let spread = (difference * difference + ef * ef).sqrt();
        let l1 = (mean + spread).max(T::ZERO);
        // The product of the eigenvalues is volume^2.
        let l2 = (volume * (volume / (l3 * l1).max(T::SHORTEST * T::SHORTEST))).min(l1);
        let [cos, sin] = half_angle(difference, ef, spread);
        let first = plus(scaled(e, cos), scaled(f, sin));
        let second = cross(middle, first);
        Some(Self {
            half: [l1.sqrt(), l2.sqrt()],
            height: l3.sqrt(),
            axes: [first, second, middle],
            cut2: x[2] * x[2] + y[2] * y[2] - c[2] * c[2],
            z: c[2],
        })
    }

    /// The part of the clamped cosine inside of the cone, in [0, 1].
    #[must_use]
    pub fn covered(&self) -> T {
        let part = match self.horizon() {
            Horizon::Above => self.whole() * self.axes[2][2],
            Horizon::Below => T::ZERO,
            Horizon::Cuts { top, half_arc } => self.cut(top, half_arc) / T::TAU,
        };
        part.max(T::ZERO).min(T::ONE)
    }

    /// The length of the cone's vector form factor without a horizon, and the cosine between the form factor and the
    /// normal. With [`ltcforge_fit::clipped_form_factor`] they approximate the light above the horizon by the light of
    /// a sphere.
    #[must_use]
    pub fn form_factor(&self) -> (T, T) {
        (self.whole(), self.axes[2][2])
    }

    fn whole(&self) -> T {
        let ([a, b], g) = (self.half, self.height);
        a / (g * g + a * a).sqrt() * (b / (g * g + b * b).sqrt())
    }

    /// The part of the border above the horizon.
    pub(super) fn horizon(&self) -> Horizon<T> {
        if !(self.cut2 > T::ZERO) {
            return if self.z > T::ZERO { Horizon::Above } else { Horizon::Below };
        }
        // The border's height is m cos(t - top) + g n3 with m^2 = cut^2 + (g n3)^2.
        let ([a, b], g, [n1, n2, n3]) = (self.half, self.height, self.heights());
        Horizon::Cuts { top: unit_turn([a * n1, b * n2]), half_arc: unit_turn([-g * n3, self.cut2.sqrt()]) }
    }

    /// `2 pi` times the integral over a cone that the horizon cuts. The border's arc begins and ends half an arc from
    /// its top, so all differences can be written as products.
    fn cut(&self, [top_cos, top_sin]: Turn<T>, [q, h]: Turn<T>) -> T {
        let ([a, b], g, [n1, n2, n3]) = (self.half, self.height, self.heights());
        let two = T::of(2.0);
        let square = |x: T| x * x;
        let arc = Arc {
            sines: [two * h * top_cos, square(top_sin * q) - square(top_cos * h)],
            cosines: [-two * h * top_sin, square(top_cos * q) - square(top_sin * h)],
            sine: two * q * h,
        };
        // The arc of the horizon between the two crossings, from the sine and cosine of its angle.
        let sine = b * g * (n1 * top_cos).abs() + a * g * (n2 * top_sin).abs() + a * b * (n3 * q).abs();
        let cosine = g * g + a * a * arc.cosines[1] + b * b * arc.sines[1];
        self.along(&arc) + T::atan2_upper(two * h * sine, cosine)
    }

    /// The heights of the axes above the horizon.
    fn heights(&self) -> Triple<T> {
        self.axes.map(|axis| axis[2])
    }

    /// The direction of a position on the border.
    pub(super) fn direction(&self, [cos, sin]: Turn<T>) -> Triple<T> {
        let [first, second, middle] = self.axes;
        plus(plus(scaled(first, self.half[0] * cos), scaled(second, self.half[1] * sin)), scaled(middle, self.height))
    }

    /// The position of a direction on the border.
    pub(super) fn turn_of(&self, direction: Triple<T>) -> Turn<T> {
        let [a, b] = self.half;
        unit_turn([dot(direction, self.axes[0]) * b, dot(direction, self.axes[1]) * a])
    }

    /// The integral of `(p x dp)_z / |p|^2` along the border, anticlockwise from the first position to the second. It
    /// is zero for equal positions.
    pub(super) fn border(&self, [cos_0, sin_0]: Turn<T>, [cos_1, sin_1]: Turn<T>) -> T {
        self.along(&Arc {
            sines: [sin_1 - sin_0, sin_0 * sin_1],
            cosines: [cos_1 - cos_0, cos_0 * cos_1],
            sine: cos_0 * sin_1 - sin_0 * cos_1,
        })
    }

    fn along(&self, arc: &Arc<T>) -> T {
        let ([a, b], g, [n1, n2, n3]) = (self.half, self.height, self.heights());
        let (a_g2, b_g2) = (g * g + a * a, g * g + b * b);
        let (a_g, b_g) = (a_g2.sqrt(), b_g2.sqrt());
        let k = ((a - b) * (a + b)).max(T::ZERO).sqrt();
        let sines = artanh_over(k / a_g, arc.sines) / a_g;
        let cosines = arctan_over(k / b_g, arc.cosines) / b_g;
        let turned = T::atan2(a_g * b_g * arc.sine, a_g2 * arc.cosines[1] + b_g2 * arc.sines[1]);
        let turned = if turned < T::ZERO { turned + T::TAU } else { turned };
        n3 * (a / a_g) * (b / b_g) * turned - n1 * (b * g / a_g) * sines + n2 * (a * g / b_g) * cosines
    }
}

impl<T: Scalar> Cone<T> {
    /// Adds the part of the border above the horizon to a clipped outline. The border goes anticlockwise from the
    /// outline's last vertex to `vertex`.
    pub(super) fn add_border(&self, clip: &mut Clip<T>, vertex: Triple<T>) {
        let (from, to) = (self.turn_of(clip.previous()), self.turn_of(vertex));
        let (from_is_up, to_is_up) = (clip.previous()[2] > T::ZERO, vertex[2] > T::ZERO);
        let add = |clip: &mut Clip<T>, from: Turn<T>, to: Turn<T>| {
            clip.border([from, to].map(|turn| self.direction(turn)), self.border(from, to));
        };
        match self.horizon() {
            Horizon::Cuts { top, half_arc: [cos, sin] } => {
                let rise = [top[0] * cos + top[1] * sin, top[1] * cos - top[0] * sin];
                let dip = [top[0] * cos - top[1] * sin, top[1] * cos + top[0] * sin];
                let reaches = |crossing| round(from, crossing) < round(from, to);
                let (leaves, enters) = match (from_is_up, to_is_up) {
                    (true, true) | (false, false) => (reaches(dip), reaches(rise)),
                    (true, false) => (true, false),
                    (false, true) => (false, true),
                };
                // A border with two crossings either begins above and dips, or rises and then dips.
                if leaves {
                    clip.leave(self.direction(dip));
                }
                if enters {
                    clip.enter(self.direction(rise));
                }
                match (leaves, enters) {
                    (false, false) if !from_is_up => {}
                    (true, true) if from_is_up => {
                        add(clip, from, dip);
                        add(clip, rise, to);
                    }
                    _ => add(clip, if enters { rise } else { from }, if leaves { dip } else { to }),
                }
            }
            Horizon::Above => add(clip, from, to),
            Horizon::Below => {}
        }
        clip.go_to(vertex);
    }
}

/// A monotonic measure of the angle from one position anticlockwise to another, from 0 to 4.
pub(super) fn round<T: Scalar>(from: Turn<T>, to: Turn<T>) -> T {
    let cos = from[0] * to[0] + from[1] * to[1];
    let sin = from[0] * to[1] - from[1] * to[0];
    if sin < T::ZERO { T::of(3.0) + cos } else { T::ONE - cos }
}

/// The positive root of `l^3 + trace l^2 + minors l - last`. The other roots are real and not positive.
///
/// Newton's method from above. The polynomial is convex beyond its largest root, so the values decrease and stop at the
/// last digit. The start is the smaller of two bounds, one of which is close if the root is simple. The first is
/// `2 r - trace / 3`, because all roots are within `2 r` of their mean. The second, for a positive trace, is the root
/// of the polynomial without its cubic term.
fn largest_root<T: Scalar>(trace: T, minors: T, last: T) -> T {
    let third = T::ONE / T::of(3.0);
    let r = (trace * trace - T::of(3.0) * minors).max(T::ZERO).sqrt() * third;
    let mut root = T::of(2.0) * r - trace * third;
    if trace > T::ZERO {
        let discriminant = (minors * minors + T::of(4.0) * trace * last).sqrt();
        // This form has no difference of two positive numbers.
        let bound = if minors > T::ZERO {
            T::of(2.0) * last / (minors + discriminant)
        } else {
            (discriminant - minors) / (T::of(2.0) * trace)
        };
        root = root.min(bound);
    }
    for _ in 0..T::NEWTON_STEPS + FIRST_STEPS {
        let value = ((root + trace) * root + minors) * root - last;
        let slope = (T::of(3.0) * root + T::of(2.0) * trace) * root + minors;
        let next = root - value / slope;
        if !(next < root && next > T::ZERO) {
            break;
        }
        root = next;
    }
    root
}

/// `artanh(k s_1) - artanh(k s_0)` divided by `k`, from the difference and the product of both `s`. For `k` zero it is
/// the difference. Domain: `k |s|` up to one.
fn artanh_over<T: Scalar>(k: T, [difference, product]: [T; 2]) -> T {
    let bottom = T::ONE - k * k * product;
    let tangent = (k * difference).abs() / bottom.max(T::SHORTEST);
    let tangent2 = tangent * tangent;
    // The logarithm of numbers near one loses digits.
    let value = if tangent2 < T::of(0.01) {
        [15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0, 1.0].into_iter().fold(T::ZERO, |sum, n| sum * tangent2 + T::of(1.0 / n))
    } else {
        let less = (T::ONE - tangent).max(T::UNCERTAINTY * T::UNCERTAINTY);
        T::of(0.5) * ((T::ONE + tangent) / less).ln() / tangent
    };
    difference / bottom.max(T::SHORTEST) * value
}

/// `arctan(k c_1) - arctan(k c_0)` divided by `k`, from the difference and the product of both `c`. For `k` zero it is
/// the difference.
fn arctan_over<T: Scalar>(k: T, [difference, product]: [T; 2]) -> T {
    let bottom = T::ONE + k * k * product;
    if k > T::UNCERTAINTY { T::atan2(k * difference, bottom) / k } else { difference }
}

/// Cosine and sine of half of the angle of `(x, y)`, in the right half plane. The vector has the length `length`.
fn half_angle<T: Scalar>(x: T, y: T, length: T) -> Turn<T> {
    if !(length > T::ZERO) {
        return [T::ONE, T::ZERO];
    }
    let [cos, sin] = if x > T::ZERO { unit_turn([x + length, y]) } else { unit_turn([y.abs(), length - x]) };
    if x > T::ZERO || y > T::ZERO { [cos, sin] } else { [cos, -sin] }
}

/// A position of unit length; the angle zero for a zero vector.
fn unit_turn<T: Scalar>([x, y]: Turn<T>) -> Turn<T> {
    let size = x.abs().max(y.abs());
    if !(size > T::ZERO) {
        return [T::ONE, T::ZERO];
    }
    let (x, y) = (x / size, y / size);
    let length = (x * x + y * y).sqrt();
    [x / length, y / length]
}

/// The unit vector of a vector of any length, also if its square underflows.
fn unit_of_any<T: Scalar>(v: Triple<T>) -> Option<Triple<T>> {
    let size = v[0].abs().max(v[1].abs()).max(v[2].abs());
    if !(size > T::ZERO) {
        return None;
    }
    let v = v.map(|x| x / size);
    Some(scaled(v, T::ONE / dot(v, v).sqrt()))
}

/// Two unit vectors perpendicular to `n` and each other. The first is horizontal unless `n` is vertical.
fn across<T: Scalar>(n: Triple<T>) -> (Triple<T>, Triple<T>) {
    let flat = (n[0] * n[0] + n[1] * n[1]).sqrt();
    let e = if flat > T::UNCERTAINTY { [-n[1] / flat, n[0] / flat, T::ZERO] } else { [T::ONE, T::ZERO, T::ZERO] };
    let e = minus(e, scaled(n, dot(n, e)));
    (e, cross(n, e))
}
