//! Compares the quadrature in the space of normals with a quadrature over the light's area, and with known values.

use glam::DVec3;
use rayon::prelude::*;

use crate::cases::{Draw, Lit, Roughness, over_area};
use crate::{NormalsRule, PolygonLight, ReflectedLight, by_normals, truth, truth_within};
use ltcforge_fit::{
    Configuration, Sides,
    brdf::{Brdf, Ggx},
    math::{Lattice, direction},
};

fn true_light(lit: &Lit, sides: Sides) -> ReflectedLight {
    truth(&lit.at, &lit.light(sides)).expect("a surface")
}

/// The error of the midpoint rule falls to a quarter if the cells are halved. This holds if no cell is as wide as the
/// lobe and no horizon cuts the light. Cells cut by a horizon have an error of half their light.
#[test]
fn it_agrees_with_a_quadrature_over_the_lights_area() {
    let is_broad = |lit: &&Lit| lit.at.alpha_x.min(lit.at.alpha_y) > 0.1;
    let cases: Vec<Lit> = Draw::many(1, 200, Roughness::All).iter().filter(is_broad).cloned().collect();
    let cut = cases.iter().filter(|lit| lit.vertices.iter().any(|v| v.z < 0.0)).count();
    assert!(cases.len() > 50 && cut > 10 && cut < cases.len() - 10, "{cut} of {}", cases.len());
    cases.par_iter().for_each(|lit| {
        let found = true_light(lit, Sides::Two);
        let [coarse, fine] = [200, 400].map(|n| over_area(lit, n));
        let is_cut = lit.vertices.iter().any(|v| v.z < 0.01);
        for (found, coarse, fine) in [(found.energy, coarse[0], fine[0]), (found.fresnel, coarse[1], fine[1])] {
            let (wanted, tolerance) = if is_cut { (fine, 3e-5) } else { (fine + (fine - coarse) / 3.0, 2e-7) };
            assert!((found - wanted).abs() < tolerance, "{found} {wanted} {is_cut} {lit:?}");
        }
    });
}

/// A lower tolerance changes the result by at most the higher tolerance.
#[test]
fn it_converges_for_mirrors_needles_and_horizons() {
    let worst = Draw::many(2, 150, Roughness::Extreme)
        .par_iter()
        .map(|lit| {
            let rough = truth_within(1e-6, &lit.at, &lit.light(Sides::Two)).expect("a surface");
            let fine = true_light(lit, Sides::Two);
            let finest = truth_within(1e-10, &lit.at, &lit.light(Sides::Two)).expect("a surface");
            assert!((rough.energy - finest.energy).abs() < 1e-5, "{rough:?} {finest:?} {lit:?}");
            (fine.energy - finest.energy).abs().max((fine.fresnel - finest.fresnel).abs())
        })
        .reduce(|| 0.0, f64::max);
    println!("worst change {worst:.1e}");
    assert!(worst < 1e-8, "{worst}");
}

/// Compares with the weighted part of reflected rays that hit the light, for lobes of any sharpness.
#[test]
fn it_agrees_with_sampled_rays_where_lobes_are_sharp() {
    const RAYS: usize = 1 << 15;
    let sums = Draw::many(3, 300, Roughness::Extreme)
        .par_iter()
        .map(|lit| {
            let ggx = Ggx { alpha_x: lit.at.alpha_x, alpha_y: lit.at.alpha_y };
            let inside: DVec3 = lit.vertices.iter().sum();
            let ends = lit.vertices.iter().zip(lit.vertices.iter().cycle().skip(1));
            let planes: Vec<DVec3> = ends.map(|(a, b)| a.cross(*b)).collect();
            let side = planes[0].dot(inside).signum();
            let (mut energy, mut energy2) = (0.0, 0.0);
            for u in Lattice::new(RAYS, [0.3, 0.7]).points() {
                let ray = ggx.sample(lit.wo(), u);
                if ray.wi.z > 0.0 && planes.iter().all(|plane| side * plane.dot(ray.wi) > 0.0) {
                    energy += ray.weight;
                    energy2 += ray.weight * ray.weight;
                }
            }
            let mean = energy / RAYS as f64;
            let deviation = ((energy2 / RAYS as f64 - mean * mean).max(0.0) / RAYS as f64).sqrt();
            let error = (mean - true_light(lit, Sides::Two).energy).abs();
            // A lattice is more uniform than random samples.
            assert!(error < 3.0 * deviation + 4.0 / RAYS as f64, "{mean} {error} {deviation} {lit:?}");
            [error, deviation]
        })
        .reduce(|| [0.0; 2], |[a, b], [c, d]| [a + c, b + d]);
    assert!(sums[0] < 0.5 * sums[1], "{sums:?}");
}

