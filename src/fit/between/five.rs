//! The five numbers of a matrix that are not zero for an isotropic surface.

use glam::DMat3;

/// Column and row of each of the five numbers. The lobe is symmetric about the plane of incidence, so the others are
/// zero.
pub(super) const ELEMENTS: [[usize; 2]; 5] = [[0, 0], [0, 2], [1, 1], [2, 0], [2, 2]];

pub(super) fn numbers(matrix: &DMat3) -> [f64; 5] {
    ELEMENTS.map(|[column, row]| matrix.col(column)[row])
}

pub(super) fn matrix(numbers: &[f64; 5]) -> DMat3 {
    let mut matrix = DMat3::ZERO;
    for (number, [column, row]) in numbers.iter().zip(ELEMENTS) {
        matrix.col_mut(column)[row] = *number;
    }
    matrix
}
