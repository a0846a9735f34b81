//! The first guess for the matrix of a lobe.

use glam::DMat3;

use super::target::Core;
use crate::math::symmetric_sqrt;

/// The `M` of an LTC whose core lies and scatters as the lobe's does. Maps cosine space to the lobe's frame.
///
/// For a sharp one it is `sqrt(2 S)` with the scatter `S` of [`Core`]. The clamped cosine itself, `M = I`, scatters
/// by 0.2 along either axis, where the factor 2 has become 5; in between it follows the trace.
pub(super) fn from_core(core: &Core) -> DMat3 {
    let trace = core.scatter.x_axis.x + core.scatter.y_axis.y;
    let root = symmetric_sqrt(core.scatter * (2.0 + 7.5 * trace));
    DMat3::from_cols(root.x_axis.extend(0.0), root.y_axis.extend(0.0), core.centre.extend(1.0))
}
