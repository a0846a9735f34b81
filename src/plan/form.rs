//! What the tables of a plan may be, beside their budget.

use crate::without::GpuLimit;
use ltcforge_fit::{Layout, StoredTerms};

/// What a table may be.
#[derive(Debug, Clone, Copy, Default)]
pub struct Form {
    /// Its layout; the scattering model's default one where there is none.
    pub layout: Option<Layout>,
    /// Whether nodes may stand on the scene's own values of alpha and ratio, for readers that search for nodes.
    pub any_nodes: bool,
    /// Whether the table has no terms, for renderers that have the energy of lobes from elsewhere.
    pub no_terms: bool,
    /// Whether the table is shipped in its compact form, whose bytes are the budget's.
    pub ship: bool,
    /// What the text that reads the table may cost a GPU.
    pub gpu: GpuLimit,
}

impl Form {
    /// The terms of tables.
    pub(crate) fn terms(self) -> StoredTerms {
        if self.no_terms { StoredTerms::None } else { StoredTerms::Schlick }
    }
}
