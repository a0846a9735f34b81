//! The part of a Gaussian above the horizon.

use glam::DVec3;

use super::SphericalGaussian;
use crate::math::{exp, sin_cos};

/// Angles of the mean over the plane. It is that of a smooth function around a circle.
const ANGLES: u32 = 256;

/// The square of the radius, in deviations, at which the horizon cuts the ray of the plane towards `s`.
///
/// `s` is a combination of both deviations `cos d1 + sin d2`, with the height `s_z`; the axis has the height `r_z`. A
/// great circle from the axis along `t = s / |s|` meets the horizon where `r_z cos a + t_z sin a = 0`. The equal-area
/// projection has it at `|d|^2 = 2 (1 - cos a)`, and the ray has `|d| = radius |s|`:
///
/// ```text
/// radius^2 = 2 (1 + h) / |s|^2,    h = s_z / sqrt(s_z^2 + r_z^2 |s|^2)
/// ```
///
/// Domain: an axis above the horizon. Each great circle from it then crosses the horizon once in half a turn.
#[must_use]
pub(crate) fn horizon2(axis_height: f64, s_height: f64, s_length2: f64) -> f64 {
    let across2 = axis_height * axis_height * s_length2;
    let both = (s_height * s_height + across2).sqrt();
    let h = s_height / both;
    // Without cancellation where the ray runs down steeply from an axis near the horizon.
    let beyond = if h < 0.0 { across2 / (both * both) / (1.0 - h) } else { 1.0 + h };
    2.0 * beyond / s_length2
}

/// The part of the plane's Gaussian that stands for directions above the horizon, in [0, 1]: the mean over the angle of
/// `1 - exp(-radius^2)`.
#[must_use]
pub(crate) fn above_horizon(gaussian: &SphericalGaussian<f64>) -> f64 {
    let [first, second] = gaussian.deviations().map(DVec3::from);
    let part = |k: u32| {
        let (sin, cos) = sin_cos(std::f64::consts::TAU * (f64::from(k) + 0.5) / f64::from(ANGLES));
        let s = first * cos + second * sin;
        1.0 - exp(-horizon2(gaussian.axis[2], s.z, s.length_squared()))
    };
    (0..ANGLES).map(part).sum::<f64>() / f64::from(ANGLES)
}
