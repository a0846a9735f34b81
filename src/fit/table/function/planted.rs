//! A table of known polynomials.

use super::{BrdfKind, Layout, PerAxis, SMOOTH_NUMBERS, THETA_CEILING, Table, roughness_of, view_of};
use crate::lobe::LobeModel;

/// Numbers that are polynomials of low degree in the variables of the function.
#[must_use]
pub fn planted(layout: Layout) -> Table {
    let theta_end = if layout == Layout::Reflected { THETA_CEILING } else { std::f64::consts::FRAC_PI_2 };
    let ranges = PerAxis { alpha: [0.0, 1.0], ratio: [1.0; 2], theta: [0.0, theta_end], phi: [0.0; 2] };
    let axes = layout.nodes(&ranges, &PerAxis { alpha: 36, ratio: 1, theta: 32, phi: 1 });
    let numbers: Vec<[f64; SMOOTH_NUMBERS]> =
        axes.alpha.iter().flat_map(|alpha| axes.theta.iter().map(|theta| wanted(*alpha, *theta))).collect();
    Table::of_smooth_numbers((BrdfKind::Ggx, LobeModel::Ltc, layout), axes, &numbers, true)
}

/// The planted numbers.
pub(super) fn wanted(alpha: f64, theta: f64) -> [f64; SMOOTH_NUMBERS] {
    let (x, y) = (roughness_of(alpha), view_of(theta));
    let p = 1.0 - 0.3 * x * x + 0.2 * x * y * y;
    let q = 1.0 + 0.4 * y * y * y - 0.3 * x * x;
    let (slant, row) = (0.3 * y * y * (1.0 - x), -0.5 * x * y);
    [p, 0.0, q, slant, 0.0, row, 0.0, 1.0 - 0.6 * x * x * (1.0 - y), 0.15 * x + 0.1 * x * y]
}
