//! Restrictions on the tables that a plan may choose, apart from the budget.

use ltcforge_fit::Layout;
use ltcforge_shaders::GpuLimit;
use ltcforge_textures::Engine;

/// The form of a plan's tables.
#[derive(Debug, Clone, Copy, Default)]
pub struct Form {
    /// The layout; `None` for the default of the scattering model.
    pub layout: Option<Layout>,
    /// Whether nodes may be the scene's own values of alpha and ratio, for readers that search for nodes.
    pub any_nodes: bool,
    /// Whether the table has no terms, for renderers that get the energy of lobes from elsewhere.
    pub no_terms: bool,
    /// Whether a budget of bytes counts the table's compact form.
    pub ship: bool,
    /// The engine whose files a budget of bytes counts.
    pub engine: Option<Engine>,
    /// The GPU limits of the shader that reads the table.
    pub gpu: GpuLimit,
}
