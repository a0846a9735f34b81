//! Figure 13: eight GGX lobes next to their LTCs.

use glam::DVec3;
use ltcforge::{
    fit::{
        FittedEntry, Ltc,
        brdf::{Brdf, Ggx},
        math::{direction, from_row_major},
    },
    view::picture::{Panel, Picture, caption, grid, headed},
};

use super::{
    error::FigureError,
    fits::fitted,
    hemisphere::{hemisphere, peak},
};

/// Side of a lobe's picture in pixels.
const SIDE: u32 = 176;

/// The paper's configurations: roughness along x and y, and the view direction in degrees.
const CONFIGURATIONS: [[f64; 4]; 8] = [
    [0.05, 0.05, 66.0, 294.0],
    [0.01, 0.80, 0.0, 272.0],
    [0.25, 0.80, 0.0, 316.0],
    [0.80, 1.00, 44.0, 316.0],
    [0.25, 0.05, 44.0, 294.0],
    [0.05, 1.00, 88.0, 338.0],
    [1.00, 0.25, 66.0, 338.0],
    [0.50, 0.01, 66.0, 316.0],
];

/// Draws both lobes of each configuration, on the scale of GGX.
pub(super) fn draw() -> Result<Picture, FigureError> {
    let mut titled = Vec::new();
    for [alpha_x, alpha_y, theta, phi] in CONFIGURATIONS {
        let (ggx, wo) = (Ggx { alpha_x, alpha_y }, direction(theta.to_radians(), phi.to_radians()));
        let FittedEntry { matrix, amplitude, error, .. } = fitted(&ggx, wo)?;
        let wanted = |wi: DVec3| ggx.eval_cos(wo, wi) / amplitude;
        let scale = peak(SIDE, wanted);
        let ltc = Ltc::new(from_row_major(&matrix));
        let found = |wi: DVec3| ltc.as_ref().map_or(0.0, |ltc| ltc.pdf(wi));
        titled.push((format!("alpha {alpha_x}, {alpha_y}"), hemisphere(SIDE, scale, wanted), "GGX".to_owned()));
        let title = format!("theta {theta}, phi {phi}");
        titled.push((title, hemisphere(SIDE, scale, found), format!("LTC, off by {error:.4}")));
    }
    let panels: Vec<Panel<'_>> = titled
        .iter()
        .map(|(title, picture, foot)| Panel { title, picture: picture.clone(), foot: caption(SIDE, &[foot]) })
        .collect();
    let what = "Lobes of GGX and the nearest LTCs, from above; colours by the root of the density";
    let how = "off by: the sliced Wasserstein distance, on samples that the fit did not see";
    Ok(headed(&[&[what], &[how]], &grid(&panels, 4)))
}
