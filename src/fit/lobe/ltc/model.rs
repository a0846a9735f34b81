//! Linearly Transformed Cosines as a lobe model.

use glam::DVec3;

use super::{Ltc, Sides};
use crate::{
    lobe::rules::{LobeDistribution, LobeModelRules},
    math::{concentric_cosine, from_row_major},
};

/// LTCs as an item of [`crate::LobeModel`]. The nine numbers are the matrix, row-major.
pub(in crate::lobe) struct LtcLobeModel;

impl LobeModelRules for LtcLobeModel {
    fn distribution(&self, numbers: &[f64; 9]) -> Option<Box<dyn LobeDistribution>> {
        Ltc::new(from_row_major(numbers)).map(|ltc| Box::new(ltc) as Box<dyn LobeDistribution>)
    }
}

impl LobeDistribution for Ltc {
    /// A report must not share code with the loss that fits minimise. The loss maps the unit square like
    /// [`Ltc::sample`], so this function uses a different map.
    fn sample(&self, u: [f64; 2]) -> DVec3 {
        (self.matrix() * concentric_cosine(u)).normalize()
    }

    fn covered(&self, polygon: &[DVec3]) -> f64 {
        self.polygon(polygon, Sides::Two)
    }
}
