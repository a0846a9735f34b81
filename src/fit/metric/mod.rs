//! Distances between a lobe and an LTC that a fit can minimise, one file each, and the samples of the lobe that they
//! compare.
//!
//! A new metric needs a file and a line in [`Metric`].

mod distance;
mod sw1;
mod target;

pub(super) use distance::{Distance, Grain, Loss, MetricRules, Samples};
#[cfg(test)]
pub(super) use target::tests::planted;
pub(super) use target::{LobeCore, Target};

use super::named_list::named_list;

named_list! {
    /// The distance between lobe and LTC that a fit minimises.
    pub enum Metric: MetricRules {
        /// Sliced Wasserstein-1 distance [KT et al. 2022, equation 9].
        Sw1 = "sw1" => sw1::Rules,
    }
}
