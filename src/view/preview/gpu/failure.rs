//! The errors of the GPU renderer.

/// The reason that a GPU did not render.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub(crate) enum GpuFailure {
    /// There is no GPU that can be used.
    #[error("{0}")]
    Absent(String),
    /// It cannot hold a texture.
    #[error("a {what} of {size:?} texels is too large: textures have at most {most} texels on a side")]
    TooLarge {
        /// The content of the texture.
        what: &'static str,
        /// Texels along each side.
        size: Vec<usize>,
        /// Most texels along a side.
        most: u32,
    },
    /// The GPU was lost, or an operation failed.
    #[error("{0}")]
    Failed(String),
    /// The caller stopped it.
    #[error("stopped")]
    Stopped,
}
