//! One isotropic lobe's matrix by Nelder and Mead's simplex, as Heitz et al. 2016 and the code of 2017 find it.
//!
//! In the frame of the lobe's mean direction, whose y axis is perpendicular to the plane of incidence, three numbers
//! make
//!
//! ```text
//!     | m11  0  m13 |                       | m11  0   0 |
//! m = |  0  m22  0  |   for shear x,    m = |  0  m22  0 |   for shear z;    M = frame * m
//!     |  0   0   1  |                       | m31  0   1 |
//! ```
//!
//! The mean direction is the lobe's own and is not searched. That leaves one number less than the distribution has, and
//! entries that change smoothly with their lobes. Where lobes are not symmetric in a plane of incidence, three numbers
//! are too few: recipes with this solver have a ratio of one.
//!
//! The simplex searches the logarithms of `m11` and `m22` over those of the start, and the shear in units in which it
//! is of order one for every lobe: `m13` in those of `m11`, `m31` in its own. The code of 2017 searches the numbers
//! themselves, from a simplex with sides of 0.05, several hundred times the width of its sharpest lobes.

use glam::{DMat3, DVec3};

mod minimise;

use self::minimise::minimise;
use super::{
    bfgs::Guess,
    objective::{Effort, Objective, SolverRules},
    simplex::Shear,
};
use crate::{
    lobe::LobeModel,
    math::exp,
    metric::{Loss, Target},
    stop_check::StopCheck,
};

/// Side of the first simplex.
const SIDE: f64 = 0.1;
/// Evaluations until the simplex has converged, if its steps are not fewer.
const EVALUATIONS: u32 = 70;
/// Evaluations of a step.
const STEP_EVALUATIONS: f64 = 1.8;
/// Least `m11` and `m22`: far below the widths of the sharpest lobes that are fitted.
const LEAST: f64 = 1e-9;

/// The simplex as an item of [`super::Solver`].
pub(super) struct NelderMead;

impl SolverRules for NelderMead {
    fn solve(&self, objective: Objective<'_>, stop_check: &mut StopCheck) -> Option<DMat3> {
        let Objective { target, loss, effort, simplex, near, .. } = objective;
        let start = near.map_or_else(|| Numbers::guessed(target, simplex.shear), |m| Numbers::of(&m, simplex.shear));
        search(loss, start, target, effort.steps, stop_check).map(|matrix| target.frame * matrix)
    }

    fn seconds(&self, _: LobeModel, effort: &Effort) -> f64 {
        let evaluations = f64::from(effort.steps.min(EVALUATIONS)) * STEP_EVALUATIONS;
        evaluations.min(f64::from(EVALUATIONS)) * effort.metric.rules().seconds(effort.samples, effort.directions)
    }

    fn is_isotropic(&self) -> bool {
        true
    }

    fn has_simplex(&self) -> bool {
        true
    }
}

/// The three numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Numbers {
    m11: f64,
    m22: f64,
    /// `m13` or `m31`.
    skew: f64,
    shear: Shear,
}

impl Numbers {
    /// Those of the lobe's own location and scatter.
    fn guessed(target: &Target, shear: Shear) -> Self {
        let mut flat = Guess::of(&target.core).matrix();
        if shear == Shear::Z {
            // The mean direction is the frame's own: where the core lies beside it, the start's lobe does not.
            flat.z_axis = DVec3::Z;
        }
        Self::of(&flat, shear)
    }

    /// Those of a matrix in the frame of its lobe.
    fn of(m: &DMat3, shear: Shear) -> Self {
        let scale = 1.0 / m.z_axis.z;
        let skew = match shear {
            Shear::X => m.z_axis.x * scale,
            Shear::Z => m.x_axis.z * scale,
        };
        Self { m11: (m.x_axis.x * scale).max(LEAST), m22: (m.y_axis.y * scale).max(LEAST), skew, shear }
    }

    fn matrix(&self) -> DMat3 {
        let mut m = DMat3::from_diagonal(DVec3::new(self.m11, self.m22, 1.0));
        match self.shear {
            Shear::X => m.z_axis.x = self.skew,
            Shear::Z => m.x_axis.z = self.skew,
        }
        m
    }

    /// The numbers that a step of the simplex leads to.
    fn moved(&self, [x, y, skew]: [f64; 3]) -> Self {
        let unit = match self.shear {
            Shear::X => self.m11,
            Shear::Z => 1.0,
        };
        Self { m11: self.m11 * exp(x), m22: self.m22 * exp(y), skew: self.skew + unit * skew, ..*self }
    }
}

/// The matrix near `start` with the lowest loss, in the lobe's frame; `None` when `stop_check` stops the search. A lobe
/// with two mirror symmetries, seen from above, has no skew.
fn search(
    loss: &mut dyn Loss,
    start: Numbers,
    target: &Target,
    steps: u32,
    stop_check: &mut StopCheck,
) -> Option<DMat3> {
    let mut at = |moved: Numbers| loss.value(&moved.matrix(), stop_check);
    let found = if target.mirrors.x && target.mirrors.y {
        let start = Numbers { skew: 0.0, ..start };
        let [x, y] = minimise([0.0; 2], SIDE, steps, |[x, y]| at(start.moved([*x, *y, 0.0])))?;
        start.moved([x, y, 0.0])
    } else {
        start.moved(minimise([0.0; 3], SIDE, steps, |point| at(start.moved(*point)))?)
    };
    Some(found.matrix())
}

#[cfg(test)]
mod tests;
