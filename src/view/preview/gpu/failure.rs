//! The errors of the GPU renderer.

/// The reason that a GPU did not render.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub(crate) enum GpuFailure {
    /// No usable GPU was found.
    #[error("{0}")]
    Absent(String),
    /// The GPU cannot hold a texture.
    #[error("a {what} of {size:?} texels is too large: textures have at most {most} texels on a side")]
    TooLarge {
        /// The content of the texture.
        what: &'static str,
        /// Texels along each side.
        size: Vec<usize>,
        /// The largest number of texels along a side.
        most: u32,
    },
    /// The GPU was lost, or an operation failed.
    #[error("{0}")]
    Failed(String),
    /// The caller stopped the rendering.
    #[error("stopped")]
    Stopped,
}
