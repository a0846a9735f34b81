//! Arcs of great circles, beyond their chords.

use ltcforge_fit::math::{Scalar, Triple, cross, dot, minus, plus, scaled};

/// `a x b (acos(a . b) / |a x b| - 1)`: what the arc of a great circle from `a` to `b` adds to `a x b`.
///
/// Beyond a right angle it is computed from the supplement.
pub(super) fn arc_bend<T: Scalar>(a: Triple<T>, b: Triple<T>) -> Triple<T> {
    let across = cross(a, b);
    let is_acute = dot(a, b) >= T::ZERO;
    let chord = if is_acute { minus(a, b) } else { plus(a, b) };
    let bend = acute_bend(dot(chord, chord));
    let bend = if is_acute {
        bend
    } else {
        // pi / sin - (pi - angle) / sin, and - 1.
        T::TAU * T::of(0.5) / dot(across, across).max(T::of(1e-18)).sqrt() - bend - T::of(2.0)
    };
    scaled(across, bend)
}

/// An angle over its sine, less one, by the square of its chord, for up to a right angle: [0, 2].
///
/// With `z` a quarter of that, half of the versed sine, it is
/// `asin(sqrt z) / sqrt(z (1 - z)) - 1 = 2/3 z + 8/15 z^2 + ...`; here a polynomial that is 6e-7 off at most. It is
/// finite beyond, but too small: by 2 % of itself at 120 degrees.
fn acute_bend<T: Scalar>(chord2: T) -> T {
    let z = chord2 * T::of(0.25);
    let series = [0.529_126_37, 0.524_055_84, -0.089_545_56, 2.271_551, -3.406_860_7, 3.516_457_1];
    let [c1, c2, c3, c4, c5, c6] = series.map(T::of);
    z * (T::of(0.666_755_35) + z * (c1 + z * (c2 + z * (c3 + z * (c4 + z * (c5 + z * c6))))))
}
