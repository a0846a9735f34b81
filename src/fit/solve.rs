//! One lobe's matrix by BFGS.
//!
//! With `M = B (I + A)`, `B` a first guess, `A` needs seven numbers: its upper-left block is symmetric, which takes
//! out the rotation about z that leaves a clamped cosine unchanged, and its last element is zero, which takes out
//! the scale. Where the lobe has a mirror symmetry, the numbers that would break it are not free.

use glam::{DMat3, DVec3};

use super::{
    bfgs::{Limits, VARIABLES, Vector, minimise},
    loss::{Loss, Workspace},
    target::Mirrors,
};

/// Position of each variable in `A`, as (row, column); the second stands for its mirror image too.
const PLACES: [(usize, usize); VARIABLES] = [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 0), (2, 1)];

/// `I + A` for the seven numbers.
fn correction(a: &Vector) -> DMat3 {
    let [xx, xy, yy, xz, yz, zx, zy] = *a;
    DMat3::from_cols(DVec3::new(1.0 + xx, xy, zx), DVec3::new(xy, 1.0 + yy, zy), DVec3::new(xz, yz, 1.0))
}

/// The numbers that a lobe with these symmetries leaves free: those with an even count of each mirrored axis.
fn free_variables(mirrors: Mirrors) -> [bool; VARIABLES] {
    PLACES.map(|(row, column)| {
        let odd = |axis: usize| (row == axis) != (column == axis);
        !(mirrors.x && odd(0) || mirrors.y && odd(1))
    })
}

/// What the samples do not see of a tilt, and its derivatives by `A20` and `A21`.
///
/// A tilt `t = (A20, A21)` turns the part `|t|^2 / 4` of the cosine past the horizon of the lobe's frame, from
/// where it is thrown to the lobe's far side, a distance of about one. Of `n` samples none lies there until
/// `n |t|^2 / 4 > 1`; a sharp lobe, which hardly feels the tilt otherwise, would be left with a speck of light
/// behind it that moves its mean by more than it is wide. The unseen part, `|t|^2 / (4 (1 + n |t|^2))`, is added.
fn unseen_tilt(a: &Vector, samples: usize) -> (f64, [f64; 2]) {
    let [.., zx, zy] = *a;
    let tilt2 = zx * zx + zy * zy;
    let seen = 1.0 + samples as f64 * tilt2;
    let by_tilt2 = 0.25 / (seen * seen);
    (0.25 * tilt2 / seen, [2.0 * zx * by_tilt2, 2.0 * zy * by_tilt2])
}

/// The matrix near `guess` with the lowest loss. Both map cosine space to the lobe's frame.
pub(super) fn refine(loss: &Loss, guess: &DMat3, mirrors: Mirrors, limits: Limits, work: &mut Workspace) -> DMat3 {
    // In units of the lobe's width, so that one set of step lengths serves sharp and broad lobes.
    let inv_spread = 1.0 / loss.spread();
    let guess_transposed = guess.transpose();
    let lowest = minimise([0.0; VARIABLES], free_variables(mirrors), limits, |a| {
        let m = *guess * correction(a);
        // A mirrored or flattened LTC is the same distribution as an upright one; keep to the upright side.
        if m.determinant() <= 0.0 {
            return (f64::INFINITY, [0.0; VARIABLES]);
        }
        let (value, by_m) = loss.value_and_gradient(&m, work);
        let by_a = guess_transposed * by_m;
        let mut gradient = PLACES.map(|(row, column)| by_a.col(column)[row]);
        gradient[1] += by_a.col(0)[1];
        let (unseen, [by_zx, by_zy]) = unseen_tilt(a, loss.samples());
        gradient[5] += by_zx;
        gradient[6] += by_zy;
        ((value + unseen) * inv_spread, gradient.map(|slope| slope * inv_spread))
    });
    *guess * correction(&lowest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        fit::{align::align, guess, loss::CosineSamples, target::tests::planted},
        math::{fibonacci_hemisphere, lattice2},
    };

    const LIMITS: Limits = Limits { steps: 100, relative_decrease: 1e-6 };

    fn fitted(matrix: DMat3, mirrors: Mirrors) -> DMat3 {
        let target = planted(matrix, mirrors);
        let samples = CosineSamples::new(2048, |i| lattice2(i, 2048, [0.0, 0.0]));
        let directions: Vec<DVec3> = (0..24).map(|i| fibonacci_hemisphere(i, 24, 0.0)).collect();
        let loss = Loss::new(&target, &samples, &directions);
        let guess = guess::from_core(&target.core);
        target.frame * refine(&loss, &guess, mirrors, LIMITS, &mut Workspace::default())
    }

    /// The representative that scale and gauge do not change.
    fn canonical(m: DMat3, mirrors: Mirrors) -> DMat3 {
        let aligned = align(&m, mirrors);
        aligned * (1.0 / aligned.z_axis.length())
    }

    #[test]
    fn a_planted_matrix_is_recovered_up_to_its_invariances() {
        let cases = [
            (DVec3::new(0.5, 0.1, 0.2), DVec3::new(-0.1, 0.3, 0.1), DVec3::new(-0.6, 0.2, 0.8)),
            (DVec3::new(0.05, 0.0, 0.02), DVec3::new(0.01, 0.02, 0.0), DVec3::new(-0.7, -0.5, 0.4)),
            (DVec3::new(1e-3, 0.0, 0.0), DVec3::new(0.0, 2e-4, 0.0), DVec3::new(0.6, 0.0, 0.8)),
        ];
        for (x, y, z) in cases {
            let (planted, mirrors) = (DMat3::from_cols(x, y, z), Mirrors { x: false, y: false });
            let (wanted, found) = (canonical(planted, mirrors), canonical(fitted(planted, mirrors), mirrors));
            // Within 3 % of the lobe's own width, column by column.
            let width = wanted.x_axis.length().max(wanted.y_axis.length());
            assert!(found.abs_diff_eq(wanted, 0.03 * width), "{wanted}\n{found}");
        }
    }

    #[test]
    fn mirrored_lobes_keep_their_zeros_without_being_told_afterwards() {
        let planted =
            DMat3::from_cols(DVec3::new(0.4, 0.0, 0.1), DVec3::new(0.0, 0.2, 0.0), DVec3::new(-0.5, 0.0, 0.8));
        let found = fitted(planted, Mirrors { x: false, y: true });
        assert_eq!([found.x_axis.y, found.y_axis.x, found.y_axis.z, found.z_axis.y], [0.0; 4]);
    }

    #[test]
    fn symmetric_lobes_have_four_or_two_free_numbers() {
        let count = |x, y| free_variables(Mirrors { x, y }).into_iter().filter(|free| *free).count();
        assert_eq!([count(false, false), count(true, false), count(false, true), count(true, true)], [7, 4, 4, 2]);
    }
}
