//! The quantities that a renderer computes for a pixel.

use super::ShaderTable;
use ltcforge_fit::{LobeModel, SecondLobe};
use ltcforge_light::{ClosedForm, LightModel, NormalsRule};

/// The renderer calls this between parts of a picture. It returns true to stop.
pub type Stop<'a> = &'a dyn Fn() -> bool;

/// The quantity of each pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Estimator {
    /// Radiance by a model without a table.
    ClosedForm(ClosedForm),
    /// Radiance by a table with lobes of this kind.
    Table(LobeModel),
    /// Radiance by a table with two LTCs per entry.
    TwoLobes(SecondLobe),
    /// Radiance by Monte Carlo integration.
    Reference,
    /// The lobe in the table.
    TableLobe,
    /// The lobe of the scattering model.
    ReferenceLobe,
}

impl Estimator {
    /// The estimator for light by a model. `rule` selects the rule of model `normals`. For a model with a table, the
    /// table's lobes select the estimator.
    #[must_use]
    pub fn of(model: LightModel, rule: NormalsRule, table: &ShaderTable) -> Self {
        // No shader has the exact integrals, so `fine` replaces this rule.
        let rule = if NormalsRule::SHADED.contains(&rule) { rule } else { NormalsRule::Fine };
        let by_table = || table.second().map_or(Self::Table(table.lobe), Self::TwoLobes);
        model.closed_form(Some(rule)).map_or_else(by_table, Self::ClosedForm)
    }

    /// The cost of a pixel in samples of the reference. The reference itself takes `spp` samples.
    pub(super) fn cost(self, spp: u32) -> u32 {
        match self {
            Self::Reference => spp,
            Self::ClosedForm(form) => form.model().cost(),
            Self::Table(lobe) => LightModel::of_lobe(lobe).table_cost(),
            Self::TwoLobes(_) => 2 * LightModel::Ltc.table_cost(),
            Self::TableLobe | Self::ReferenceLobe => LightModel::Ltc.table_cost(),
        }
    }

    /// Whether the estimator only supports polygons. A polygon then replaces any other shape.
    pub(super) fn is_of_polygons(self) -> bool {
        match self {
            Self::Table(lobe) => lobe.gaussian().is_some(),
            Self::ClosedForm(form) => !form.model().is_of_ltcs(),
            _ => false,
        }
    }

    /// Whether the estimator computes a lobe instead of radiance.
    pub(super) fn is_lobe(self) -> bool {
        matches!(self, Self::TableLobe | Self::ReferenceLobe)
    }
}
