//! Solvers: methods that minimise a distance, one file or folder each.
//!
//! A new solver needs a file and a line in [`Solver`].

mod bfgs;
mod objective;
mod sgd;

pub(super) use objective::{Effort, Objective, SolverRules};

pub(super) use bfgs::Guess;

use super::named_list::named_list;

named_list! {
    /// How a distance is minimised.
    pub enum Solver: SolverRules {
        /// BFGS on the seven free numbers, over fixed low-discrepancy samples.
        Bfgs = "bfgs" => bfgs::Rules,
        /// Stochastic gradient descent on all nine numbers, over random samples [KT et al. 2022, Algorithm 3].
        Sgd = "sgd" => sgd::Rules,
    }
}
