//! The paper's alignment (equation 12).

use std::f64::consts::TAU;

use glam::{DMat3, DVec3};
use ltcforge::fit::math::{Lattice, cosine_hemisphere, sin_cos};

/// Sample directions of a cosine.
const SAMPLES: usize = 64;
/// Angles of a full turn.
const ANGLES: u32 = 720;

/// The paper's alignment: samples of a cosine, and the angles of the search.
#[derive(Debug)]
pub(super) struct Nearest {
    samples: Vec<DVec3>,
    /// Sine and cosine of each angle.
    angles: Vec<(f64, f64)>,
}

impl Nearest {
    pub(super) fn new() -> Self {
        let angle = |i: u32| sin_cos(TAU * f64::from(i) / f64::from(ANGLES));
        Self {
            samples: Lattice::new(SAMPLES, [0.0; 2]).points().map(cosine_hemisphere).collect(),
            angles: (0..ANGLES).map(angle).collect(),
        }
    }

    /// The mean squared distance by which a matrix moves the samples of a cosine, `E |M w / |M w| - w|^2` [KT et al.
    /// 2022, equation 12]. Domain: `m` is regular.
    pub(super) fn distance(&self, m: &DMat3) -> f64 {
        let moved = |w: &DVec3| ((*m * *w).normalize() - *w).length_squared();
        self.samples.iter().map(moved).sum::<f64>() / self.samples.len() as f64
    }

    /// The matrix `M R_z F` with the least [`Nearest::distance`], found by a linear search over the angle of `R_z` as
    /// in the paper. All these matrices have the same distribution. Two of the four flips `F` are enough, because the
    /// other two differ from them by half a turn. If several matrices are equally near, it returns the first.
    pub(super) fn align(&self, m: &DMat3) -> DMat3 {
        let candidates = [1.0, -1.0].into_iter().flat_map(|flip| self.angles.iter().map(move |angle| (flip, *angle)));
        let turned = candidates.map(|(flip, (sin, cos))| {
            let (x, y) = (m.x_axis, m.y_axis);
            DMat3::from_cols(x * cos + y * sin, (y * cos - x * sin) * flip, m.z_axis)
        });
        let nearer = |(best, least): (DMat3, f64), candidate: DMat3| {
            let distance = self.distance(&candidate);
            if distance < least { (candidate, distance) } else { (best, least) }
        };
        turned.fold((*m, f64::INFINITY), nearer).0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A lobe around a direction that is 0.6 radians from the normal.
    fn lobe() -> DMat3 {
        DMat3::from_rotation_y(0.6) * DMat3::from_diagonal(DVec3::new(0.5, 0.2, 1.0))
    }

    fn apart(a: &DMat3, b: &DMat3) -> f64 {
        (*a - *b).to_cols_array().into_iter().map(f64::abs).fold(0.0, f64::max)
    }

    #[test]
    fn turned_and_flipped_matrices_are_restored() {
        let nearest = Nearest::new();
        assert!(apart(&nearest.align(&DMat3::IDENTITY), &DMat3::IDENTITY) == 0.0);
        let aligned = nearest.align(&lobe());
        for (angle, flips) in [(1.0, [1.0, 1.0]), (2.5, [-1.0, 1.0]), (-0.7, [1.0, -1.0]), (4.0, [-1.0, -1.0])] {
            let flip = DMat3::from_diagonal(DVec3::new(flips[0], flips[1], 1.0));
            let other = nearest.align(&(lobe() * DMat3::from_rotation_z(angle) * flip));
            // The tolerance is one step of the search.
            assert!(apart(&other, &aligned) < TAU / f64::from(ANGLES), "turned by {angle}, {flips:?}");
        }
    }

    /// This test tries all four flips, and angles other than those of the search.
    #[test]
    fn no_other_matrix_of_the_same_distribution_is_nearer() {
        let nearest = Nearest::new();
        let turned = lobe() * DMat3::from_rotation_z(1.3);
        let least = nearest.distance(&nearest.align(&turned));
        assert!(nearest.distance(&turned) > 1.5 * least);
        for i in 0..100 {
            for (x, y) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
                let flip = DMat3::from_diagonal(DVec3::new(x, y, 1.0));
                let other = turned * DMat3::from_rotation_z(0.0628 * f64::from(i)) * flip;
                assert!(nearest.distance(&other) > least - 1e-4, "{i} {x} {y}");
            }
        }
    }
}
