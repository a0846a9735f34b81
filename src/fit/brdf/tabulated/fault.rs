//! The faults of tabulated BRDFs.

/// A fault in a tensor of a tabulated BRDF.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("tensor «{tensor}»: {detail}")]
pub struct TabulatedFault {
    /// The name of the tensor.
    pub tensor: &'static str,
    /// The invalid number and the allowed values.
    pub detail: String,
}

impl TabulatedFault {
    /// True if the number of values does not match the axes.
    #[must_use]
    pub fn is_of_count(&self) -> bool {
        self.detail.contains(COUNT)
    }
}

/// The text by which a message about the number of values is recognised.
pub(super) const COUNT: &str = "; the axes need ";
