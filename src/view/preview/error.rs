//! Why there is no picture.

use super::SceneFault;

/// Why a scene was not rendered.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PreviewError {
    /// Parameters are out of their bounds.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
    Scene(Vec<SceneFault>),
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
