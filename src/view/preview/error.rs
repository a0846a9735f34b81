//! Why there is no picture.

use super::SceneFault;
use ltcforge_fit::{BrdfKind, LobeModel};

/// Why a scene was not rendered.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PreviewError {
    /// Parameters are out of their bounds or do not go together; beside them all that stands against the table.
    #[error("{}", .0.iter().map(ToString::to_string).chain(.1.iter().map(ToString::to_string)).collect::<Vec<_>>().join("\n"))]
    Scene(Vec<SceneFault>, Vec<TableFault>),
    /// The table cannot be shown so.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
    Table(Vec<TableFault>),
    /// A GPU was asked for, and shaders do not know the reference.
    #[error("only the CPU renders the reference of brdf {0}: choose mode ltc, or another adapter than the GPU")]
    CpuOnly(BrdfKind),
    /// The reference is of a tabulated BRDF whose file was not found.
    #[error(
        "the reference is of a tabulated BRDF, whose file {0} is not there: choose mode ltc, or put it beside the table"
    )]
    NoBrdfFile(String),
    /// A GPU was asked for, and Vulkan lists none.
    #[error("no adapter: {0}")]
    NoAdapter(String),
    /// The GPU, or its driver, failed twice.
    #[error("the GPU failed: {0}")]
    Gpu(String),
    /// The caller told the renderer to stop.
    #[error("stopped")]
    Stopped,
}

/// Why a scene cannot show a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum TableFault {
    /// The picture compares a table with models that are GGX's alone.
    #[error("the closed forms light GGX, and the table is of brdf {0}: choose model ltc, or a table of brdf ggx")]
    OtherBrdf(BrdfKind),
    /// The picture gives back what facets lose, and the table is of a model without any.
    #[error(
        "compensate gives back what facets lose to each other, and the table is of brdf {0}: leave it out, or take a table of ggx or beckmann"
    )]
    NoFacets(BrdfKind),
    /// The material has a reflectance, and the table is of a model without a Fresnel factor.
    #[error("f0 is of Schlick's Fresnel factor, which brdf {0} does not have: leave it out, or say 1,1,1")]
    NoFresnel(BrdfKind),
    /// The light has a picture, and the table has Gaussians.
    #[error(
        "light_picture is of tables of LTCs, and the table has lobe {0}: leave it out, or take a table of lobe ltc"
    )]
    GaussianPicture(LobeModel),
    /// The picture draws a lobe, and the table has Gaussians.
    #[error("mode lobe draws the lobes of LTCs, and the table has lobe {0}: choose mode strip, or a table of lobe ltc")]
    GaussianLobe(LobeModel),
}
