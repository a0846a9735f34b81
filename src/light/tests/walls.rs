//! Lights that stand on the surface or near it, where the weight of the closed form falls to zero.

use rayon::prelude::*;

use crate::cases::{Draw, Lit, Roughness, jump};
use crate::{NormalsRule, by_normals, truth_within};
use ltcforge_fit::Sides;

fn energy(lit: &Lit, rule: NormalsRule) -> f64 {
    by_normals(&lit.at, &lit.light(Sides::Two), rule).expect("a surface").energy
}

/// The height of the lower edge above the surface, and the height of one end above the other, in units of the wall's
/// height.
const FEET: [(f64, f64); 10] = [
    (0.0, 0.0),
    (0.01, 0.0),
    (0.06, 0.0),
    (0.12, 0.0),
    (0.2, 0.0),
    (-0.01, 0.0),
    (-0.06, 0.0),
    (0.0, 0.03),
    (0.02, 0.03),
    (-0.02, 0.03),
];

/// The limits are a tenth to a half above the measured errors.
#[test]
fn walls_on_the_surface_are_right() {
    for (i, (foot, tilt)) in FEET.into_iter().enumerate() {
        let mut draw = Draw::new(81 + i as u64);
        let walls: Vec<Lit> = (0..600).map(|_| draw.wall(Roughness::All, foot, tilt)).collect();
        let wanted: Vec<f64> = walls
            .par_iter()
            .map(|lit| truth_within(1e-5, &lit.at, &lit.light(Sides::Two)).expect("a surface").energy)
            .collect();
        let mean = wanted.iter().sum::<f64>() / wanted.len() as f64;
        assert!(mean > 0.1, "lobes miss most lights: {mean}");
        for (rule, limits) in
            [(NormalsRule::Balanced, [0.0015, 0.007, 0.08]), (NormalsRule::Fine, [0.0012, 0.006, 0.05])]
        {
            let mut errors: Vec<f64> =
                walls.iter().zip(&wanted).map(|(lit, wanted)| (energy(lit, rule) - wanted).abs()).collect();
            errors.sort_by(f64::total_cmp);
            let found = [
                errors.iter().sum::<f64>() / errors.len() as f64,
                errors[errors.len() * 95 / 100],
                errors[errors.len() - 1],
            ];
            println!("foot {foot}, tilt {tilt}, {rule}: {found:.5?}");
            assert!(found.iter().zip(limits).all(|(found, limit)| *found < limit), "{foot} {tilt} {rule}: {found:?}");
        }
    }
}

/// A level edge on the surface is an edge of the light. Just below the surface it becomes a part of the horizon.
#[test]
fn a_level_edge_sets_without_a_jump() {
    const HEIGHT: f64 = 1e-9;
    let mut sums = [0.0; NormalsRule::ALL.len()];
    let mut draw = Draw::new(71);
    for _ in 0..2000 {
        let on_surface = draw.wall(Roughness::All, 0.0, 0.0);
        let at_height = |z: f64| {
            let mut lit = on_surface.clone();
            lit.vertices.iter_mut().for_each(|v| v.z += z);
            lit
        };
        for (rule, sum) in NormalsRule::ALL.iter().zip(&mut sums) {
            let [above, below] = [HEIGHT, -HEIGHT].map(|z| energy(&at_height(z), *rule));
            assert!((above - below).abs() < 1e-6, "{rule:?}, {on_surface:?}: {above} and {below}");
            *sum += above;
        }
    }
    assert!(sums.iter().all(|sum| *sum > 100.0), "{sums:?}");
}

/// Walls sink and tilt. One corner sets after the other, and the horizon replaces the edge near it.
#[test]
fn nothing_jumps_while_walls_sink_and_tilt() {
    for roughness in [Roughness::All, Roughness::Extreme] {
        for rule in NormalsRule::ALL {
            let most = |seed: u64| {
                let mut draw = Draw::new(1000 + seed);
                let (feet, tilts) =
                    ([draw.within(0.0, 0.3), draw.within(-0.3, 0.0)], [0, 1].map(|_| draw.within(-0.1, 0.1)));
                jump(|t| {
                    let at = |ends: [f64; 2]| ends[0] + (ends[1] - ends[0]) * t;
                    energy(&Draw::new(seed).wall(roughness, at(feet), at(tilts)), *rule)
                })
            };
            let most = (0..1000).into_par_iter().map(most).reduce(|| 0.0, f64::max);
            println!("{roughness:?}, {rule}: jumps by {most:.1e} at most");
            assert!(most < 1e-6, "{roughness:?}, {rule}: {most}");
        }
    }
}
