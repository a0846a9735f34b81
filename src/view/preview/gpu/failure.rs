//! Why a GPU did not render.

/// Why a GPU did not render.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub(crate) enum GpuFailure {
    /// There is no GPU, or none that can be used.
    #[error("{0}")]
    Absent(String),
    /// It cannot hold the table.
    #[error("a table of {size:?} texels is larger than the {most} a side that textures may have")]
    TableTooLarge {
        /// Texels a side.
        size: [usize; 3],
        /// Most texels a side.
        most: u32,
    },
    /// It cannot hold the picture of the light.
    #[error("a picture of {} x {} texels is larger than the {most} a side that textures may have", .size[0], .size[1])]
    PictureTooLarge {
        /// Texels a side.
        size: [usize; 2],
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
