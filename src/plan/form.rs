//! Restrictions on the tables that a plan may choose, apart from the budget.

use ltcforge_fit::Layout;
use ltcforge_shaders::GpuLimit;
use ltcforge_textures::{Engine, TextureLayout};

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

impl Form {
    /// The form of tables for an engine, in the engine's own layout if it has one. Textures of your own renderer have
    /// halves, as the plan's tables have.
    #[must_use]
    pub fn of_engine(engine: Option<Engine>) -> Self {
        let textures = engine.and_then(Engine::layout).and_then(|name| TextureLayout::named(name).ok());
        Self {
            layout: textures.map(|textures| textures.sampling().table),
            engine: engine.map(|engine| if engine == Engine::Wgpu { Engine::WgpuHalf } else { engine }),
            ..Self::default()
        }
    }
}
