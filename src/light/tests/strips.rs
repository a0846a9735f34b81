//! Low, wide lights that stand on the surface, and growing lights, must not turn dark. Moving lights follow the truth.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};
use rayon::prelude::*;

use crate::cases::{Draw, Lit, Roughness};
use crate::{NormalsRule, ReflectedLight, by_normals, truth_within};
use ltcforge_fit::{Configuration, Sides};

fn energy(lit: &Lit, rule: NormalsRule) -> f64 {
    by_normals(&lit.at, &lit.light(Sides::Two), rule).expect("a surface").energy
}

fn truth(lit: &Lit) -> f64 {
    truth_within(1e-6, &lit.at, &lit.light(Sides::Two)).expect("a surface").energy
}

/// A strip opposite to the viewer, 0.02 to 0.5 high, 1 to 8 wide, at a distance of 0.5 to 4.
fn strip(draw: &mut Draw) -> Lit {
    let wall = draw.wall(Roughness::All, 0.0, 0.0);
    let towards = wall.at.phi + TAU * draw.within(0.4, 0.6);
    let turned = towards + draw.within(-0.6, 0.6);
    let mut logarithmic = |low: f64, high: f64| draw.within(low.ln(), high.ln()).exp();
    let middle = DVec3::new(towards.cos(), towards.sin(), 0.0) * logarithmic(0.5, 4.0);
    let x = DVec3::new(-turned.sin(), turned.cos(), 0.0) * logarithmic(0.5, 4.0);
    let top = DVec3::Z * logarithmic(0.02, 0.5);
    Lit { at: wall.at, vertices: vec![middle - x, middle + x, middle + x + top, middle - x + top] }
}

/// Strips of light on a floor. Triangles around the mean normal alone left them dark.
#[test]
fn strips_on_a_floor_are_lit() {
    let strips = [(0.3, 1.5, 0.1, 0.0145), (0.3, 1.55, 0.1, 0.0172), (0.5, 1.2, 0.2, 0.0059)];
    for (roughness, theta, height, known) in strips {
        let alpha: f64 = roughness * roughness;
        let vertices = [(-4.0, 0.0), (-4.0, height), (4.0, height), (4.0, 0.0)];
        let vertices = vertices.map(|(y, z)| DVec3::new(-3.0, y, z)).to_vec();
        let lit = Lit { at: Configuration { alpha_x: alpha, alpha_y: alpha, theta, phi: 0.0 }, vertices };
        let wanted = truth(&lit);
        assert!((wanted - known).abs() < 1e-4, "{wanted} {known}");
        for rule in NormalsRule::ALL {
            let found = energy(&lit, *rule);
            println!("{rule}: {found:.5} of {wanted:.5}");
            assert!((found - wanted).abs() < 0.008 && found > 0.2 * wanted, "{rule}: {found}, not {wanted}");
        }
    }
}

/// Almost no random strip is nearly black, and their errors are like the errors of other lights.
#[test]
fn no_strip_is_dark() {
    let mut draw = Draw::new(211);
    let strips: Vec<Lit> = (0..4000).map(|_| strip(&mut draw)).collect();
    let wanted: Vec<f64> = strips.par_iter().map(truth).collect();
    for (rule, limits, most_dark) in [
        (NormalsRule::Fast, [0.0025, 0.009], 8),
        (NormalsRule::Balanced, [0.0018, 0.007], 0),
        (NormalsRule::Fine, [0.0012, 0.0045], 0),
    ] {
        let found: Vec<f64> = strips.par_iter().map(|lit| energy(lit, rule)).collect();
        let dark = found.iter().zip(&wanted).filter(|(found, wanted)| **wanted > 0.001 && **found < 0.2 * **wanted);
        let dark = dark.count();
        let mut errors: Vec<f64> = found.iter().zip(&wanted).map(|(found, wanted)| (found - wanted).abs()).collect();
        errors.sort_by(f64::total_cmp);
        let spread = [errors.iter().sum::<f64>() / errors.len() as f64, errors[errors.len() * 95 / 100]];
        println!("{rule}: {spread:.5?}, {dark} dark");
        assert!(
            spread.iter().zip(limits).all(|(found, limit)| *found < limit) && dark <= most_dark,
            "{rule}: {spread:?} {dark}"
        );
    }
}

