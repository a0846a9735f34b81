//! What a shader lights by.

use crate::{
    fit::Layout,
    light::{Gaussian, LightModel},
};

/// What a shader for other renderers lights by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LitBy {
    /// Tables of LTCs in this layout.
    Table(Layout),
    /// The closed form in the space of normals, without a table.
    Normals,
    /// A Gaussian, without a table. The text has both, and which one is an argument of its functions.
    Gaussian(Gaussian),
}

impl LitBy {
    /// The model.
    #[must_use]
    pub fn model(self) -> LightModel {
        match self {
            Self::Table(_) => LightModel::Ltc,
            Self::Normals => LightModel::Normals,
            Self::Gaussian(gaussian) => gaussian.into(),
        }
    }

    /// The layout of its tables.
    #[must_use]
    pub fn layout(self) -> Option<Layout> {
        match self {
            Self::Table(layout) => Some(layout),
            Self::Normals | Self::Gaussian(_) => None,
        }
    }

    /// The name of the entry point that shows how to call the shader.
    #[cfg(feature = "shaders")]
    pub(super) fn entry_point(self) -> &'static str {
        match self {
            Self::Table(_) => "ltc_example",
            Self::Normals => "normals_example",
            Self::Gaussian(_) => "gaussians_example",
        }
    }
}

/// Who interpolates the entries of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Filter {
    /// The shader: 16 fetches a texture, weights of 32 bits, any texture format.
    Exact,
    /// The sampler along phi, theta and alpha: 2 fetches a texture; many GPUs have weights of 8 bits, which shows on sharp
    /// lobes. Textures have to be filterable.
    Hardware,
}

impl From<Layout> for LitBy {
    fn from(layout: Layout) -> Self {
        Self::Table(layout)
    }
}
