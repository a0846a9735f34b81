//! What a renderer is asked for.

/// Asked between parts of a picture whether to stop.
pub type Stop<'a> = &'a dyn Fn() -> bool;

/// What is estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Estimator {
    /// Radiance by the table.
    Table,
    /// Radiance by Monte Carlo integration.
    Reference,
    /// The table's lobe.
    TableLobe,
    /// GGX's lobe.
    ReferenceLobe,
}

impl Estimator {
    /// Every estimator.
    pub const ALL: [Self; 4] = [Self::Table, Self::Reference, Self::TableLobe, Self::ReferenceLobe];

    /// Whether it estimates a lobe, not radiance.
    pub(super) fn is_lobe(self) -> bool {
        matches!(self, Self::TableLobe | Self::ReferenceLobe)
    }
}
