//! Tests the shader of model `ltc-formula` on the GPU.

use std::f64::consts::TAU;

use glam::DQuat;

use super::{
    ported::{ExampleLight, case_words, example_lights, lit_by, round_lights},
    report_skipped,
};
use crate::preview::gpu::{GpuFailure, tests::example};
use ltcforge_fit::{Sides, math::Triple};
use ltcforge_light::{
    LightModel,
    cases::{Draw, Lit, Roughness},
    ltc::FormulaLobe,
};
use ltcforge_shaders::{CASES, Case, Language, TOLERANCE};
use ltcforge_translate::port;

/// The results of the example for these cases. `None` if there is no GPU.
fn run(words: &[[f32; 40]]) -> Option<Vec<[f32; 4]>> {
    let wgsl = port(Language::Wgsl, lit_by(LightModel::LtcFormula, None)).expect("WGSL");
    let wgsl = String::from_utf8(wgsl).expect("UTF-8");
    match example::run(&wgsl, "ltc_formula_example", None, words) {
        Ok(found) => Some(found),
        Err(GpuFailure::Absent(reason)) => {
            report_skipped(&reason);
            None
        }
        Err(error) => panic!("{error}"),
    }
}

/// A rectangle, lit from both sides.
fn scene(alpha: [f64; 2], wo: Triple<f64>, lit: &Lit, f0: f32) -> [f32; 40] {
    let light = ExampleLight { count: 4, given: lit.vertices.clone(), outline: Vec::new(), size: 0.0 };
    let mut words = case_words(&Case { alpha_x: alpha[0], alpha_y: alpha[1], wo }, &light, true);
    words[11] = f0;
    words
}

/// Runs the files of an LTC without a table on the GPU, with every kind of light, lit from one side and from both sides.
#[test]
fn the_shader_of_a_formula_agrees_with_f64() {
    let mut lights = example_lights();
    lights.extend(round_lights());
    let mut tried = Vec::new();
    for (case, light) in CASES.iter().flat_map(|case| lights.iter().map(move |light| (case, light))) {
        for f0 in [1.0, 0.04] {
            tried.extend([false, true].map(|two_sided| (case, light, two_sided, f0)));
        }
    }
    let words: Vec<[f32; 40]> = tried
        .iter()
        .map(|(case, light, two_sided, f0)| {
            let mut words = case_words(case, light, *two_sided);
            words[11] = *f0 as f32;
            words
        })
        .collect();
    let Some(found) = run(&words) else { return };
    let mut lit = 0;
    for ((case, light, two_sided, f0), found) in tried.into_iter().zip(found) {
        let sides = if two_sided { Sides::Two } else { Sides::One };
        let lobe = FormulaLobe::new([case.alpha_x, case.alpha_y], case.wo, [f0, 1.0]);
        let covered = light.covered(&lobe.space, sides);
        for (found, part) in found.into_iter().zip(lobe.parts) {
            let (what, expected) = (format!("{case:?} {} vertices, {two_sided}, {f0}", light.count), part * covered);
            assert!((f64::from(found) - expected).abs() < TOLERANCE, "{what}: {found}, not {expected}");
        }
        lit += usize::from(covered > 0.05);
    }
    assert!(lit > 10, "{lit}");
}

/// Mirrored and swapped scenes, scenes with another order of the corners, and isotropic scenes that turn.
#[test]
fn the_shader_of_a_formula_lights_equivalent_scenes_equally() {
    let mut draw = Draw::new(8);
    let mut groups: Vec<(Lit, Vec<Lit>)> = Vec::new();
    for lit in Draw::many(9, 8, Roughness::All) {
        groups.push((lit.clone(), lit.variants().step_by(7).collect()));
        let mut round = lit;
        round.at.alpha_y = round.at.alpha_x;
        let turned = [0; 4].map(|_| {
            let (mut turned, angle) = (round.clone(), draw.within(0.0, TAU));
            turned.at.phi += angle;
            turned.vertices.iter_mut().for_each(|v| *v = DQuat::from_rotation_z(angle) * *v);
            turned
        });
        groups.push((round, turned.into()));
    }
    for f0 in [1.0, 0.04] {
        let all = groups.iter().flat_map(|(lit, others)| [lit].into_iter().chain(others));
        let words: Vec<[f32; 40]> = all.map(|lit| scene(lit.alpha(), lit.wo().to_array(), lit, f0)).collect();
        let Some(found) = run(&words) else { return };
        let (mut found, mut most) = (found.into_iter(), 0.0_f32);
        for (lit, others) in &groups {
            let wanted = found.next().expect("a result");
            for (other, [energy, fresnel, ..]) in others.iter().zip(found.by_ref()) {
                let off = (energy - wanted[0]).abs().max((fresnel - wanted[1]).abs());
                most = most.max(off);
                assert!(off < 5e-6, "{lit:?} {other:?} {f0}: {energy} {fresnel}, not {wanted:?}");
            }
        }
        println!("f0 {f0}: apart by {most:.1e} at most");
    }
}

/// Alpha from 1e-5 to 1, and views to 89.99 degrees.
#[test]
fn the_shader_of_a_formula_is_finite_at_the_extremes() {
    let lit = &Draw::many(10, 1, Roughness::All)[0];
    let alphas = [1e-5, 1e-3, 0.1, 1.0];
    let mut words = Vec::new();
    for alpha in alphas.into_iter().flat_map(|x| alphas.map(|y| [x, y])) {
        for theta in [0.0, 60.0, 89.0, 89.99_f64].map(f64::to_radians) {
            words.push(scene(alpha, [theta.sin() * 0.8, theta.sin() * 0.6, theta.cos()], lit, 0.04));
        }
    }
    let Some(found) = run(&words) else { return };
    for (words, [energy, fresnel, ..]) in words.iter().zip(found) {
        assert!((0.0..=1.0).contains(&energy) && (0.0..=energy).contains(&fresnel), "{words:?}: {energy} {fresnel}");
    }
}
