//! Tests the truth of every scattering model: with sums over lights, with its own sampler, in the furnace, and at the
//! limits of the range.

use std::{
    f64::consts::{FRAC_PI_2, PI},
    sync::Arc,
};

use glam::DVec3;
use rayon::prelude::*;

use super::shaped_lights::{Case, cases};
use crate::cases::{Draw, Lit, Roughness, cosine, over_area_of};
use crate::{
    LightError, LightModel, Lighting, PolygonLight, RandomLights, ReflectedLight, light_error, rectangle, truth_of,
};
use ltcforge_fit::{
    BrdfKind, BrdfModel, Configuration, PerAxis, Sides, TabulatedAxes, TabulatedBrdf, TabulatedFile,
    math::{Lattice, direction},
    testing::{planted_anisotropic, planted_tabulated},
};

/// All models except GGX, including tabulated files.
fn models() -> impl Iterator<Item = BrdfModel> {
    let files = [planted_tabulated(), planted_anisotropic()];
    BrdfKind::formulas().filter(|kind| *kind != BrdfKind::Ggx).map(BrdfModel::from).chain(files)
}

fn to(tolerance: f64, brdf: &BrdfModel, lit: &Lit) -> ReflectedLight {
    truth_of(brdf, tolerance, &lit.at, &lit.light(Sides::Two)).expect("a surface")
}

/// True for surfaces that a sum of some 10^5 cells resolves.
fn is_broad(lit: &Lit) -> bool {
    lit.at.alpha_x.min(lit.at.alpha_y) > 0.15
}

/// The largest difference from the finer of two sums, minus the difference between both sums.
fn beyond(found: ReflectedLight, [coarse, fine]: [[f64; 2]; 2]) -> f64 {
    let off = |found: f64, i: usize| (found - fine[i]).abs() - (fine[i] - coarse[i]).abs();
    off(found.energy, 0).max(off(found.fresnel, 1))
}

#[test]
fn it_is_the_sum_over_a_polygon() {
    let lit: Vec<Lit> = Draw::many(101, 30, Roughness::All).into_iter().filter(is_broad).collect();
    let cut = lit.iter().filter(|lit| lit.vertices.iter().any(|v| v.z < 0.0)).count();
    assert!(lit.len() > 10 && (2..lit.len() - 2).contains(&cut), "{cut} of {}", lit.len());
    for brdf in models() {
        let off = |lit: &Lit| {
            let surface = brdf.surface(lit.alpha());
            beyond(to(1e-9, &brdf, lit), [70, 210].map(|n| over_area_of(&*surface, lit, n)))
        };
        let worst = lit.par_iter().map(off).reduce(|| f64::NEG_INFINITY, f64::max);
        println!("{brdf}: error beyond the change of the sum {worst:.1e}");
        assert!(worst < 2e-6, "{brdf}: {worst}");
    }
}

#[test]
fn it_is_the_sum_over_other_shapes() {
    let mut draw = Draw::new(102);
    let mut lights: Vec<(Configuration, Case)> = Vec::new();
    while lights.len() < 20 {
        let lit = draw.lit(Roughness::All);
        let centre = lit.vertices[0].midpoint(lit.vertices[2]);
        if is_broad(&lit) {
            lights.extend(cases(&mut draw, centre).map(|case| (lit.at, case)));
        }
    }
    for brdf in models() {
        let off = |(at, case): &(Configuration, Case)| {
            let (surface, wo) = (brdf.surface([at.alpha_x, at.alpha_y]), direction(at.theta, at.phi));
            let found = truth_of(&brdf, 1e-9, at, &case.light().ok()?).expect("a surface");
            Some(beyond(found, [60, 180].map(|n| case.by_sum(&*surface, wo, n))))
        };
        let found: Vec<f64> = lights.par_iter().filter_map(off).collect();
        let worst = found.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        println!("{brdf}: {} lights, error beyond the change of the sum {worst:.1e}", found.len());
        assert!(found.len() > 15 && worst < 1e-5, "{brdf}: {worst} of {}", found.len());
    }
}

