//! The errors of previews.

use super::SceneFault;
use ltcforge_fit::{BrdfKind, LobeModel};

/// The reason that a scene was not rendered.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PreviewError {
    /// Parameters are out of bounds or contradict each other. The second list has the faults of the table.
    #[error("{}", .0.iter().map(ToString::to_string).chain(.1.iter().map(ToString::to_string)).collect::<Vec<_>>().join("\n"))]
    Scene(Vec<SceneFault>, Vec<TableFault>),
    /// The scene cannot show the table.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
    Table(Vec<TableFault>),
    /// The caller requires a GPU, but no shader has the reference for this BRDF.
    #[error("adapter gpu cannot render the reference of brdf {0}: use mode ltc, or adapter any or cpu")]
    CpuOnly(BrdfKind),
    /// The reference needs the file of a tabulated BRDF, and the file is missing.
    #[error(
        "the reference needs the file {0} of the tabulated BRDF, which is missing: put it next to the table, or use mode ltc"
    )]
    NoBrdfFile(String),
    /// The caller requires a GPU, but Vulkan lists no adapter.
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
    /// The picture compares the table with models that only support GGX.
    #[error("the closed forms need a table of brdf ggx, got brdf {0}: use model ltc, or another table")]
    OtherBrdf(BrdfKind),
    /// The picture compensates for the light that is lost between facets, and the table's model has no facets.
    #[error("compensate needs a table of brdf ggx or beckmann, got brdf {0}: leave it out, or use another table")]
    NoFacets(BrdfKind),
    /// The material has a reflectance, and the table's model has no Fresnel factor.
    #[error("f0 needs a brdf with a Fresnel factor, got brdf {0}: leave f0 out, or set it to 1,1,1")]
    NoFresnel(BrdfKind),
    /// The light has a picture, and the table stores Gaussians.
    #[error("light_picture needs a table of lobe ltc, got lobe {0}: leave it out, or use another table")]
    GaussianPicture(LobeModel),
    /// The picture draws a lobe, and the table stores Gaussians.
    #[error("mode lobe needs a table of lobe ltc, got lobe {0}: use mode strip, or another table")]
    GaussianLobe(LobeModel),
}
