//! The quantities that a renderer estimates.

use super::ShaderTable;
use ltcforge_fit::{LobeModel, SecondLobe};
use ltcforge_light::{ClosedForm, LightModel, NormalsRule};

/// Called between parts of a picture; returns whether to stop.
pub type Stop<'a> = &'a dyn Fn() -> bool;

/// The estimated quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Estimator {
    /// Radiance by a model without a table.
    ClosedForm(ClosedForm),
    /// Radiance by a table of these lobes.
    Table(LobeModel),
    /// Radiance by a table of LTCs, two an entry.
    TwoLobes(SecondLobe),
    /// Radiance by Monte Carlo integration.
    Reference,
    /// The table's lobe.
    TableLobe,
    /// The scattering model's lobe.
    ReferenceLobe,
}

impl Estimator {
    /// The estimator of light by a model, by `rule` if the model has several. A table decides by its lobes.
    #[must_use]
    pub fn of(model: LightModel, rule: NormalsRule, table: &ShaderTable) -> Self {
        // No shader has the exact integrals.
        let rule = if NormalsRule::SHADED.contains(&rule) { rule } else { NormalsRule::Fine };
        let by_table = || table.second().map_or(Self::Table(table.lobe), Self::TwoLobes);
        model.closed_form(Some(rule)).map_or_else(by_table, Self::ClosedForm)
    }

    /// The cost of a pixel in samples of the reference, which takes `spp` samples.
    pub(super) fn cost(self, spp: u32) -> u32 {
        match self {
            Self::Reference => spp,
            Self::ClosedForm(form) => form.model().cost(),
            Self::Table(lobe) => LightModel::of_lobe(lobe).table_cost(),
            Self::TwoLobes(_) => 2 * LightModel::Ltc.table_cost(),
            Self::TableLobe | Self::ReferenceLobe => LightModel::Ltc.table_cost(),
        }
    }

    /// Whether it only lights by polygons: a polygon replaces each other shape.
    pub(super) fn is_of_polygons(self) -> bool {
        match self {
            Self::Table(lobe) => lobe.gaussian().is_some(),
            other => matches!(other, Self::ClosedForm(_)),
        }
    }

    /// Whether it estimates a lobe, not radiance.
    pub(super) fn is_lobe(self) -> bool {
        matches!(self, Self::TableLobe | Self::ReferenceLobe)
    }
}