/// Compares with weighted samples that hit the light, from the model's sampler, for lobes of any sharpness and views up
/// to 89.9 degrees.
#[test]
fn it_is_the_mean_of_sampled_rays() {
    const RAYS: usize = 1 << 13;
    for brdf in models() {
        let errors = |lit: &Lit| {
            let surface = brdf.surface(lit.alpha());
            let inside: DVec3 = lit.vertices.iter().sum();
            let ends = lit.vertices.iter().zip(lit.vertices.iter().cycle().skip(1));
            let planes: Vec<DVec3> = ends.map(|(a, b)| a.cross(*b)).collect();
            let side = planes[0].dot(inside).signum();
            let (mut sum, mut sum2, mut most) = (0.0, 0.0, 0.0_f64);
            for u in Lattice::new(RAYS, [0.3, 0.7]).points() {
                let ray = surface.sample(lit.wo(), u);
                if ray.wi.z > 0.0 && planes.iter().all(|plane| side * plane.dot(ray.wi) > 0.0) {
                    sum += ray.weight;
                    sum2 += ray.weight * ray.weight;
                    most = most.max(ray.weight);
                }
            }
            let mean = sum / RAYS as f64;
            let deviation = ((sum2 / RAYS as f64 - mean * mean).max(0.0) / RAYS as f64).sqrt();
            let error = (mean - to(1e-7, &brdf, lit).energy).abs();
            // A lattice is more uniform than random samples.
            let allowed = 3.0 * deviation + 6.0 * most.max(1.0) / RAYS as f64 + 1e-6;
            assert!(error < allowed, "{brdf}: {mean} {error} {deviation} {lit:?}");
            [error, deviation]
        };
        let lit = Draw::many(103, 25, Roughness::Extreme);
        let sums = lit.par_iter().map(errors).reduce(|| [0.0; 2], |[a, b], [c, d]| [a + c, b + d]);
        assert!(sums[0] < 0.6 * sums[1], "{brdf}: {sums:?}");
    }
}

/// A lower tolerance changes the result by at most the higher tolerance.
#[test]
fn it_converges_for_mirrors_and_horizons() {
    for brdf in models() {
        let change = |lit: &Lit| {
            let [rough, usual, fine] = [1e-5, 1e-9, 1e-10].map(|tolerance| to(tolerance, &brdf, lit));
            assert!((rough.energy - fine.energy).abs() < 1e-4, "{brdf}: {rough:?} {fine:?} {lit:?}");
            (usual.energy - fine.energy).abs().max((usual.fresnel - fine.fresnel).abs())
        };
        let lit = Draw::many(104, 10, Roughness::Extreme);
        let worst = lit.par_iter().map(change).reduce(|| 0.0, f64::max);
        println!("{brdf}: worst change {worst:.1e}");
        assert!(worst < 2e-8, "{brdf}: {worst}");
    }
}

/// A light over the whole hemisphere gives the albedo, also if a model reflects more light than it receives.
#[test]
fn everything_around_gives_the_albedo() {
    let dome = rectangle(1e-4 * DVec3::Z, [50.0 * DVec3::X, 50.0 * DVec3::Y], Sides::Two).expect("convex");
    let mut most = 0.0_f64;
    for brdf in models() {
        for (alpha, theta) in [(1.0, 0.0), (0.3, 0.5), (0.05, 1.2), (0.01, 1.5)] {
            let at = Configuration { alpha_x: alpha, alpha_y: alpha, theta, phi: 0.3 };
            let found = truth_of(&brdf, 1e-7, &at, &dome).expect("a surface").energy;
            let (surface, wo) = (brdf.surface([alpha; 2]), direction(theta, 0.3));
            let points = Lattice::new(1 << 14, [0.0; 2]).points();
            let albedo = points.map(|u| surface.sample(wo, u).weight).sum::<f64>() / f64::from(1 << 14);
            assert!((found - albedo).abs() < 1e-3 * albedo.max(0.1), "{brdf} {alpha} {theta}: {found} {albedo}");
            most = most.max(found);
        }
    }
    assert!(most > 1.2, "sheen gains light: {most}");
}

