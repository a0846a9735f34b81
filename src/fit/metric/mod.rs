//! Distances between a lobe and an LTC that a fit can minimise, one file each, and the lobe as they see it.
//!
//! A new metric is its file and its line in [`Metric`].

mod distance;
mod sw1;
mod target;

pub(super) use distance::{Distance, Loss, MetricRules, Samples};
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
