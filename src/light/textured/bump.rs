//! A bump `(1 + Q)^-2` on the plane of a light.

use ltcforge_fit::math::Scalar;

/// A symmetric matrix: xx, xy, yy.
pub(super) type Symmetric<T> = [T; 3];

/// `(1 + Q)^-2` with `Q = x^2 / radii2[0] + y^2 / radii2[1]`. x and y are the components of a point's offset from the
/// centre, along `long` and across it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bump<T> {
    /// The centre, in the rectangle's coordinates.
    pub(super) middle: [T; 2],
    /// The direction of the longer axis, of unit length.
    pub(super) long: [T; 2],
    /// The squared radii, the longer first.
    pub(super) radii2: [T; 2],
}

/// The smallest value of the quadratic function at its minimum, relative to its value at the expanded point. For a lobe
/// expanded far from its centre, the expansion can be negative.
const LEAST_BOTTOM: f64 = 0.1;

impl<T: Scalar> Bump<T> {
    /// The bump whose inverse square root is a quadratic function. Its gradient and second derivatives are given at
    /// `p`, both divided by the value there. Eigenvalues below `least` are raised to it.
    ///
    /// Let w be the eigenvalues and g the components of the gradient along their eigenvectors. The minimum is at
    /// `-g / w` and has the value `1 - sum g^2 / 2 w`. From there the function grows by `w d^2 / 2`.
    pub(super) fn of_derivatives(p: [T; 2], gradient: [T; 2], second: Symmetric<T>, least: T) -> Self {
        let (values, long) = eigen(second);
        let [w1, w2] = values.map(|value| value.max(least));
        let short = across(long);
        let [g1, g2] = [long, short].map(|axis| dot2(gradient, axis));
        let middle = step(step(p, -g1 / w1, long), -g2 / w2, short);
        let fall = T::of(0.5) * (g1 * g1 / w1 + g2 * g2 / w2);
        let twice = T::of(2.0) * (T::ONE - fall).max(T::of(LEAST_BOTTOM));
        Self { middle, long, radii2: [twice / w1, twice / w2] }
    }

    /// Q at a point.
    pub(super) fn quadratic(&self, p: [T; 2]) -> T {
        let d = [p[0] - self.middle[0], p[1] - self.middle[1]];
        let (x, y) = (dot2(d, self.long), dot2(d, across(self.long)));
        x * x / self.radii2[0] + y * y / self.radii2[1]
    }
}

/// The eigenvalues of a symmetric matrix, the smaller first, and the eigenvector of the smaller eigenvalue.
pub(super) fn eigen<T: Scalar>([xx, xy, yy]: Symmetric<T>) -> ([T; 2], [T; 2]) {
    let half = T::of(0.5);
    let (mean, apart) = (half * (xx + yy), half * (xx - yy));
    let distance = (apart * apart + xy * xy).sqrt();
    // Of the two rows of the matrix minus the eigenvalue, this uses the row whose elements do not cancel.
    let v = if apart > T::ZERO { [-xy, apart + distance] } else { [distance - apart, -xy] };
    let length = dot2(v, v).sqrt();
    let long = if length > T::SHORTEST { v.map(|x| x / length) } else { [T::ONE, T::ZERO] };
    ([mean - distance, mean + distance], long)
}

/// The scalar product of two vectors.
pub(super) fn dot2<T: Scalar>(a: [T; 2], b: [T; 2]) -> T {
    a[0] * b[0] + a[1] * b[1]
}

/// `p + by v`.
pub(super) fn step<T: Scalar>(p: [T; 2], by: T, v: [T; 2]) -> [T; 2] {
    [p[0] + by * v[0], p[1] + by * v[1]]
}

/// The vector turned by a right angle.
pub(super) fn across<T: Scalar>(v: [T; 2]) -> [T; 2] {
    [-v[1], v[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eigenvectors_come_back() {
        for [xx, xy, yy] in [[2.0, 0.5, 1.0], [1.0, -0.5, 2.0], [1.0, 0.0, 1.0], [3.0, 1e-9, -1.0], [-1.0, 1e-9, 3.0]] {
            let ([small, large], long) = eigen([xx, xy, yy]);
            for (value, v) in [(small, long), (large, across(long))] {
                let found: [f64; 2] = [xx * v[0] + xy * v[1], xy * v[0] + yy * v[1]];
                assert!((0..2).all(|i| (found[i] - value * v[i]).abs() < 1e-12), "{xx} {xy} {yy}: {found:?} {v:?}");
            }
            assert!(small <= large && (dot2(long, long) - 1.0).abs() < 1e-12);
        }
    }

    /// A quadratic function is recovered from its derivatives at a point.
    #[test]
    fn a_planted_bump_is_found() {
        let planted = Bump { middle: [0.3, -0.2], long: [0.6, 0.8], radii2: [0.5_f64, 0.04] };
        let p = [0.45, 0.1];
        let value = 1.0 + planted.quadratic(p);
        let short = across(planted.long);
        let d = [p[0] - planted.middle[0], p[1] - planted.middle[1]];
        let [a, b] = planted.radii2;
        let slopes = [2.0 * dot2(d, planted.long) / a, 2.0 * dot2(d, short) / b];
        let gradient = [0, 1].map(|i| (slopes[0] * planted.long[i] + slopes[1] * short[i]) / value);
        let second = [(0, 0), (0, 1), (1, 1)]
            .map(|(i, j)| 2.0 * (planted.long[i] * planted.long[j] / a + short[i] * short[j] / b) / value);
        let found = Bump::of_derivatives(p, gradient, second, 1e-9);
        assert!((0..2).all(|i| (found.middle[i] - planted.middle[i]).abs() < 1e-12), "{found:?}");
        assert!((0..2).all(|i| (found.radii2[i] / planted.radii2[i] - 1.0).abs() < 1e-12), "{found:?}");
        assert!((dot2(found.long, planted.long).abs() - 1.0).abs() < 1e-12, "{found:?}");
    }
}
