//! Measures how well a shader can invert the stored matrices.

use rayon::prelude::*;
use serde::Serialize;

use super::places;
use crate::{Table, math::from_row_major};

/// Determinant and condition number over all entries of a table. They are computed from the matrix `M` that a lookup at
/// the node returns, scaled such that its third column has unit length.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Matrices {
    /// Entries of the table.
    pub entries: usize,
    /// Entries with a negative determinant. Their distribution is correct, but the winding of lights is reversed.
    pub negative_determinants: usize,
    /// Entries whose matrix is singular and has no distribution. Determinant and condition number below leave them out.
    pub singular: usize,
    /// Smallest and largest determinant.
    pub determinant: Extent,
    /// Smallest and largest condition number `|M| |M^-1|` in the Frobenius norm. It is 3 for a rotation, and at most 3
    /// times the condition number of the spectral norm.
    pub condition: Extent,
}

/// Smallest and largest of some numbers; both zero if there are no numbers.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Extent {
    /// Smallest.
    pub min: f64,
    /// Largest.
    pub max: f64,
}

impl Matrices {
    pub(super) fn of(table: &Table) -> Self {
        let entries = table.matrix.len();
        // Determinant and condition of each regular matrix.
        let found: Vec<Option<[f64; 2]>> = (0..entries)
            .into_par_iter()
            .map(|index| {
                let m = from_row_major(&table.lookup(&places::node(table.layout, &table.axes, index)).matrix);
                let m = m * (1.0 / m.z_axis.length());
                let inverse = m.inverse();
                let (determinant, condition) = (m.determinant(), frobenius(&m) * frobenius(&inverse));
                (determinant != 0.0 && determinant.is_finite() && condition.is_finite())
                    .then_some([determinant, condition])
            })
            .collect();
        let extent = |k: usize| Extent::of(found.iter().flatten().map(|numbers| numbers[k]));
        Self {
            entries,
            negative_determinants: found.iter().flatten().filter(|[determinant, _]| *determinant < 0.0).count(),
            singular: found.iter().filter(|numbers| numbers.is_none()).count(),
            determinant: extent(0),
            condition: extent(1),
        }
    }
}

impl Extent {
    fn of(numbers: impl Iterator<Item = f64>) -> Self {
        let widen = |extent: Option<Self>, x: f64| match extent {
            None => Some(Self { min: x, max: x }),
            Some(Self { min, max }) => Some(Self { min: min.min(x), max: max.max(x) }),
        };
        numbers.fold(None, widen).unwrap_or(Self { min: 0.0, max: 0.0 })
    }
}

/// The root of the sum of all squared elements.
fn frobenius(m: &glam::DMat3) -> f64 {
    (m.x_axis.length_squared() + m.y_axis.length_squared() + m.z_axis.length_squared()).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BrdfKind, Layout, LobeModel, PerAxis};

    #[test]
    fn negative_and_singular_matrices_are_counted_apart() {
        let axes = PerAxis { alpha: vec![0.2, 0.4, 0.6, 0.8], ratio: vec![0.5], theta: vec![0.3], phi: vec![0.2] };
        let diagonal = |a: f32, b: f32, c: f32| [a, 0.0, 0.0, 0.0, b, 0.0, 0.0, 0.0, c];
        let matrix = vec![
            diagonal(1.0, 1.0, 1.0),
            // Scaled: 0.5, 0.25, 1.
            diagonal(1.0, 0.5, 2.0),
            diagonal(0.5, -0.5, 1.0),
            diagonal(0.5, 0.0, 1.0),
        ];
        let table = Table {
            brdf: BrdfKind::Ggx.into(),
            lobe: LobeModel::Ltc,
            layout: Layout::Kt2022,
            axes,
            matrix,
            terms: None,
            second: None,
            node_error: vec![0.0; 4],
        };
        let found = Matrices::of(&table);
        assert_eq!((found.entries, found.negative_determinants, found.singular), (4, 1, 1));
        assert_eq!(found.determinant, Extent { min: -0.25, max: 1.0 });
        // |M|^2 = 1 + 1/4 + 1/16 and |M^-1|^2 = 1 + 4 + 16.
        assert!((found.condition.min - 3.0).abs() < 1e-12, "{found:?}");
        assert!((found.condition.max - f64::sqrt(1.3125 * 21.0)).abs() < 1e-12, "{found:?}");
    }
}
