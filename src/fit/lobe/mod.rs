//! Lobe models, one folder each. A lobe model is the distribution that represents a lobe in a table.
//!
//! A new model needs a folder and a line in [`LobeModel`].

pub mod gaussian;
pub mod ltc;
mod rules;

pub(crate) use rules::{LobeDistribution, LobeModelRules};

use super::named_list;

named_list! {
    /// The distribution that represents a lobe in a table.
    pub enum LobeModel: LobeModelRules {
        /// A linearly transformed cosine [Heitz et al. 2016].
        Ltc = "ltc" => ltc::LtcLobeModel,
        /// A spherical Gaussian, cut at the horizon.
        Sg = "sg" => gaussian::SG,
        /// An anisotropic spherical Gaussian [Xu et al. 2013], cut at the horizon.
        Asg = "asg" => gaussian::ASG,
    }
}

impl LobeModel {
    /// The distribution that the nine numbers of a lookup define; `None` if the numbers are invalid.
    pub(crate) fn distribution(self, numbers: &[f64; 9]) -> Option<Box<dyn LobeDistribution>> {
        self.rules().distribution(numbers)
    }

    /// The kind of Gaussian; `None` for models that are not Gaussians.
    #[must_use]
    pub fn gaussian(self) -> Option<gaussian::Gaussian> {
        self.rules().gaussian()
    }

    /// True for the model of recipes that do not name a model.
    #[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes a field by reference")]
    pub(crate) fn is_default(&self) -> bool {
        *self == Self::ALL[0]
    }
}
