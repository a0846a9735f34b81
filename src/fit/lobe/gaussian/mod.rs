//! One Gaussian on the sphere: its shape, its integral over polygons, and the fraction of it above the horizon.
//!
//! The equal-area projection around its axis `r` is `d = w_p sqrt(2 / (1 + w . r))` with `w_p = w - (w . r) r`. In this
//! projection the Gaussian is `exp(-x^2 - y^2)`, where `x` and `y` are linear functions of `d`. Areas of the plane are
//! solid angles, and `|d| = 2 sin(angle / 2)`. A spherical Gaussian `exp(L (w . r - 1))` is therefore round, with
//! `x^2 + y^2 = L d^2 / 2`.

mod horizon;
mod images;
mod kind;
mod model;
mod polygon;
mod shape;

pub(crate) use horizon::{above_horizon, horizon2};
pub(crate) use images::Images;
pub use kind::Gaussian;
pub(super) use model::{ASG, SG};
pub use polygon::covered;
pub use shape::SphericalGaussian;