#[test]
fn extremes_are_finite_and_known_ones_right() {
    let square = |centre: DVec3, x: DVec3, y: DVec3| {
        let vertices = vec![centre - x - y, centre - x + y, centre + x + y, centre + x - y];
        PolygonLight::new(vertices, Sides::Two).expect("convex")
    };
    let overhead = square(2.0 * DVec3::Z, DVec3::X, DVec3::Y);
    let behind = square(-2.0 * DVec3::Z, DVec3::X, DVec3::Y);
    let through = square(-5.0 * DVec3::X, DVec3::Y, DVec3::Z);
    let edge_on = square(2.0 * DVec3::Z, DVec3::X, DVec3::Z);
    for brdf in models() {
        let energy = |at: &Configuration, light: &PolygonLight| {
            let found = truth_of(&brdf, 1e-8, at, light).expect("a surface");
            let bounded = found.energy < 10.0 && (0.0..=found.energy + 1e-8).contains(&found.fresnel);
            assert!(bounded, "{brdf} {at:?} {found:?}");
            found.energy
        };
        for (alpha, theta) in [(1e-8, 0.0), (1e-5, 1.57), (1.0, 1.5705), (1.0, 0.0), (0.0, 0.7)] {
            let at = Configuration { alpha_x: alpha, alpha_y: alpha, theta, phi: -2.0 };
            assert_eq!(energy(&at, &behind), 0.0, "{brdf} {at:?}");
            assert!(energy(&at, &edge_on) < 1e-8, "{brdf} {at:?}");
            energy(&at, &overhead);
            energy(&at, &through);
        }
        let at = Configuration { alpha_x: 0.5, alpha_y: 0.5, theta: 0.6, phi: 0.2 };
        let [tiny, small] = [1e-5, 1e-3].map(|size| energy(&at, &square(DVec3::Z, size * DVec3::X, size * DVec3::Y)));
        assert!((tiny * 1e4 / small - 1.0).abs() < 1e-3, "{brdf}: {tiny} {small}");
        let one_sided = |vertices: Vec<DVec3>| {
            let light = PolygonLight::new(vertices, Sides::One).expect("convex");
            truth_of(&brdf, 1e-8, &at, &light).expect("a surface").energy
        };
        let turned: Vec<DVec3> = overhead.vertices().iter().rev().copied().collect();
        let [one, other] = [overhead.vertices().to_vec(), turned].map(one_sided);
        assert!(one.min(other) == 0.0 && (one.max(other) - energy(&at, &overhead)).abs() < 1e-9, "{brdf}");
    }
    // A mirror with normally distributed slopes reflects half of a light that ends at its reflection.
    let half = square(DVec3::new(1.0, 0.0, 2.0), DVec3::X, DVec3::Y);
    let mirror = Configuration { alpha_x: 1e-4, alpha_y: 1e-5, theta: 0.0, phi: 0.0 };
    let found = truth_of(&BrdfKind::Beckmann.into(), 1e-9, &mirror, &half).expect("a surface").energy;
    assert!((found - 0.5).abs() < 1e-4, "{found}");
    let unread = BrdfModel::tabulated(TabulatedFile::unread([7; 32]));
    assert_eq!(truth_of(&unread, 1e-9, &mirror, &half), Err(LightError::NoBrdfFile));
    assert_eq!(RandomLights::draw(&unread, &RANGE, 3).err(), Some(LightError::NoBrdfFile));
}

const RANGE: PerAxis<[f64; 2]> =
    PerAxis { alpha: [0.0, 1.0], ratio: [1.0, 1.0], theta: [0.0, FRAC_PI_2], phi: [0.0, 0.0] };

/// Lambertian reflection as a tabulated BRDF.
fn lambert() -> BrdfModel {
    let axes = TabulatedAxes::spread(vec![], 9, 5);
    let count = axes.shape().iter().product();
    let brdf = TabulatedBrdf::new(axes, vec![0.8 / PI; count]).expect("a BRDF");
    BrdfModel::tabulated(TabulatedFile::new([8; 32], Arc::new(brdf)))
}

/// A clamped cosine is exact for Lambertian reflection, with terms computed by the measurement. It is a poor lobe for
/// sheen.
#[test]
fn a_table_is_measured_by_what_it_stands_for() {
    let error = |brdf: &BrdfModel| {
        let lights = RandomLights::draw(brdf, &RANGE, 60).expect("ranges of a table");
        (light_error(Lighting::by(&cosine(brdf.clone())), &lights).expect("a lobe"), lights.mean_energy())
    };
    let (exact, energy) = error(&lambert());
    assert!(exact.max < 1e-4 && (0.05..0.8).contains(&energy), "{exact:?} {energy}");
    let [near, far] = [BrdfKind::BurleyDiffuse, BrdfKind::Charlie].map(|kind| error(&kind.into()).0);
    assert!(near.mean < 0.1 && near.mean > 10.0 * exact.mean && far.mean > 2.0 * near.mean, "{near:?} {far:?}");
}

/// Closed forms are only for GGX, and lights are only for their own model.
#[test]
fn lights_and_forms_of_another_model_are_refused() {
    let lights = RandomLights::draw(&BrdfKind::OrenNayar.into(), &RANGE, 2).expect("ranges of a table");
    for form in LightModel::ALL.iter().flat_map(|model| model.closed_forms()) {
        assert_eq!(
            light_error(Lighting::ClosedForm(form), &lights).err(),
            Some(LightError::OtherBrdf(BrdfKind::OrenNayar))
        );
    }
    let burley = cosine(BrdfKind::BurleyDiffuse.into());
    let refused = LightError::OtherLights { lights: BrdfKind::OrenNayar, table: BrdfKind::BurleyDiffuse };
    assert_eq!(light_error(Lighting::by(&burley), &lights).err(), Some(refused));
}
