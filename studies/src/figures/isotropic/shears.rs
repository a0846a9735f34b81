//! The effect of a shear on a clamped cosine, and on LTCs fitted to GGX: whole lobes, and their magnified backs on the
//! viewer's side of the normal.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};

use ltcforge::{
    fit::{
        Ltc, Shear,
        brdf::{Brdf, Ggx},
        math::{direction, sin_cos},
    },
    view::picture::{Panel, Picture, grid, headed},
};

use super::fits::lobe;
use crate::figures::curves::{Curve, Frame, legend};

/// Points per curve.
const POINTS: u32 = 720;
/// Skews of the drawn cosines.
const SKEWS: [f64; 3] = [0.0, 0.4, 0.8];
const SKEW_COLOURS: [[u8; 3]; 3] = [[235, 235, 235], [240, 160, 60], [90, 190, 250]];
const SKEW_NAMES: [(&str, [u8; 3]); 3] =
    [("no skew", SKEW_COLOURS[0]), ("0.4", SKEW_COLOURS[1]), ("0.8", SKEW_COLOURS[2])];
/// Roughness and view angle (in degrees) of the drawn lobes.
const LOBES: [(f64, f64); 2] = [(0.25, 60.0), (0.04, 80.0)];
const GGX: [u8; 3] = [235, 235, 235];
const LTC: [u8; 3] = [240, 160, 60];
const LOBE_NAMES: [(&str, [u8; 3]); 2] = [("GGX", GGX), ("LTC", LTC)];
/// The width of the picture of a lobe's back, as a part of the peak.
const BACK: f64 = 0.02;

/// The pictures for one shear.
pub(in crate::figures) fn draw(shear: Shear) -> Picture {
    let lobe = |(alpha, degrees): (f64, f64), part: f64| {
        let side = if part < 1.0 { "back" } else { "front" };
        let picture = lobes(shear, alpha, degrees.to_radians(), part);
        panel(format!("alpha {alpha}, view {degrees} degrees: {side}"), picture, &LOBE_NAMES)
    };
    let [broad, sharp] = LOBES;
    let panels = [
        panel("skewed cosine, polar".to_owned(), cosines_around(shear), &SKEW_NAMES),
        lobe(broad, 1.0),
        lobe(sharp, 1.0),
        panel("skewed cosine over degrees".to_owned(), cosines_over(shear), &SKEW_NAMES),
        lobe(broad, BACK),
        lobe(sharp, BACK),
    ];
    let drawn: Vec<Panel<'_>> = panels
        .iter()
        .map(|(title, picture, foot)| Panel { title, picture: picture.clone(), foot: foot.clone() })
        .collect();
    let what = match shear {
        Shear::X => "shear x: the third column's number shifts the cosine, and leaves nothing behind it",
        Shear::Z => "shear z: the third row's number tilts the cosine, and leaves a part of it behind",
    };
    let how = "in the plane of incidence, polar graphs over the peak of GGX; back: fifty times as large";
    headed(&[&[what], &[how]], &grid(&drawn, 3))
}

fn panel(title: String, picture: Picture, names: &[(&str, [u8; 3])]) -> (String, Picture, Picture) {
    let foot = legend(picture.width, names);
    (title, picture, foot)
}

/// Directions in the plane of incidence. The angle, in radians, is measured from the normal to the right.
fn around() -> impl Iterator<Item = (f64, DVec3)> {
    (0..=POINTS).map(|i| {
        let angle = PI * (2.0 * f64::from(i) / f64::from(POINTS) - 1.0);
        let (sin, cos) = sin_cos(angle);
        (angle, DVec3::new(sin, 0.0, cos))
    })
}

fn skewed(shear: Shear, skew: f64) -> Option<Ltc> {
    let mut m = DMat3::IDENTITY;
    match shear {
        Shear::X => m.z_axis.x = skew,
        Shear::Z => m.x_axis.z = skew,
    }
    Ltc::new(m)
}

/// One curve for each skew.
fn cosines(shear: Shear, point: impl Fn(f64, DVec3, f64) -> [f64; 2]) -> Vec<Curve> {
    let cosines = SKEWS.into_iter().zip(SKEW_COLOURS).rev();
    let curve = |(skew, colour): (f64, [u8; 3])| {
        let ltc = skewed(shear, skew)?;
        Some(Curve { points: around().map(|(angle, w)| point(angle, w, ltc.pdf(w))).collect(), colour })
    };
    cosines.filter_map(curve).collect()
}

fn cosines_around(shear: Shear) -> Picture {
    let frame = Frame { x: [-0.3, 0.4], y: [-0.15, 0.55], x_ticks: &[-0.2, 0.0, 0.2, 0.4], y_ticks: &[0.0, 0.2, 0.4] };
    frame.draw(&cosines(shear, |_, w, density| [w.x * density, w.z * density]))
}

fn cosines_over(shear: Shear) -> Picture {
    let x_ticks = [-90.0, 0.0, 90.0];
    let frame = Frame { x: [-150.0, 150.0], y: [0.0, 0.6], x_ticks: &x_ticks, y_ticks: &[0.0, 0.2, 0.4, 0.6] };
    frame.draw(&cosines(shear, |angle, _, density| [angle.to_degrees(), density]))
}

/// A lobe of GGX on the right, and its LTC. The picture is as wide as `part` of the peak.
fn lobes(shear: Shear, alpha: f64, theta: f64, part: f64) -> Picture {
    let (ggx, wo) = (Ggx { alpha_x: alpha, alpha_y: alpha }, direction(theta, 0.0));
    // The view is on the right and the lobes on the left. They are drawn mirrored, on the right.
    let mirrored = |w: DVec3| DVec3::new(-w.x, 0.0, w.z);
    let reflected: Vec<(DVec3, f64)> = around().map(|(_, w)| (w, ggx.eval_cos(wo, mirrored(w)))).collect();
    let peak = reflected.iter().map(|(_, f)| *f).fold(0.0, f64::max);
    let scale = 1.0 / (peak * part);
    let curve = |colour, of: &dyn Fn(DVec3, f64) -> f64| {
        let point = |(w, f): &(DVec3, f64)| [w.x, w.z].map(|x| x * of(*w, *f) * scale);
        Curve { points: reflected.iter().map(point).collect(), colour }
    };
    let mut curves = Vec::new();
    if let Some(ltc) = lobe(alpha, theta, shear).and_then(Ltc::new) {
        // The LTC gets the same albedo, computed from the mean weight of visible normals.
        let albedo = albedo(&ggx, wo);
        curves.push(curve(LTC, &|w, _| albedo * ltc.pdf(mirrored(w))));
    }
    curves.push(curve(GGX, &|_, f| f));
    let (x, x_ticks) = if part < 1.0 { ([-1.0, 0.4], [-1.0, 0.0]) } else { ([-0.2, 1.2], [0.0, 1.0]) };
    Frame { x, y: [-0.4, 1.0], x_ticks: &x_ticks, y_ticks: &[0.0, 1.0] }.draw(&curves)
}

fn albedo(ggx: &Ggx, wo: DVec3) -> f64 {
    let count = 64_u32;
    let u = |i: u32| (f64::from(i) + 0.5) / f64::from(count);
    let weights = (0..count).flat_map(|i| (0..count).map(move |j| ggx.sample(wo, [u(i), u(j)]).weight));
    weights.sum::<f64>() / f64::from(count * count)
}
