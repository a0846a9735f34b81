//! Converts fitted matrices to stored matrices. The stored matrix varies smoothly with the distribution.

use glam::DMat3;

use crate::{brdf::Mirrors, math::rotation_from_z};

/// Turns the first two columns of a matrix about the third, such that their block is symmetric and positive definite.
/// The distribution does not change.
///
/// For every rotation `R_z`, `M R_z` has the same distribution as `M`, and so has `M diag(1, -1, 1)` [KT et al. 2022,
/// section 5]. Neither changes the third column. Let `M = R M'`, where `R` is the smallest rotation from +z to the
/// direction of the third column. Then `det M'` is the determinant of the upper-left block times a length, so the block
/// has a positive determinant if `M` has one. Exactly one rotation, the block's polar factor, makes the block symmetric
/// and positive definite. This rotation is continuous in `M`. The paper chooses the matrix nearest to the identity.
/// This choice jumps for lobes far from the pole. Domain: `M` regular, its third column not along -z.
///
/// The block is widened until the ratio of its eigenvalues is at least `flattest`.
#[must_use]
pub fn align(m: &DMat3, mirrors: Mirrors, flattest: f64) -> DMat3 {
    let frame = rotation_from_z(m.z_axis.normalize());
    let mut local = frame.transpose() * *m;
    if local.determinant() < 0.0 {
        local.y_axis = -local.y_axis;
    }
    symmetrised(frame * widened(turned(local), flattest), mirrors)
}

/// The matrix `K^-1 M` between a lobe's reflection `K` and its matrix `M`. It is widened like an aligned matrix. Its
/// first two columns are turned such that their upper block is symmetric.
///
/// `K` is smooth, so the result is as continuous as the result of [`align`].
pub(crate) fn align_to(reflection: &DMat3, m: &DMat3, mirrors: Mirrors, flattest: f64) -> DMat3 {
    symmetrised(turned(align(&(reflection.inverse() * *m), mirrors, flattest)), mirrors)
}

/// Turns the first two columns by the polar factor of their upper block. The block becomes symmetric. It also becomes
/// positive definite if its determinant is positive.
#[must_use]
pub fn turned(mut local: DMat3) -> DMat3 {
    let (x, y) = (local.x_axis, local.y_axis);
    let (cos, sin) = (x.x + y.y, x.y - y.x);
    // The length is zero only if the determinant of the block is not positive.
    let length = (cos * cos + sin * sin).sqrt();
    if length > 0.0 {
        let (cos, sin) = (cos / length, sin / length);
        local.x_axis = x * cos - y * sin;
        local.y_axis = x * sin + y * cos;
    }
    local
}

/// Widens the block of a lobe that is nearly a line. Adds to its diagonal until the smaller eigenvalue reaches
/// `flattest` times the larger eigenvalue.
fn widened(mut m: DMat3, flattest: f64) -> DMat3 {
    let (xx, xy, yy) = (m.x_axis.x, m.x_axis.y, m.y_axis.y);
    let (half_trace, half_difference) = (0.5 * (xx + yy), 0.5 * (xx - yy));
    let larger = half_trace + (half_difference * half_difference + xy * xy).sqrt();
    let smaller = (xx * yy - xy * xy) / larger;
    let lacking = (flattest * larger - smaller).max(0.0);
    m.x_axis.x += lacking;
    m.y_axis.y += lacking;
    m
}

/// Sets elements to zero as the lobe's mirror symmetries require [KT et al. 2022, equation 16].
fn symmetrised(mut m: DMat3, mirrors: Mirrors) -> DMat3 {
    for (axis, mirrored) in [mirrors.x, mirrors.y].into_iter().enumerate() {
        for other in (0..3).filter(|other| mirrored && *other != axis) {
            m.col_mut(axis)[other] = 0.0;
            m.col_mut(other)[axis] = 0.0;
        }
    }
    m
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use proptest::prelude::*;

    use super::*;

    const NO_MIRRORS: Mirrors = Mirrors { x: false, y: false };

    fn regular() -> impl Strategy<Value = DMat3> {
        prop::array::uniform9(-1.0..1.0)
            .prop_map(|numbers| DMat3::from_cols_array(&numbers))
            .prop_filter("regular, third column away from -z", |m| {
                m.determinant().abs() > 1e-3 && m.z_axis.normalize().z > -0.9
            })
    }

    proptest! {
        #[test]
        fn every_matrix_of_a_distribution_aligns_to_the_same_one(m in regular(), angle in 0.0..6.3, flip in any::<bool>()) {
            let flip = DMat3::from_diagonal(DVec3::new(1.0, if flip { -1.0 } else { 1.0 }, 1.0));
            let other = m * flip * DMat3::from_rotation_z(angle);
            prop_assert!(align(&m, NO_MIRRORS, 1e-9).abs_diff_eq(align(&other, NO_MIRRORS, 1e-9), 1e-9));
        }

        #[test]
        fn aligned_blocks_are_symmetric_and_positive_definite(m in regular()) {
            let aligned = align(&m, NO_MIRRORS, 1e-9);
            prop_assert!(aligned.determinant() > 0.0);
            let local = rotation_from_z(aligned.z_axis.normalize()).transpose() * aligned;
            prop_assert!((local.x_axis.y - local.y_axis.x).abs() < 1e-12);
            prop_assert!(local.x_axis.x > 0.0 && local.x_axis.x * local.y_axis.y > local.x_axis.y * local.y_axis.x);
        }
    }

    #[test]
    fn mirrors_leave_exact_zeros() {
        let m = DMat3::from_cols(DVec3::new(0.4, 1e-9, 0.1), DVec3::new(1e-9, 0.3, 1e-9), DVec3::new(-0.5, 1e-9, 0.8));
        let aligned = align(&m, Mirrors { x: false, y: true }, 1e-9);
        assert_eq!([aligned.x_axis.y, aligned.y_axis.x, aligned.y_axis.z, aligned.z_axis.y], [0.0; 4]);
        assert!(aligned.x_axis.z != 0.0 && aligned.z_axis.x != 0.0);
    }
}
