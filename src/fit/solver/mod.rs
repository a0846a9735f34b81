//! Solvers: methods that minimise a distance, one file or folder each.
//!
//! A new solver needs a file and a line in [`Solver`].

mod bfgs;
mod nelder_mead;
mod objective;
mod sgd;
mod simplex;

pub(super) use objective::{Effort, Objective, SolverRules};

pub(super) use bfgs::{Guess, in_arrays};
pub use simplex::{Shear, Simplex, Start};

use super::{lobe::LobeModel, named_list};

named_list! {
    /// The method that minimises the distance.
    pub enum Solver: SolverRules {
        /// BFGS on the seven free numbers, over fixed low-discrepancy samples.
        Bfgs = "bfgs" => bfgs::Bfgs,
        /// Stochastic gradient descent on all nine numbers, over random samples [KT et al. 2022, Algorithm 3].
        Sgd = "sgd" => sgd::Sgd,
        /// Nelder and Mead's simplex on three numbers in the frame of the mean direction, for isotropic surfaces [Heitz
        /// et al. 2016].
        NelderMead = "nelder_mead" => nelder_mead::NelderMead,
    }
}

impl Solver {
    /// True if the solver fits only isotropic surfaces. Tables then have a ratio of one.
    #[must_use]
    pub fn is_isotropic(self) -> bool {
        self.rules().is_isotropic()
    }

    /// True if a recipe sets a shear and a start for the solver.
    #[must_use]
    pub fn has_simplex(self) -> bool {
        self.rules().has_simplex()
    }

    /// True if the solver can fit a lobe model.
    #[must_use]
    pub fn finds(self, lobe: LobeModel) -> bool {
        self == Self::Bfgs || lobe.gaussian().is_none()
    }
}
