//! What a renderer is asked for.

use super::ShaderTable;
use ltcforge_light::{Gaussian, LightModel};

/// Asked between parts of a picture whether to stop.
pub type Stop<'a> = &'a dyn Fn() -> bool;

/// What is estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Estimator {
    /// Radiance by the table.
    Table,
    /// Radiance by a table of Gaussians.
    GaussianTable(Gaussian),
    /// Radiance by the closed form in the space of normals.
    Normals,
    /// Radiance by a Gaussian.
    Gaussian(Gaussian),
    /// Radiance by Monte Carlo integration.
    Reference,
    /// The table's lobe.
    TableLobe,
    /// The scattering model's lobe.
    ReferenceLobe,
}

impl Estimator {
    /// Every estimator.
    pub const ALL: [Self; 9] = [
        Self::Table,
        Self::GaussianTable(Gaussian::Sg),
        Self::GaussianTable(Gaussian::Asg),
        Self::Normals,
        Self::Gaussian(Gaussian::Sg),
        Self::Gaussian(Gaussian::Asg),
        Self::Reference,
        Self::TableLobe,
        Self::ReferenceLobe,
    ];

    /// That of light by a model; by a table as by its lobes.
    #[must_use]
    pub fn of(model: LightModel, table: &ShaderTable) -> Self {
        match model {
            LightModel::Ltc => table.lobe.gaussian().map_or(Self::Table, Self::GaussianTable),
            LightModel::Normals => Self::Normals,
            LightModel::Sg => Self::Gaussian(Gaussian::Sg),
            LightModel::Asg => Self::Gaussian(Gaussian::Asg),
        }
    }

    /// Whether it is of the scattering model itself, not of what stands for it.
    pub(super) fn is_reference(self) -> bool {
        matches!(self, Self::Reference | Self::ReferenceLobe)
    }

    /// Whether it estimates a lobe, not radiance.
    pub(super) fn is_lobe(self) -> bool {
        matches!(self, Self::TableLobe | Self::ReferenceLobe)
    }
}
