//! The eigenframe of a symmetric 3 x 3 matrix, without trigonometric functions.

use crate::normals::cos_of_third;
use ltcforge_fit::math::{Scalar, Triple, cross, dot, minus, plus, scaled};

/// A symmetric matrix: xx, yy, zz, xy, xz, yz.
pub(super) type Symmetric<T> = [T; 6];

/// Eigenvalues in descending order, and a right-handed frame of their eigenvectors.
pub(super) struct Eigenframe<T> {
    pub(super) values: Triple<T>,
    pub(super) vectors: [Triple<T>; 3],
}

/// The eigenframe of a matrix `K` of Frobenius norm one.
///
/// With the mean `m = tr K / 3`, `p^2 = (1 - 3 m^2) / 6` and `d = det(K - m I) / (2 p^3)`, the eigenvalues are
/// `m + 2 p cos((acos(d) + 2 pi k) / 3)` [Smith 1961]. The eigenvalue farthest from the others is `m + sign(d) 2 p g`,
/// where `g` in [sqrt(3)/2, 1] solves `4 g^3 - 3 g = |d|`, by a polynomial and Newton steps. Its eigenvector is the
/// longest cross product of two rows of `K - l I`. The eigenvalue is then replaced by the Rayleigh quotient, which
/// matters for sharp lobes. One Jacobi rotation in the perpendicular plane gives the other two.
pub(super) fn eigenframe<T: Scalar>([xx, yy, zz, xy, xz, yz]: Symmetric<T>) -> Eigenframe<T> {
    let (one, half, two, three) = (T::ONE, T::of(0.5), T::of(2.0), T::of(3.0));
    let mean = (xx + yy + zz) / three;
    let (a, b, c) = (xx - mean, yy - mean, zz - mean);
    let p2 = (a * a + b * b + c * c + two * (xy * xy + xz * xz + yz * yz)) / T::of(6.0);
    let p2 = p2.max(T::of(1e-30));
    let p = p2.sqrt();
    let determinant = a * (b * c - yz * yz) - xy * (xy * c - yz * xz) + xz * (xy * yz - b * xz);
    let d = determinant / (two * p * p2);
    let x = d.abs().min(one);
    let g = cos_of_third(x);
    let is_largest = d >= T::ZERO;
    let apart = two * p * g;
    let value = if is_largest { mean + apart } else { mean - apart };

    let rows = [[xx - value, xy, xz], [xy, yy - value, yz], [xz, yz, zz - value]];
    let normals = [cross(rows[0], rows[1]), cross(rows[0], rows[2]), cross(rows[1], rows[2])];
    let mut longest = normals[0];
    for normal in [normals[1], normals[2]] {
        if dot(normal, normal) > dot(longest, longest) {
            longest = normal;
        }
    }
    let isolated = scaled(longest, one / dot(longest, longest).max(T::of(1e-36)).sqrt());
    let image = |v: Triple<T>| {
        [xx * v[0] + xy * v[1] + xz * v[2], xy * v[0] + yy * v[1] + yz * v[2], xz * v[0] + yz * v[1] + zz * v[2]]
    };
    let value = dot(isolated, image(isolated));

    let [e, f] = perpendicular(isolated);
    let (image_e, image_f) = (image(e), image(f));
    let (ee, ef, ff) = (dot(e, image_e), dot(e, image_f), dot(f, image_f));
    let (middle, lean) = (half * (ee + ff), half * (ee - ff));
    let radius = (lean * lean + ef * ef).sqrt();
    // Half of the angle whose cosine is lean / radius and whose sine is ef / radius.
    let doubled = if radius > T::of(1e-30) { lean / radius } else { one };
    let larger = (half + half * doubled.abs()).sqrt();
    let smaller = half * ef / (radius.max(T::of(1e-30)) * larger);
    let (cos, sin) = match (doubled >= T::ZERO, ef < T::ZERO) {
        (true, _) => (larger, smaller),
        (false, false) => (smaller, larger),
        (false, true) => (-smaller, -larger),
    };
    let upper = plus(scaled(e, cos), scaled(f, sin));
    if is_largest {
        let values = [value, middle + radius, middle - radius];
        Eigenframe { values, vectors: [isolated, upper, cross(isolated, upper)] }
    } else {
        let lower = minus(scaled(f, cos), scaled(e, sin));
        let values = [middle + radius, middle - radius, value];
        Eigenframe { values, vectors: [upper, lower, cross(upper, lower)] }
    }
}

/// Two unit vectors perpendicular to a given unit vector and to each other [Duff et al. 2017].
fn perpendicular<T: Scalar>(v: Triple<T>) -> [Triple<T>; 2] {
    let sign = if v[2] < T::ZERO { -T::ONE } else { T::ONE };
    let a = -(T::ONE / (sign + v[2]));
    let b = v[0] * v[1] * a;
    [[T::ONE + sign * v[0] * v[0] * a, sign * b, -(sign * v[0])], [b, sign + v[1] * v[1] * a, -v[1]]]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn check<T: Scalar>(k: [f64; 6], tolerance: f64, as_f64: impl Fn(T) -> f64) -> Result<(), TestCaseError> {
        let norm2 = k[0] * k[0] + k[1] * k[1] + k[2] * k[2] + 2.0 * (k[3] * k[3] + k[4] * k[4] + k[5] * k[5]);
        prop_assume!(norm2 > 1e-6);
        let k = k.map(|x| x / norm2.sqrt());
        let Eigenframe { values, vectors } = eigenframe(k.map(T::of));
        let values = values.map(&as_f64);
        prop_assert!(values[0] >= values[1] - tolerance && values[1] >= values[2] - tolerance, "{values:?}");
        for (value, vector) in values.iter().zip(vectors) {
            let [x, y, z] = vector.map(&as_f64);
            let image =
                [k[0] * x + k[3] * y + k[4] * z, k[3] * x + k[1] * y + k[5] * z, k[4] * x + k[5] * y + k[2] * z];
            for (image, x) in image.into_iter().zip([x, y, z]) {
                prop_assert!((image - value * x).abs() < tolerance, "{k:?}: {values:?}");
            }
            prop_assert!((x * x + y * y + z * z - 1.0).abs() < tolerance);
        }
        let volume = as_f64(dot(vectors[0], cross(vectors[1], vectors[2])));
        prop_assert!((volume - 1.0).abs() < tolerance, "{volume}");
        Ok(())
    }

    proptest! {
        #[test]
        fn it_is_an_eigenframe(k in prop::array::uniform6(-1.0..1.0_f64), sharp in 0..3_usize) {
            // Matrices of sharp lobes have small rows and columns.
            let small = [1.0, 1e-2, 1e-4][sharp];
            let k = [k[0] * small * small, k[1], k[2], k[3] * small, k[4] * small, k[5]];
            check::<f64>(k, 1e-7, |x| x)?;
            check::<f32>(k, 2e-6, f64::from)?;
        }
    }
}
