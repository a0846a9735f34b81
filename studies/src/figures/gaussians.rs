//! Gaussians that approximate GGX: distributions of normals, lobes in the plane of incidence, and errors of the light.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;
use rayon::prelude::*;

use ltcforge::{
    BrdfKind, LightError, PerAxis,
    fit::{
        brdf::Ggx,
        math::{cos, direction, exp, sin_cos},
    },
    light::{
        Gaussian, RandomLights,
        gaussians::{Lobe, Warp, by_warp},
        light_error_by,
    },
    view::picture::{Panel, Picture, grid, headed},
};

use super::curves::{Curve, Frame, legend};

/// The roughness of each row of panels.
const ROUGHNESSES: [f64; 2] = [0.25, 0.5];
/// The views for which lobes are drawn, in degrees.
const VIEWS: [f64; 2] = [0.0, 45.0];
/// Points per curve, and per curve of errors.
const POINTS: u32 = 360;
const ERRORS: u32 = 12;
/// The most grazing view for errors, in degrees.
const STEEPEST: f64 = 85.0;

const TRUE: [u8; 3] = [235, 235, 235];
const SG: [u8; 3] = [240, 160, 60];
const ASG: [u8; 3] = [90, 190, 250];
const SG_WARP: [u8; 3] = [150, 200, 70];
const ASG_WARP: [u8; 3] = [190, 110, 230];
const VIEW: [u8; 3] = [110, 110, 110];

/// The names and colours of the curves in a graph.
type Names = &'static [(&'static str, [u8; 3])];
const OF_NORMALS: Names = &[("GGX", TRUE), ("Beckmann", ASG_WARP), ("Gaussian", SG_WARP), ("SG", SG)];
const OF_LOBES: Names = &[("GGX", TRUE), ("sg", SG), ("asg", ASG), ("sg warp", SG_WARP), ("asg warp", ASG_WARP)];
const OF_ERRORS: Names = &[("sg", SG), ("asg", ASG), ("sg warp", SG_WARP), ("asg warp", ASG_WARP)];

/// The Gaussians for a surface, and the colours of their curves.
const GAUSSIANS: [(Gaussian, Warp, [u8; 3]); 4] = [
    (Gaussian::Sg, Warp::Surface, SG_WARP),
    (Gaussian::Asg, Warp::Surface, ASG_WARP),
    (Gaussian::Sg, Warp::Visible, SG),
    (Gaussian::Asg, Warp::Visible, ASG),
];

/// Draws three graphs for each of two roughnesses: the distribution of normals with its Gaussian, the lobes of two
/// views as polar graphs, and the mean error of `count` random lights against the view angle. Runs on the current rayon
/// pool, whose size does not change the picture.
///
/// # Errors
/// None: all surfaces are valid.
pub(super) fn draw(count: usize) -> Result<Picture, LightError> {
    let errors = ROUGHNESSES.map(|alpha| errors(alpha, count));
    let mut graphs = Vec::new();
    for (alpha, errors) in ROUGHNESSES.into_iter().zip(errors) {
        graphs.push((format!("D, alpha {alpha}, degrees"), normals(alpha), OF_NORMALS));
        for degrees in VIEWS {
            let title = format!("lobe, seen from {degrees} degrees");
            graphs.push((title, lobes(alpha, degrees.to_radians()), OF_LOBES));
        }
        graphs.push(("mean error of light over view".to_owned(), errors?, OF_ERRORS));
    }
    let panels: Vec<Panel<'_>> = graphs
        .iter()
        .map(|(title, picture, names)| {
            let foot = legend(picture.width, names);
            Panel { title, picture: picture.clone(), foot }
        })
        .collect();
    let what = "GGX and the Gaussians that stand for it: normals, lobes in the plane of incidence, and errors of light";
    let how = "polar graphs are scaled to the peak of GGX; warp: around the surface's own normal, as Wang et al. and Xu et al. have it";
    Ok(headed(&[&[what], &[how]], &grid(&panels, 4)))
}

/// Evenly spaced values from `low` to `high`.
fn steps([low, high]: [f64; 2], count: u32) -> impl Iterator<Item = f64> {
    (0..=count).map(move |i| low + (high - low) * f64::from(i) / f64::from(count))
}

/// The distributions of normals by angle from the surface's normal: GGX, Beckmann `exp(-tan^2 / a^2) / (pi a^2 cos^4)`,
/// the Gaussian `exp(-angle^2 / a^2) / (pi a^2)`, and the spherical Gaussian `exp(2 (cos - 1) / a^2) / (pi a^2)`.
fn normals(alpha: f64) -> Picture {
    let ggx = Ggx { alpha_x: alpha, alpha_y: alpha };
    let peak = 1.0 / (PI * alpha * alpha);
    let squared = |angle: f64| {
        let (sin, cos) = sin_cos(angle);
        (sin * sin, (cos * cos).max(1e-9))
    };
    let beckmann = |angle: f64| {
        let (sin2, cos2) = squared(angle);
        peak * exp(-sin2 / cos2 / (alpha * alpha)) / (cos2 * cos2)
    };
    let gaussian = |angle: f64| peak * exp(-angle * angle / (alpha * alpha));
    let spherical = |angle: f64| peak * exp(2.0 * (cos(angle) - 1.0) / (alpha * alpha));
    let curve = |colour, of: &dyn Fn(f64) -> f64| {
        let points = steps([0.0, FRAC_PI_2 - 1e-6], POINTS).map(|angle| [angle.to_degrees(), of(angle)]).collect();
        Curve { points, colour }
    };
    let curves = [
        curve(ASG_WARP, &beckmann),
        curve(SG_WARP, &gaussian),
        curve(SG, &spherical),
        curve(TRUE, &|angle| ggx.distribution(direction(angle, 0.0))),
    ];
    let ticks = [0.0, 0.5 * peak, peak];
    let frame = Frame { x: [0.0, 90.0], y: [0.0, 1.1 * peak], x_ticks: &[0.0, 30.0, 60.0, 90.0], y_ticks: &ticks };
    frame.draw(&curves)
}