/// A light that grows about its middle or to one side loses little light.
#[test]
fn growing_lights_lose_little() {
    // A few lights lose up to 0.05 when they grow to cover nearly all directions.
    for (rule, about_middle, to_one_side) in [
        (NormalsRule::Balanced, [0.003, 0.05], [0.002, 0.03]),
        (NormalsRule::Fast, [0.001, 0.02], [0.009, 0.02]),
        (NormalsRule::Fine, [0.003, 0.05], [0.003, 0.03]),
    ] {
        for (is_middle, limits) in [(true, about_middle), (false, to_one_side)] {
            let drop = |seed: u64| {
                let mut draw = Draw::new(3000 + seed);
                let lit =
                    if seed.is_multiple_of(3) { strip(&mut draw) } else { draw.lit_by(Roughness::All, [0.02, 0.2]) };
                let [a, b, c, d] = std::array::from_fn(|i| lit.vertices[i]);
                let grown = |by: f64| {
                    let vertices = if is_middle {
                        [a, b, c, d].map(|v| a.midpoint(c) + (v - a.midpoint(c)) * by)
                    } else {
                        [a, a + (b - a) * by, d + (c - d) * by, d]
                    };
                    energy(&Lit { vertices: vertices.to_vec(), ..lit.clone() }, rule)
                };
                let fall = |(most, worst): (f64, f64), energy: f64| {
                    let most = most.max(energy);
                    (most, worst.max(most - energy))
                };
                (0..60).map(|i| grown(1.1_f64.powi(i))).fold((0.0, 0.0), fall).1
            };
            let mut drops: Vec<f64> = (0..2000).into_par_iter().map(drop).collect();
            drops.sort_by(f64::total_cmp);
            println!("{rule}, {is_middle}: drops by {:.4} (p99), {:.4} at most", drops[1980], drops[1999]);
            assert!(drops[1980] < limits[0] && drops[1999] < limits[1], "{rule}: {} {}", drops[1980], drops[1999]);
        }
    }
}

/// A light moves by its width and turns about its normal in twelve steps. From step to step, the reflected light of metal
/// and of plastic changes like the truth.
#[test]
fn a_light_that_moves_changes_like_the_truth() {
    const STEPS: usize = 12;
    let path = |seed: u64| -> Vec<Lit> {
        let lit = Draw::new(5000 + seed).lit_by(Roughness::All, [0.05, 1.2]);
        let [a, b, c] = std::array::from_fn(|i| lit.vertices[i]);
        let (centre, normal) = (a.midpoint(c), (b - a).cross(c - b).normalize());
        let moved = |t: f64| {
            let turn = DQuat::from_axis_angle(normal, 0.6 * t);
            let shift = centre + (b - a) * (t - 0.5);
            Lit { vertices: lit.vertices.iter().map(|v| shift + turn * (*v - centre)).collect(), ..lit.clone() }
        };
        (0..=STEPS).map(|i| moved(i as f64 / STEPS as f64)).collect()
    };
    let paths: Vec<Vec<Lit>> = (0..400).map(path).collect();
    let along = |light: &(dyn Fn(&Lit) -> ReflectedLight + Sync)| -> Vec<Vec<ReflectedLight>> {
        paths.par_iter().map(|path| path.iter().map(light).collect()).collect()
    };
    let wanted = along(&|lit| truth_within(1e-6, &lit.at, &lit.light(Sides::Two)).expect("a surface"));
    for (rule, limits) in [
        (NormalsRule::Balanced, [0.0025, 0.0015]),
        (NormalsRule::Fast, [0.004, 0.0027]),
        (NormalsRule::Fine, [0.0022, 0.001]),
    ] {
        let found = along(&|lit| by_normals(&lit.at, &lit.light(Sides::Two), rule).expect("a surface"));
        for (f0, limit) in [1.0, 0.04].into_iter().zip(limits) {
            let mut changes: Vec<f64> = Vec::new();
            for (found, wanted) in found.iter().zip(&wanted) {
                let errors =
                    found.iter().zip(wanted).map(|(found, wanted)| found.schlick(f0, 1.0) - wanted.schlick(f0, 1.0));
                let errors: Vec<f64> = errors.collect();
                changes.extend(errors.windows(2).map(|pair| (pair[1] - pair[0]).abs()));
            }
            changes.sort_by(f64::total_cmp);
            let p99 = changes[changes.len() * 99 / 100];
            println!("{rule}, F0 {f0}: the error changes by {p99:.5} (p99) per step");
            assert!(p99 < limit, "{rule}, F0 {f0}: {p99}");
        }
    }
}
