//! Arcs of great circles, without their chords.

use ltcforge_fit::math::{Scalar, Triple, cross, dot, minus, plus, scaled};

/// `a x b (acos(a . b) / |a x b| - 1)`: the integral along the great arc from `a` to `b`, minus `a x b`.
///
/// Beyond a right angle it is computed from the supplementary angle.
pub(super) fn arc_bend<T: Scalar>(a: Triple<T>, b: Triple<T>) -> Triple<T> {
    let across = cross(a, b);
    let is_acute = dot(a, b) >= T::ZERO;
    let chord = if is_acute { minus(a, b) } else { plus(a, b) };
    let bend = acute_bend(dot(chord, chord));
    let bend = if is_acute {
        bend
    } else {
        // The value is pi / sin - (pi - angle) / sin - 1.
        T::TAU * T::of(0.5) / dot(across, across).max(T::of(1e-18)).sqrt() - bend - T::of(2.0)
    };
    scaled(across, bend)
}

/// The angle divided by its sine, minus one, as a function of the squared chord in [0, 2], for up to a right angle.
///
/// With `z` a quarter of the squared chord, which is half of the versed sine, it is
/// `asin(sqrt z) / sqrt(z (1 - z)) - 1 = 2/3 z + 8/15 z^2 + ...`. The polynomial has an error of at most 6e-7. Beyond a
/// right angle it is finite but too small, by 2 % at 120 degrees.
fn acute_bend<T: Scalar>(chord2: T) -> T {
    let z = chord2 * T::of(0.25);
    let series = [0.529_126_37, 0.524_055_84, -0.089_545_56, 2.271_551, -3.406_860_7, 3.516_457_1];
    let [c1, c2, c3, c4, c5, c6] = series.map(T::of);
    z * (T::of(0.666_755_35) + z * (c1 + z * (c2 + z * (c3 + z * (c4 + z * (c5 + z * c6))))))
}
