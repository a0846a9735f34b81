//! Figure 7: interpolation of matrices with and without alignment.

use glam::{DMat3, DVec3};
use ltcforge::{
    fit::{
        Ltc,
        brdf::{Ggx, Mirrors},
        lobe::ltc::align,
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
const SIDE: u32 = 150;
/// Weights of the second matrix in the interpolation.
const WEIGHTS: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];
/// The rotation of the cosine under the second matrix, in radians. It does not change the distribution.
const TURN: f64 = 2.0;
/// The constant `FLATTEST` of layout `kt2022`.
const FLATTEST: f64 = 1e-4;

/// Draws the interpolation between two matrices, with and without alignment: for two matrices of one distribution, and
/// for two distributions.
pub(super) fn draw() -> Result<Picture, FigureError> {
    let matrix = |alpha_x, alpha_y, theta, phi| {
        let wo = direction(theta, phi);
        let entry = fitted(&Ggx { alpha_x, alpha_y }, wo)?;
        Ok::<_, FigureError>((from_row_major(&entry.matrix), Mirrors::of(wo)))
    };
    let first = matrix(0.5, 0.15, 0.5, 0.4)?;
    let second = matrix(0.6, 0.4, 1.1, 1.2)?;
    let turned = |m: DMat3| m * DMat3::from_rotation_z(TURN);
    let aligned = |(m, mirrors): (DMat3, Mirrors)| normalised(align(&m, mirrors, FLATTEST));
    let rows = [
        ("one distribution, not aligned", [normalised(first.0), normalised(turned(first.0))]),
        ("one distribution, aligned", [aligned(first), aligned((turned(first.0), first.1))]),
        ("two distributions, not aligned", [normalised(first.0), normalised(turned(second.0))]),
        ("two distributions, aligned", [aligned(first), aligned((turned(second.0), second.1))]),
    ];
    let mut titled = Vec::new();
    for (name, [m1, m2]) in rows {
        let density = |m: DMat3| {
            let ltc = Ltc::new(m);
            move |wi: DVec3| ltc.as_ref().map_or(0.0, |ltc| ltc.pdf(wi))
        };
        let scale = peak(SIDE, density(m1)).max(peak(SIDE, density(m2)));
        for weight in WEIGHTS {
            let title = if weight == 0.5 { name } else { "" };
            let foot = match weight {
                0.0 => "M1".to_owned(),
                1.0 => "M2".to_owned(),
                _ => format!("{} M1 + {weight} M2", 1.0 - weight),
            };
            titled.push((title, hemisphere(SIDE, scale, density(m1 * (1.0 - weight) + m2 * weight)), foot));
        }
    }
    let panels: Vec<Panel<'_>> = titled
        .iter()
        .map(|(title, picture, foot)| Panel { title, picture: picture.clone(), foot: caption(SIDE, &[foot]) })
        .collect();
    let what = "LTCs between two matrices, seen from above; colours by the root of the density";
    Ok(headed(&[&[what]], &grid(&panels, WEIGHTS.len() as u32)))
}

/// The matrix with a third column of unit length, as the paper stores it.
fn normalised(m: DMat3) -> DMat3 {
    m * (1.0 / m.z_axis.length())
}
