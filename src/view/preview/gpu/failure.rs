//! Why a GPU did not render.

/// Why a GPU did not render.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub(crate) enum GpuFailure {
    /// There is no GPU, or none that can be used.
    #[error("{0}")]
    Absent(String),
    /// It cannot hold a texture.
    #[error("a {what} of {size:?} texels is larger than the {most} a side that textures may have")]
    TooLarge {
        /// What the texture is of.
        what: &'static str,
        /// Texels a side.
        size: Vec<usize>,
        /// Most texels a side.
        most: u32,
    },
    /// The GPU was lost, or an operation failed.
    #[error("{0}")]
    Failed(String),
    /// The GPU does not answer.
    #[error("{0}")]
    Hangs(String),
    /// The caller told it to stop.
    #[error("stopped")]
    Stopped,
}
