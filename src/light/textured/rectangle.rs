//! A rectangle with a picture, in its own coordinates.

use ltcforge_fit::math::{Scalar, Triple, cross, dot, minus, plus, scaled};

/// The smallest sine of the angle at which a ray meets a plane.
const LEAST_DESCENT: f64 = 1e-4;

/// A rectangle relative to the shaded point. Its coordinates are lengths along its sides from its first corner, which
/// has the picture's first texel. u goes to the second corner, v to the fourth.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rectangle<T> {
    /// The first corner.
    pub(super) corner: Triple<T>,
    /// The directions of its sides, of unit length.
    pub(super) axes: [Triple<T>; 2],
    /// The lengths of its sides.
    pub(super) size: [T; 2],
}

impl<T: Scalar> Rectangle<T> {
    /// Domain: the corners of a rectangle with positive sides. The third corner is not used.
    pub(super) fn new(corners: &[Triple<T>; 4]) -> Self {
        let sides = [minus(corners[1], corners[0]), minus(corners[3], corners[0])];
        let size = sides.map(|side| dot(side, side).sqrt().max(T::SHORTEST));
        Self { corner: corners[0], axes: [0, 1].map(|i| scaled(sides[i], T::ONE / size[i])), size }
    }

    /// The area.
    pub(super) fn area(&self) -> T {
        self.size[0] * self.size[1]
    }

    /// The point with these coordinates.
    pub(super) fn at(&self, p: [T; 2]) -> Triple<T> {
        plus(self.corner, plus(scaled(self.axes[0], p[0]), scaled(self.axes[1], p[1])))
    }

    /// The components of a vector along the sides.
    pub(super) fn along(&self, v: Triple<T>) -> [T; 2] {
        self.axes.map(|axis| dot(axis, v))
    }

    /// The nearest point of the rectangle.
    pub(super) fn clamped(&self, p: [T; 2]) -> [T; 2] {
        [0, 1].map(|i| p[i].max(T::ZERO).min(self.size[i]))
    }

    /// The point of the rectangle nearest to where the ray of a direction meets its plane. A ray that leaves the plane
    /// is treated as meeting it far away, in its direction along the plane.
    pub(super) fn met(&self, direction: Triple<T>) -> [T; 2] {
        let normal = cross(self.axes[0], self.axes[1]);
        let distance = dot(self.corner, normal);
        let sign = if distance < T::ZERO { -T::ONE } else { T::ONE };
        let length = dot(direction, direction).sqrt();
        let descent = (sign * dot(direction, normal)).max(T::of(LEAST_DESCENT) * length).max(T::SHORTEST);
        let point = scaled(direction, sign * distance / descent);
        self.clamped(self.along(minus(point, self.corner)))
    }
}
