//! The errors of previews.

use super::SceneFault;
use ltcforge_fit::{BrdfKind, LobeModel};

/// The reason that a scene was not rendered.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PreviewError {
    /// Parameters are out of bounds or do not go together. The second list has the faults of the table.
    #[error("{}", .0.iter().map(ToString::to_string).chain(.1.iter().map(ToString::to_string)).collect::<Vec<_>>().join("\n"))]
    Scene(Vec<SceneFault>, Vec<TableFault>),
    /// The scene cannot show the table.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
    Table(Vec<TableFault>),
    /// A GPU was requested, but no shader has the reference of this BRDF.
    #[error("only the CPU renders the reference of brdf {0}: use mode ltc, or an adapter other than gpu")]
    CpuOnly(BrdfKind),
    /// The reference needs the file of a tabulated BRDF, which was not found.
    #[error(
        "the reference needs the file {0} of the tabulated BRDF, which is missing: put it next to the table, or use mode ltc"
    )]
    NoBrdfFile(String),
    /// A GPU was requested, but Vulkan lists none.
    #[error("no adapter: {0}")]
    NoAdapter(String),
    /// The GPU, or its driver, failed twice.
    #[error("the GPU failed: {0}")]
    Gpu(String),
    /// The caller stopped the renderer.
    #[error("stopped")]
    Stopped,
}

/// The reason that a scene cannot show a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum TableFault {
    /// The picture compares the table with models that are only for GGX.
    #[error("the closed forms are for brdf ggx, and the table has brdf {0}: use model ltc, or a table of brdf ggx")]
    OtherBrdf(BrdfKind),
    /// The picture compensates for the light that facets lose, and the table's model has no facets.
    #[error("compensate needs a table of brdf ggx or beckmann, got brdf {0}: leave it out, or use another table")]
    NoFacets(BrdfKind),
    /// The material has a reflectance, and the table's model has no Fresnel factor.
    #[error("f0 needs a brdf with a Fresnel factor, got brdf {0}: leave f0 out, or set it to 1,1,1")]
    NoFresnel(BrdfKind),
    /// The light has a picture, and the table has Gaussians.
    #[error("light_picture needs a table of lobe ltc, got lobe {0}: leave it out, or use another table")]
    GaussianPicture(LobeModel),
    /// The picture draws a lobe, and the table has Gaussians.
    #[error("mode lobe needs a table of lobe ltc, got lobe {0}: use mode strip, or another table")]
    GaussianLobe(LobeModel),
}
