//! The interface of a solver and its input.

use glam::{DMat3, DVec3};

use super::simplex::Simplex;
use crate::{
    brdf::Brdf,
    lobe::LobeModel,
    metric::{Loss, Metric, Target},
    stop_check::StopCheck,
};

/// The effort of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Effort {
    /// The distance that the search minimises.
    pub(crate) metric: Metric,
    /// Samples of lobe and LTC in each step.
    pub(crate) samples: usize,
    /// Directions of the projections.
    pub(crate) directions: usize,
    /// The largest number of steps.
    pub(crate) steps: u32,
    /// Seed of random numbers.
    pub(crate) seed: u64,
}

/// The lobe of a search.
pub(crate) struct Objective<'a> {
    /// The model of the lobe. The solver must be able to fit it, see [`super::Solver::finds`].
    pub(crate) model: LobeModel,
    /// The surface.
    pub(crate) brdf: &'a dyn Brdf,
    /// View direction.
    pub(crate) wo: DVec3,
    /// The lobe's samples.
    pub(crate) target: &'a Target,
    /// The distance to the target.
    pub(crate) loss: &'a mut dyn Loss,
    /// The effort of the search.
    pub(crate) effort: Effort,
    /// Selects the random numbers of solvers that draw any.
    pub(crate) stream: u64,
    /// The settings of a solver with a simplex.
    pub(crate) simplex: Simplex,
    /// The matrix of a neighbouring lobe, in the frame of that lobe, for solvers that start from a given matrix.
    pub(crate) near: Option<DMat3>,
}

/// A solver as an item of [`super::Solver`].
pub(crate) trait SolverRules: Sync {
    /// The matrix of the lobe in the tangent frame; `None` if `stop_check` stops the search.
    fn solve(&self, objective: Objective<'_>, stop_check: &mut StopCheck) -> Option<DMat3>;

    /// Seconds that an entry takes for the projections of its lobe, the search with at most `effort.steps` steps, and
    /// the measured error. Measured with one thread on the machine of `fit_seconds`.
    fn seconds(&self, lobe: LobeModel, effort: &Effort) -> f64;

    /// True if the solver fits only isotropic surfaces.
    fn is_isotropic(&self) -> bool {
        false
    }

    /// True if the solver has a simplex, for which a recipe can set shear and start.
    fn has_simplex(&self) -> bool {
        false
    }
}
