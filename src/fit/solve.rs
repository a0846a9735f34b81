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
    let minimum = minimise([0.0; VARIABLES], free_variables(mirrors), limits, |a| {
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
    *guess * correction(&minimum.point)
}
