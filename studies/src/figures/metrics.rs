//! Figure 4: lobes fitted with two metrics, from good and from bad starts.

use std::ops::ControlFlow;

use glam::{DMat3, DVec3};
use ltcforge::{
    fit::{
        FittedEntry, Fitter, Ltc, Metric, StopCheck,
        brdf::{Brdf, Ggx},
        math::{direction, from_row_major},
    },
    view::picture::{Panel, Picture, caption, grid, headed},
};

use super::{
    error::FigureError,
    fits::from_any_start,
    hemisphere::{hemisphere, peak},
};

/// Side of a lobe's picture in pixels.
const SIDE: u32 = 176;

/// A lobe, and the start of both searches as a matrix in the frame of the lobe.
struct Case {
    name: &'static str,
    alpha: f64,
    theta: f64,
    start: DMat3,
}

/// The paper's cases: a close start, a start that does not overlap the lobe, and a diffuse start for a sharp lobe.
const CASES: [Case; 3] = [
    Case { name: "(a) diffuse, rough lobe", alpha: 0.5, theta: 0.6, start: DMat3::IDENTITY },
    Case {
        name: "(b) beside the lobe",
        alpha: 0.03,
        theta: 0.6,
        start: DMat3::from_cols(DVec3::new(0.03, 0.0, 0.0), DVec3::new(0.0, 0.03, 0.0), DVec3::new(-0.9, 0.0, 1.0)),
    },
    Case { name: "(c) diffuse, sharp lobe", alpha: 0.03, theta: 0.6, start: DMat3::IDENTITY },
];

/// For each case, draws the start, the fits with both metrics, and the lobe, on the scale of the lobe.
pub(super) fn draw() -> Result<Picture, FigureError> {
    let mut titled = Vec::new();
    for Case { name, alpha, theta, start } in CASES {
        let (ggx, wo) = (Ggx { alpha_x: alpha, alpha_y: alpha }, direction(theta, 0.0));
        let fitted = |metric: Metric| {
            let mut go_on = || ControlFlow::Continue(());
            let mut fitter = Fitter::new(&from_any_start(metric));
            let entry =
                fitter.fit_from(&ggx, wo, start, &mut StopCheck::new(&mut go_on)).ok_or(FigureError::Stopped)?;
            Ok::<_, FigureError>((entry, fitter.frame(&ggx, wo) * start))
        };
        let (FittedEntry { matrix, amplitude, error, .. }, first) = fitted(Metric::L3)?;
        let (transported, _) = fitted(Metric::Sw1)?;
        let wanted = |wi: DVec3| ggx.eval_cos(wo, wi) / amplitude;
        let scale = peak(SIDE, wanted);
        let shown = |m: DMat3| {
            let ltc = Ltc::new(m);
            hemisphere(SIDE, scale, move |wi| ltc.as_ref().map_or(0.0, |ltc| ltc.pdf(wi)))
        };
        titled.push((name.to_owned(), shown(first), "start".to_owned()));
        titled.push((format!("alpha {alpha}"), shown(from_row_major(&matrix)), format!("L3, off by {error:.4}")));
        let foot = format!("sw1, off by {:.4}", transported.error);
        titled.push((String::new(), shown(from_row_major(&transported.matrix)), foot));
        titled.push((String::new(), hemisphere(SIDE, scale, wanted), "GGX".to_owned()));
    }
    let panels: Vec<Panel<'_>> = titled
        .iter()
        .map(|(title, picture, foot)| Panel { title, picture: picture.clone(), foot: caption(SIDE, &[foot]) })
        .collect();
    let what = "From one start by two metrics; colours by the root of the density";
    Ok(headed(&[&[what], &["off by: the sliced Wasserstein distance"]], &grid(&panels, 4)))
}