#[test]
fn extremes_are_finite_and_known_ones_right() {
    let square = |centre: DVec3, x: DVec3, y: DVec3| {
        let vertices = vec![centre - x - y, centre - x + y, centre + x + y, centre + x - y];
        PolygonLight::new(vertices, Sides::Two).expect("convex")
    };
    let at = |alpha_x: f64, alpha_y: f64, theta: f64| Configuration { alpha_x, alpha_y, theta, phi: 0.0 };
    let energy = |at: Configuration, light: &PolygonLight| {
        let found = truth(&at, light).expect("a surface");
        assert!(found.energy.is_finite() && (0.0..=found.energy + 1e-9).contains(&found.fresnel), "{at:?} {found:?}");
        // The closed form handles these lights too. Its error is the error of its weight, which is largest if light is
        // all around.
        let normals = by_normals(&at, light, NormalsRule::Balanced).expect("a surface");
        assert!((normals.energy - found.energy).abs() < 0.035, "{at:?} {normals:?} {found:?}");
        found.energy
    };
    let overhead = square(2.0 * DVec3::Z, DVec3::X, DVec3::Y);
    // A mirror reflects all of a light around the mirror direction, and half of a light that ends there.
    assert!((energy(at(1e-4, 1e-4, 0.0), &overhead) - 1.0).abs() < 1e-6);
    let half = square(DVec3::new(1.0, 0.0, 2.0), DVec3::X, DVec3::Y);
    assert!((energy(at(1e-4, 1e-4, 0.0), &half) - 0.5).abs() < 1e-4);
    assert!((energy(at(1e-4, 1e-6, 0.0), &half) - 0.5).abs() < 1e-4);
    // A light over the whole hemisphere gives the albedo.
    let everything = square(DVec3::Z, 50.0 * DVec3::X, 50.0 * DVec3::Y);
    let dome = square(0.001 * DVec3::Z, 50.0 * DVec3::X, 50.0 * DVec3::Y);
    for surface in [at(0.3, 0.3, 0.5), at(1.0, 0.1, 1.2), at(0.01, 0.01, 1.5)] {
        let ggx = Ggx { alpha_x: surface.alpha_x, alpha_y: surface.alpha_y };
        let points = Lattice::new(1 << 16, [0.0; 2]).points();
        let wo = direction(surface.theta, surface.phi);
        let albedo = points.map(|u| ggx.sample(wo, u).weight).sum::<f64>() / f64::from(1 << 16);
        let found = energy(surface, &dome);
        assert!((found - albedo).abs() < 2e-4, "{surface:?}: {found} {albedo}");
        assert!(energy(surface, &everything) < found);
    }
    // Lights on, through and below the horizon, behind the viewer, edge-on, and tiny; an edge of zero length.
    let through = square(5.0 * DVec3::X, DVec3::Y, DVec3::Z);
    let low = energy(at(0.05, 0.05, 1.55), &square(-5.0 * DVec3::X, DVec3::Y, DVec3::Z));
    assert!(low > 0.5, "{low}");
    assert!(energy(at(0.05, 0.05, 1.55), &through) < 1e-3);
    assert_eq!(energy(at(0.5, 0.5, 0.3), &square(-2.0 * DVec3::Z, DVec3::X, DVec3::Y)), 0.0);
    assert!(energy(at(0.5, 0.5, 0.3), &square(2.0 * DVec3::Z, DVec3::X, DVec3::Z)) < 1e-12);
    let tiny = energy(at(0.5, 0.5, 0.3), &square(DVec3::Z, 1e-5 * DVec3::X, 1e-5 * DVec3::Y));
    let small = energy(at(0.5, 0.5, 0.3), &square(DVec3::Z, 1e-3 * DVec3::X, 1e-3 * DVec3::Y));
    assert!((tiny * 1e4 / small - 1.0).abs() < 1e-3, "{tiny} {small}");
    let repeated = [0, 0, 1, 2, 2, 3].map(|i| overhead.vertices()[i]).to_vec();
    let repeated = PolygonLight::new(repeated, Sides::Two).expect("convex");
    assert!((energy(at(0.3, 0.1, 0.7), &repeated) - energy(at(0.3, 0.1, 0.7), &overhead)).abs() < 1e-9);
    let flat = PolygonLight::new(vec![DVec3::Z; 3], Sides::Two).expect("a point");
    assert_eq!(energy(at(0.3, 0.1, 0.7), &flat), 0.0);
}

#[test]
fn one_side_is_lit() {
    for lit in Draw::many(4, 40, Roughness::All) {
        let both = true_light(&lit, Sides::Two);
        let mut turned = lit.clone();
        turned.vertices.reverse();
        let [front, back] = [&lit, &turned].map(|lit| true_light(lit, Sides::One));
        let (lit_side, dark) = if front.energy > 0.0 { (front, back) } else { (back, front) };
        assert!(
            (lit_side.energy - both.energy).abs() < 1e-8 && dark == ReflectedLight::NONE,
            "{front:?} {back:?} {both:?}"
        );
    }
}
