//! What a shader lights by.

use ltcforge_fit::{Layout, named_list};
use ltcforge_light::{Gaussian, LightModel};

/// What a shader for other renderers lights by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LitBy {
    /// Tables of LTCs in this layout.
    Table(Layout),
    /// The closed form in the space of normals, without a table.
    Normals,
    /// A Gaussian, without a table. The text has both, and which one is an argument of its functions.
    Gaussian(Gaussian),
    /// Tables of Gaussians in this layout. The text lights by both, and which one is an argument of its functions.
    GaussianTable(Gaussian, Layout),
}

impl LitBy {
    /// The model.
    #[must_use]
    pub fn model(self) -> LightModel {
        match self {
            Self::Table(_) => LightModel::Ltc,
            Self::Normals => LightModel::Normals,
            Self::Gaussian(gaussian) | Self::GaussianTable(gaussian, _) => gaussian.into(),
        }
    }

    /// The layout of its tables.
    #[must_use]
    pub fn layout(self) -> Option<Layout> {
        match self {
            Self::Table(layout) | Self::GaussianTable(_, layout) => Some(layout),
            Self::Normals | Self::Gaussian(_) => None,
        }
    }

    /// The name of the entry point that shows how to call the shader.
    #[must_use]
    pub fn entry_point(self) -> &'static str {
        match self {
            Self::Table(_) => "ltc_example",
            Self::Normals => "normals_example",
            Self::Gaussian(_) => "gaussians_example",
            Self::GaussianTable(..) => "gaussians_table_example",
        }
    }
}

named_list! {
    /// The lights that a text to include has functions for, by a table of LTCs.
    pub enum Lights {
        /// Polygons, disks, spheres, tubes and lines.
        All = "all",
        /// Rectangles and polygons alone: a text two fifths shorter.
        Polygons = "polygons",
    }
}

/// How a text to include reads a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Reading {
    /// Who interpolates.
    pub filter: Filter,
    /// What the table is in.
    pub bound: Bound,
}

impl Reading {
    /// Every way.
    pub const ALL: [Self; 4] = {
        use Bound::{Array, Volumes};
        use Filter::{Exact, Hardware};
        [
            Self { filter: Exact, bound: Volumes },
            Self { filter: Exact, bound: Array },
            Self { filter: Hardware, bound: Volumes },
            Self { filter: Hardware, bound: Array },
        ]
    };
}

/// The textures of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Bound {
    /// Three 3D textures.
    #[default]
    Volumes,
    /// One 2D array, and so one sampler in languages that have a sampler for each texture.
    Array,
}

/// Who interpolates the entries of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Filter {
    /// The shader: 16 fetches a texture, weights of 32 bits, any texture format.
    #[default]
    Exact,
    /// The sampler along phi and theta, and along alpha in volumes: 2 fetches a texture, 4 in an array; many GPUs have weights of 8 bits, which shows on sharp
    /// lobes. Textures have to be filterable.
    Hardware,
}

impl From<Layout> for LitBy {
    fn from(layout: Layout) -> Self {
        Self::Table(layout)
    }
}
