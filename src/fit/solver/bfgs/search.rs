//! The code that the searches for matrices and for Gaussians share: a coarse stage, the cost of a small area, and
//! symmetries.

use super::minimise::VARIABLES;
use crate::brdf::Mirrors;

/// The limit of the coarse stage. A search begins with coarse evaluations, each of which takes an eighth of the work of
/// a full evaluation, until a step reduces the loss by less than this fraction. The estimated Hessian is kept for the
/// full evaluations and halves their number.
pub(super) const COARSE_DECREASE: f64 = 1e-2;
/// Cost of an area that is smaller by a factor of e, in units of the lobe's width. Without this cost, a lobe that is a
/// curved line would flatten `M` until an f32 could not represent its determinant. The cost hardly changes the fit of
/// other lobes.
pub(super) const AREA_COST: f64 = 1e-4;

/// The variables that are free for a lobe with these symmetries. In the name of a free variable (`xx`, `xy`, `yy`,
/// `ax`, `ay`, `lx`, `ly`), each mirrored axis occurs an even number of times.
pub(super) fn free_variables(mirrors: Mirrors) -> [bool; VARIABLES] {
    let Mirrors { x, y } = mirrors;
    [true, !(x || y), true, !x, !y, !x, !y]
}
