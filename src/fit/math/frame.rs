//! Rotations and symmetric 2 x 2 matrices.

use glam::{DMat2, DMat3, DVec2, DVec3};

use super::sin_cos;

/// The unit vector at polar angle `theta` and azimuth `phi`. It lies exactly in a coordinate plane at quarter turns of
/// `phi`.
#[must_use]
pub fn direction(theta: f64, phi: f64) -> DVec3 {
    let ((sin_theta, cos_theta), (sin_phi, cos_phi)) = (sin_cos(theta), sin_cos(phi));
    DVec3::new(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta)
}

/// The smallest rotation from +z to the unit vector `axis`.
///
/// With `c = axis.z`, the columns are `(1 - x^2/(1+c), -xy/(1+c), -x)`, `(-xy/(1+c), 1 - y^2/(1+c), -y)`, `axis`. If x
/// or y of `axis` is zero, the corresponding elements of the matrix are exactly zero. Domain: `axis.z > -1`.
#[must_use]
pub fn rotation_from_z(axis: DVec3) -> DMat3 {
    let DVec3 { x, y, z } = axis;
    let k = 1.0 / (1.0 + z);
    DMat3::from_cols(DVec3::new(1.0 - x * x * k, -x * y * k, -x), DVec3::new(-x * y * k, 1.0 - y * y * k, -y), axis)
}

/// `R_z(angle) M R_z(-angle)`: the matrix of a lobe after surface and view turn about z together.
#[must_use]
pub fn turned_about_z(m: DMat3, angle: f64) -> DMat3 {
    let (sin, cos) = sin_cos(angle);
    let turn = DMat3::from_cols(DVec3::new(cos, sin, 0.0), DVec3::new(-sin, cos, 0.0), DVec3::Z);
    turn * m * turn.transpose()
}

/// The square root of a symmetric positive semi-definite 2 x 2 matrix.
///
/// `sqrt(A) = (A + sqrt(det A) I) / sqrt(tr A + 2 sqrt(det A))` (Cayley-Hamilton). Zero for the zero matrix.
#[must_use]
pub fn symmetric_sqrt(a: DMat2) -> DMat2 {
    let root_det = a.determinant().max(0.0).sqrt();
    let scale = (a.x_axis.x + a.y_axis.y + 2.0 * root_det).sqrt();
    if scale > 0.0 { (a + DMat2::from_diagonal(DVec2::splat(root_det))) * (1.0 / scale) } else { DMat2::ZERO }
}

/// The nine numbers of a matrix, row-major.
#[must_use]
pub fn row_major(m: &DMat3) -> [f64; 9] {
    m.transpose().to_cols_array()
}

/// The matrix of nine numbers, row-major.
#[must_use]
pub fn from_row_major(numbers: &[f64; 9]) -> DMat3 {
    DMat3::from_cols_array(numbers).transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotation_takes_z_to_the_axis_and_is_orthonormal() {
        for axis in [DVec3::Z, DVec3::X, DVec3::new(0.6, 0.0, 0.8), DVec3::new(-0.48, 0.6, 0.64)] {
            let r = rotation_from_z(axis);
            assert!((r * DVec3::Z - axis).length() < 1e-15);
            assert!((r.determinant() - 1.0).abs() < 1e-15);
            assert!((r.transpose() * r).abs_diff_eq(DMat3::IDENTITY, 1e-15));
        }
        assert_eq!(rotation_from_z(DVec3::new(0.6, 0.0, 0.8)).x_axis.y, 0.0);
    }

    #[test]
    fn square_root_squares_back() {
        for (xx, xy, yy) in [(4.0, 1.0, 3.0), (1e-12, 0.0, 1.0), (2.0, -1.9, 2.0), (0.0, 0.0, 0.0)] {
            let a = DMat2::from_cols(DVec2::new(xx, xy), DVec2::new(xy, yy));
            let root = symmetric_sqrt(a);
            assert!((root * root).abs_diff_eq(a, 1e-15), "{a}");
        }
    }
}
