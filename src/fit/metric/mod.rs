//! Distances between a lobe and an LTC that a fit can minimise, one file each, and the samples of the lobe.
//!
//! A new metric needs a file and a line in [`Metric`].

mod distance;
mod l3;
mod sw1;
mod target;

pub(super) use distance::{Distance, Draws, Grain, ImageLoss, Lobe, Loss, MetricRules, Offsets, Samples};
#[cfg(test)]
pub(super) use target::tests::{PlantedBrdf, planted, planted_directions};
pub(super) use target::{LobeCore, Target};

use super::named_list;

named_list! {
    /// The distance between lobe and LTC that a fit minimises.
    pub enum Metric: MetricRules {
        /// Sliced Wasserstein-1 distance [KT et al. 2022, equation 9].
        Sw1 = "sw1" => sw1::Sw1,
        /// The L3 norm of the difference of densities, by multiple importance sampling [Heitz et al. 2016].
        L3 = "l3" => l3::L3,
    }
}

impl Metric {
    /// True if the metric compares only samples. It then also measures models other than LTCs.
    #[must_use]
    pub fn compares_images(self) -> bool {
        self.rules().compares_images()
    }
}
