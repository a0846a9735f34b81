//! From fitted matrices to stored ones: a representative of each distribution that varies smoothly.

use glam::DMat3;

use super::target::Mirrors;
use crate::math::rotation_from_z;

/// The matrix of the same distribution whose first two columns are turned so that, seen along the third, their
/// block is symmetric and positive definite.
///
/// `M R_z` makes the same distribution as `M` for every rotation `R_z`, and so does `M diag(1, -1, 1)`
/// [KT et al. 2022, section 5]; neither moves the third column. With `M = R M'`, `R` the smallest rotation that
/// takes +z to that column's direction, `det M'` is the upper-left block's determinant times a length, so the block
/// has a positive determinant where M has, and exactly one rotation, its polar factor, makes it symmetric and
/// positive definite. It is continuous in M. The paper's choice, nearest to the identity, jumps where a lobe is far
/// from the pole. Domain: `M` regular, its third column not along -z.
pub(super) fn align(m: &DMat3, mirrors: Mirrors) -> DMat3 {
    let frame = rotation_from_z(m.z_axis.normalize());
    let mut local = frame.transpose() * *m;
    if local.determinant() < 0.0 {
        local.y_axis = -local.y_axis;
    }
    let (x, y) = (local.x_axis, local.y_axis);
    let (cos, sin) = (x.x + y.y, x.y - y.x);
    // Zero only for a block without positive determinant.
    let length = (cos * cos + sin * sin).sqrt();
    if length > 0.0 {
        let (cos, sin) = (cos / length, sin / length);
        local.x_axis = x * cos - y * sin;
        local.y_axis = x * sin + y * cos;
    }
    symmetrised(frame * local, mirrors)
}

/// Zeros where the lobe's mirror symmetries demand them [KT et al. 2022, equation 16].
fn symmetrised(mut m: DMat3, mirrors: Mirrors) -> DMat3 {
    for (axis, mirrored) in [mirrors.x, mirrors.y].into_iter().enumerate() {
        for other in (0..3).filter(|other| mirrored && *other != axis) {
            m.col_mut(axis)[other] = 0.0;
            m.col_mut(other)[axis] = 0.0;
        }
    }
    m
}
