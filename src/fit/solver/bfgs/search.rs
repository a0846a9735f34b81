//! The common part of the searches for matrices and for Gaussians: a coarse stage, the cost of a small area, and
//! symmetries.

use super::minimise::VARIABLES;
use crate::brdf::Mirrors;

/// Before a search is done, it goes most of the way with coarse evaluations, of an eighth of the work, until steps
/// lower the loss by less than this part. What it has learnt of the Hessian there holds for the full ones too, which
/// halves their number.
pub(super) const COARSE_DECREASE: f64 = 1e-2;
/// Cost of an area that is smaller by a factor of e, in units of the lobe's width. Without it a lobe that is a curved
/// line would flatten `M` until no f32 number could hold its determinant. It hardly changes the fit of other lobes.
pub(super) const AREA_COST: f64 = 1e-4;

/// The numbers that a lobe with these symmetries leaves free: those in whose name (`xx`, `xy`, `yy`, `ax`, `ay`, `lx`,
/// `ly`) each mirrored axis stands an even number of times.
pub(super) fn free_variables(mirrors: Mirrors) -> [bool; VARIABLES] {
    let Mirrors { x, y } = mirrors;
    [true, !(x || y), true, !x, !y, !x, !y]
}
