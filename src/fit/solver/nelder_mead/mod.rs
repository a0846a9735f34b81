//! Fits the matrix of one isotropic lobe with Nelder and Mead's simplex, like Heitz et al. 2016 and the published code
//! of 2017.
//!
//! The search works in the frame of the lobe's mean direction. The y axis of this frame is perpendicular to the plane
//! of incidence. Three numbers form
//!
//! ```text
//!     | m11  0  m13 |                       | m11  0   0 |
//! m = |  0  m22  0  |   for shear x,    m = |  0  m22  0 |   for shear z;    M = frame * m
//!     |  0   0   1  |                       | m31  0   1 |
//! ```
//!
//! The search does not change this frame. The matrix then has one free number fewer than the matrix of a general
//! symmetric LTC, and entries change smoothly with their lobes. Three numbers suffice only for lobes that are symmetric
//! about a plane of incidence, so recipes with this solver have a ratio of one.
//!
//! The variables of the simplex are the logarithms of `m11` and `m22` relative to the start, and the shear in a unit
//! that makes it of order one for every lobe: `m13` in units of `m11`, `m31` without a unit. The code of 2017 searches
//! the numbers directly, from a simplex with sides of 0.05, several hundred times the width of its sharpest lobes.

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

/// Side of the initial simplex.
const SIDE: f64 = 0.1;
/// Evaluations until the simplex has converged, unless the recipe allows fewer steps.
const EVALUATIONS: u32 = 70;
/// Mean number of evaluations per step.
const STEP_EVALUATIONS: f64 = 1.8;
/// The smallest `m11` and `m22`, far below the widths of the sharpest fitted lobes.
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

/// The three numbers of a matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Numbers {
    m11: f64,
    m22: f64,
    /// `m13` or `m31`.
    skew: f64,
    shear: Shear,
}

impl Numbers {
    /// The initial numbers, from the location and scatter of the lobe.
    fn guessed(target: &Target, shear: Shear) -> Self {
        let mut flat = Guess::of(&target.core).matrix();
        if shear == Shear::Z {
            // The z axis of the frame is the mean direction, so the start has no offset from this axis.
            flat.z_axis = DVec3::Z;
        }
        Self::of(&flat, shear)
    }

    /// The numbers of a matrix in the frame of its lobe.
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

    /// The numbers at a point of the simplex.
    fn moved(&self, [x, y, skew]: [f64; 3]) -> Self {
        let unit = match self.shear {
            Shear::X => self.m11,
            Shear::Z => 1.0,
        };
        Self { m11: self.m11 * exp(x), m22: self.m22 * exp(y), skew: self.skew + unit * skew, ..*self }
    }
}

/// The matrix near `start` with the lowest loss, in the lobe's frame; `None` if `stop_check` stops the search. A lobe
/// with two mirror symmetries is seen from above and has no skew.
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
