//! Why a GPU did not render.

/// Why a GPU did not render.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub(in crate::view::preview) enum GpuFailure {
    /// There is none, or none that will do.
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
    /// It was lost, or an operation failed.
    #[error("{0}")]
    Failed(String),
    /// It does not come back.
    #[error("{0}")]
    Hangs(String),
    /// The caller told it to stop.
    #[error("stopped")]
    Stopped,
}
