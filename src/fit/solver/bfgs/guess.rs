//! The initial guess for the matrix of a lobe.

use glam::{DMat2, DMat3, DVec2};

use crate::{math::symmetric_sqrt, metric::LobeCore};

/// The matrix `M = [[root^2, centre], [0, 1]]` of an LTC whose core has the location and scatter of the lobe's core. It
/// maps cosine space to the lobe's frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Guess {
    /// Square root of the upper-left block. Both are symmetric and positive definite.
    pub(super) root: DMat2,
    /// First two numbers of the third column.
    pub(super) centre: DVec2,
}

impl Guess {
    /// For a sharp lobe the block is `sqrt(2 S)` with the scatter `S` of [`LobeCore`]. The clamped cosine, `M = I`, has
    /// a scatter of 0.2 along either axis and needs a factor of 5 instead of 2. Between the two, the factor is linear
    /// in the trace.
    pub(crate) fn of(core: &LobeCore) -> Self {
        let trace = core.scatter.x_axis.x + core.scatter.y_axis.y;
        Self { root: symmetric_sqrt(symmetric_sqrt(core.scatter * (2.0 + 7.5 * trace))), centre: core.centre }
    }

    /// `M`.
    pub(crate) fn matrix(&self) -> DMat3 {
        let block = self.root * self.root;
        DMat3::from_cols(block.x_axis.extend(0.0), block.y_axis.extend(0.0), self.centre.extend(1.0))
    }
}
