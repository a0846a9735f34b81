//! The interface of a solver and its input.

use glam::{DMat3, DVec3};

use super::simplex::Simplex;
use crate::{
    brdf::Brdf,
    lobe::LobeModel,
    metric::{Loss, Metric, Target},
    stop_check::StopCheck,
};

/// How long and how finely to search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Effort {
    /// The distance that is minimised.
    pub(crate) metric: Metric,
    /// Samples of lobe and LTC in each step.
    pub(crate) samples: usize,
    /// Directions that the samples are projected on.
    pub(crate) directions: usize,
    /// Most steps.
    pub(crate) steps: u32,
    /// Seed of random numbers.
    pub(crate) seed: u64,
}

/// A lobe whose matrix is sought.
pub(crate) struct Objective<'a> {
    /// The model whose numbers are sought: one that the solver finds, see [`super::Solver::finds`].
    pub(crate) model: LobeModel,
    /// The surface.
    pub(crate) brdf: &'a dyn Brdf,
    /// View direction.
    pub(crate) wo: DVec3,
    /// The lobe's samples.
    pub(crate) target: &'a Target,
    /// The distance to the target.
    pub(crate) loss: &'a mut dyn Loss,
    /// How hard to try.
    pub(crate) effort: Effort,
    /// Chooses the random numbers of solvers that draw any.
    pub(crate) stream: u64,
    /// The choices of a solver with a simplex.
    pub(crate) simplex: Simplex,
    /// The matrix of a lobe next to this one, each in the frame of its own lobe, for solvers that start from one.
    pub(crate) near: Option<DMat3>,
}

/// A solver as an item of [`super::Solver`].
pub(crate) trait SolverRules: Sync {
    /// The matrix of the lobe in the tangent frame; `None` when `stop_check` stops the search.
    fn solve(&self, objective: Objective<'_>, stop_check: &mut StopCheck) -> Option<DMat3>;

    /// Seconds that an entry takes to project its lobe, to search, and to measure the error, with at most
    /// `effort.steps` steps. Of one thread, on the machine of `fit_seconds`.
    fn seconds(&self, lobe: LobeModel, effort: &Effort) -> f64;

    /// Whether it fits lobes of isotropic surfaces only.
    fn is_isotropic(&self) -> bool {
        false
    }

    /// Whether it has a simplex, for which a recipe may choose shear and start.
    fn has_simplex(&self) -> bool {
        false
    }
}
