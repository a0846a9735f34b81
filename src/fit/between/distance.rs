//! The displacement of a lobe when the stored numbers of its matrix change.

use glam::{DMat3, DVec3};

use super::five::{ELEMENTS, matrix};
use crate::{layout::FreeNumbers, math::concentric_cosine};

/// The number of rings into which the clamped cosine is divided. Rings are divided into sectors, and each sector of a
/// ring has one direction.
const RINGS: usize = 3;
const SECTORS: usize = 4;

/// The matrix of a quadratic form in the five numbers.
pub(super) type QuadraticForm = [[f64; 5]; 5];

/// Directions distributed like a clamped cosine.
pub(super) struct Displacement {
    cosines: Vec<DVec3>,
}

impl Displacement {
    pub(super) fn new() -> Self {
        let middle = |i: usize, n: usize| (i as f64 + 0.5) / n as f64;
        let cosine = |i: usize| concentric_cosine([middle(i / SECTORS, RINGS), middle(i % SECTORS, SECTORS)]);
        Self { cosines: (0..RINGS * SECTORS).map(cosine).collect() }
    }

    /// The mean square displacement of a lobe, as a quadratic form in the changes of the five numbers of its stored
    /// matrix. The row and the column of the fixed number are zero.
    pub(super) fn form(&self, stored: &DMat3, free: FreeNumbers) -> QuadraticForm {
        let inverse = stored.inverse();
        let m = if free.is_inverse { &inverse } else { stored };
        let mut form = [[0.0; 5]; 5];
        for cosine in &self.cosines {
            let w = (*m * *cosine).normalize();
            // The direction of the cosine before `M` is applied, divided by its length after `M` is applied.
            let before = inverse * w;
            let moves: [DVec3; 5] = std::array::from_fn(|k| {
                let mut change = [0.0; 5];
                change[k] = if Some(ELEMENTS[k]) == free.fixed { 0.0 } else { 1.0 };
                let change = matrix(&change);
                let moved = if free.is_inverse { inverse * (change * w) } else { change * before };
                moved - w * w.dot(moved)
            });
            for (row, a) in form.iter_mut().zip(moves) {
                for (sum, b) in row.iter_mut().zip(moves) {
                    *sum += a.dot(b) / self.cosines.len() as f64;
                }
            }
        }
        form
    }

    /// The mean square displacement between the lobes of two matrices.
    pub(super) fn mean_square(&self, from: &DMat3, to: &DMat3) -> f64 {
        let moved = |cosine: &DVec3| ((*to * *cosine).normalize() - (*from * *cosine).normalize()).length_squared();
        self.cosines.iter().map(moved).sum::<f64>() / self.cosines.len() as f64
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// A lobe of moderate width, in the plane of incidence.
    fn lobe() -> impl Strategy<Value = DMat3> {
        (0.1..1.0, 0.1..1.0, -0.7..0.2, -0.1..0.3, 0.6..1.0).prop_map(|(a, c, b, e, d)| matrix(&[a, e, c, b, d]))
    }

    proptest! {
        /// The expected displacement comes from applying the changed matrix.
        #[test]
        fn the_form_is_the_mean_square_of_small_moves(
            m in lobe(), change in prop::array::uniform5(-1.0..1.0), is_inverse in any::<bool>(),
        ) {
            let free = FreeNumbers { is_inverse, fixed: is_inverse.then_some([1, 1]) };
            let stored = if is_inverse { m.inverse() } else { m };
            let displacement = Displacement::new();
            let form = displacement.form(&stored, free);
            let predicted: f64 = (0..25).map(|i| change[i / 5] * form[i / 5][i % 5] * change[i % 5]).sum();
            let mut change = change;
            if is_inverse {
                change[2] = 0.0;
            }
            let step = 1e-6;
            let changed = stored + matrix(&change) * step;
            let changed = if is_inverse { changed.inverse() } else { changed };
            let found = displacement.mean_square(&m, &changed) / (step * step);
            // A direction w of the changed lobe comes from a different direction of the cosine. For inverse matrices,
            // the measured and the predicted mean therefore agree only to first order, and the step must be small.
            prop_assert!((found - predicted).abs() <= 1e-3 * predicted + 1e-6, "{found} {predicted}");
        }
    }
}
