//! The fraction of a Gaussian above the horizon.

use glam::DVec3;

use super::SphericalGaussian;
use crate::math::{exp, sin_cos};

/// The number of angles over which [`above_horizon`] takes the mean. The function is smooth and periodic, so few angles
/// are enough.
const ANGLES: u32 = 256;

/// The squared radius, in deviations, at which the ray towards `s` crosses the horizon.
///
/// `s` is the combination `cos d1 + sin d2` of both deviations, with the height `s_z`. The axis has the height `r_z`. A
/// great circle from the axis along `t = s / |s|` meets the horizon where `r_z cos a + t_z sin a = 0`. In the
/// equal-area projection this point has `|d|^2 = 2 (1 - cos a)`, and the ray has `|d| = radius |s|`:
///
/// ```text
/// radius^2 = 2 (1 + h) / |s|^2,    h = s_z / sqrt(s_z^2 + r_z^2 |s|^2)
/// ```
///
/// Domain: an axis above the horizon. Each great circle from it crosses the horizon once in half a turn.
#[must_use]
pub(crate) fn horizon2(axis_height: f64, s_height: f64, s_length2: f64) -> f64 {
    let across2 = axis_height * axis_height * s_length2;
    let both = (s_height * s_height + across2).sqrt();
    let h = s_height / both;
    // This form avoids cancellation for a ray that descends steeply from an axis near the horizon.
    let beyond = if h < 0.0 { across2 / (both * both) / (1.0 - h) } else { 1.0 + h };
    2.0 * beyond / s_length2
}

/// The fraction of the Gaussian above the horizon, in [0, 1]: the mean of `1 - exp(-radius^2)` over the angle.
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
