//! The faults of tabulated BRDFs.

/// A fault in a tensor of a tabulated BRDF.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("tensor «{tensor}»: {detail}")]
pub struct TabulatedFault {
    /// Which tensor.
    pub tensor: &'static str,
    /// The fault: the number, and what is allowed.
    pub detail: String,
}

impl TabulatedFault {
    /// Whether it is that there are more or fewer numbers than nodes.
    #[must_use]
    pub fn is_of_count(&self) -> bool {
        self.detail.contains(COUNT)
    }
}

/// The ending of a message about the number of values.
pub(super) const COUNT: &str = "; the axes need ";