/// The lobes for a view from the left, as distances from the middle of the surface.
fn lobes(alpha: f64, theta: f64) -> Picture {
    let ggx = Ggx { alpha_x: alpha, alpha_y: alpha };
    let wo = direction(theta, PI);
    let directions: Vec<DVec3> = steps([-FRAC_PI_2, FRAC_PI_2], POINTS)
        .map(|angle| {
            let (sin, cos) = sin_cos(angle);
            DVec3::new(sin, 0.0, cos)
        })
        .collect();
    let reflected = |wi: DVec3| density(&ggx, wo, wi);
    let peak = directions.iter().map(|wi| reflected(*wi)).fold(0.0, f64::max);
    let curve = |colour, of: &dyn Fn(DVec3) -> f64| {
        let point = |wi: &DVec3| [wi.x, wi.z].map(|x| x * of(*wi) / peak);
        Curve { points: directions.iter().map(point).collect(), colour }
    };
    let mut curves = vec![Curve { points: vec![[0.0, 0.0], [1.4 * wo.x, 1.4 * wo.z]], colour: VIEW }];
    for (gaussian, warp, colour) in GAUSSIANS {
        let lobe = Lobe::new(gaussian, warp, [alpha; 2], wo.to_array());
        curves.push(curve(colour, &|wi: DVec3| lobe.density(wi.to_array())));
    }
    curves.push(curve(TRUE, &reflected));
    Frame { x: [-1.2, 1.2], y: [-0.2, 2.2], x_ticks: &[-1.0, 0.0, 1.0], y_ticks: &[0.0, 1.0] }.draw(&curves)
}

/// `D G2 / (4 cos_o)`: the reflected light per steradian, for a Fresnel factor of one.
fn density(ggx: &Ggx, wo: DVec3, wi: DVec3) -> f64 {
    let g2 = ggx.g2_over_g1(wo, wi) / (1.0 + ggx.smith_lambda(wo));
    ggx.distribution((wo + wi).normalize()) * g2 / (4.0 * wo.z)
}

/// The mean error of light against the view angle in degrees, for surfaces with this roughness along x and random
/// ratios.
fn errors(alpha: f64, count: usize) -> Result<Picture, LightError> {
    let thetas: Vec<f64> = steps([0.0, STEEPEST], ERRORS).collect();
    let at = |degrees: &f64| -> Result<Vec<f64>, LightError> {
        let theta = [degrees.to_radians(); 2];
        let range = PerAxis { alpha: [alpha; 2], ratio: [0.0, 1.0], theta, phi: [0.0, FRAC_PI_2] };
        let lights = RandomLights::draw(&BrdfKind::Ggx.into(), &range, count)?;
        let error =
            |(gaussian, warp, _)| Ok(light_error_by(|at, light| by_warp(at, light, gaussian, warp), &lights)?.mean);
        GAUSSIANS.into_iter().map(error).collect()
    };
    let found: Vec<Vec<f64>> = thetas.par_iter().map(at).collect::<Result<_, _>>()?;
    let curve = |(which, (.., colour)): (usize, (Gaussian, Warp, [u8; 3]))| {
        let points = thetas.iter().zip(&found).map(|(theta, errors)| [*theta, errors[which]]).collect();
        Curve { points, colour }
    };
    let curves: Vec<Curve> = GAUSSIANS.into_iter().enumerate().map(curve).collect();
    let frame = Frame { x: [0.0, 90.0], y: [0.0, 0.2], x_ticks: &[0.0, 30.0, 60.0, 90.0], y_ticks: &[0.0, 0.1, 0.2] };
    Ok(frame.draw(&curves))
}

#[cfg(test)]
mod tests {
    use super::*;
    use ltcforge::fit::brdf::Brdf;

    #[test]
    fn the_picture_shows_every_curve_and_is_reproducible() {
        let drawn = draw(2).expect("surfaces");
        assert!(drawn == draw(2).expect("surfaces"), "the second picture differs");
        let count = |colour: [u8; 3]| drawn.rgb.iter().filter(|pixel| **pixel == colour).count();
        for colour in [TRUE, SG, ASG, SG_WARP, ASG_WARP, VIEW] {
            assert!(count(colour) > 200, "{colour:?}: {}", count(colour));
        }
        assert!(drawn != draw(3).expect("surfaces"), "the number of lights does not change the errors");
    }

    /// The scales of the panels depend on this equality.
    #[test]
    fn lobes_reflect_the_light_of_visible_normals() {
        let ggx = Ggx { alpha_x: 0.25, alpha_y: 0.25 };
        let (wo, count) = (direction(1.0, PI), 300_u32);
        let step = FRAC_PI_2 / f64::from(count);
        let places =
            |columns: u32| (0..count).flat_map(move |i| (0..columns).map(move |j| [i, j].map(|k| f64::from(k) + 0.5)));
        let sum: f64 = places(4 * count)
            .map(|[i, j]| direction(i * step, j * step))
            .map(|wi| density(&ggx, wo, wi) * (1.0 - wi.z * wi.z).sqrt() * step * step)
            .sum();
        let weights = places(count).map(|u| ggx.sample(wo, u.map(|x| x / f64::from(count))).weight);
        let wanted = weights.sum::<f64>() / f64::from(count * count);
        assert!((sum - wanted).abs() < 2e-3 && wanted < 1.0, "{sum} {wanted}");
    }
}
