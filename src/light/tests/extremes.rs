//! Tests of the closed form where formulas can break: continuity, sides, lights below the surface, sums, degenerate
//! lights.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};
use proptest::prelude::*;
use rayon::prelude::*;

use crate::cases::{Draw, Lit, Roughness};
use crate::{
    NormalsRule, by_normals,
    normals::{reflected, region, visible},
    truth,
};
use ltcforge_fit::{Configuration, MAX_VERTICES, Sides};

fn energy(lit: &Lit, sides: Sides) -> f64 {
    energy_by(lit, sides, NormalsRule::Balanced)
}

fn energy_by(lit: &Lit, sides: Sides, rule: NormalsRule) -> f64 {
    by_normals(&lit.at, &lit.light(sides), rule).expect("a surface").energy
}

/// The energy in f32, as in shaders.
fn energy_in_f32(lit: &Lit, sides: Sides, rule: NormalsRule) -> f64 {
    let vertices: Vec<[f32; 3]> = lit.vertices.iter().map(|v| v.as_vec3().to_array()).collect();
    let [energy, _] = reflected(lit.alpha().map(|x| x as f32), lit.wo().as_vec3().to_array(), &vertices, sides, rule);
    f64::from(energy)
}

/// The visible part from the exact integral of each edge.
fn v(lit: &Lit) -> f64 {
    let vertices: Vec<[f64; 3]> = lit.vertices.iter().map(DVec3::to_array).collect();
    visible(lit.alpha(), lit.wo().to_array(), &vertices)
}

/// A mirror whose reflected ray hits a light reflects all of it, even if the image of the light is stretched very far.
/// A quadrature with a loose tolerance misses these lights.
#[test]
#[allow(clippy::unreadable_literal, reason = "as they were found")]
fn a_mirror_within_a_light_reflects_all_of_it() {
    let rectangle = |vertices: [[f64; 3]; 4]| vertices.map(DVec3::from_array).to_vec();
    let cases = [
        Lit {
            at: Configuration {
                alpha_x: 1.8344303130339686e-5,
                alpha_y: 0.00021652822631196037,
                theta: 1.5374295123413693,
                phi: 5.481055249781968,
            },
            vertices: rectangle([
                [-0.5998289517781443, -0.8532950505233575, -1.0412983132929428],
                [0.25688799288205805, 2.2724235411305154, 0.5937884045701955],
                [-0.7897500907570916, 2.2901611699489637, 1.108274722525275],
                [-1.646467035417294, -0.835557421704909, -0.5268119953378634],
            ]),
        },
        Lit {
            at: Configuration {
                alpha_x: 1e-5,
                alpha_y: 0.00012904707692538425,
                theta: 0.22698391350301145,
                phi: 0.726603960717274,
            },
            vertices: rectangle([
                [0.1177699893437802, 1.1140279350413234, 0.27188416445661834],
                [0.003516067756747343, 0.902427069134067, -0.04334913251997907],
                [-0.45414353368568766, -1.4130787704759655, 1.676813204683266],
                [-0.3398896120986548, -1.2014779045687092, 1.9920465016598634],
            ]),
        },
    ];
    for lit in cases {
        for rule in NormalsRule::ALL {
            let found = by_normals(&lit.at, &lit.light(Sides::Two), *rule).expect("a surface").energy;
            assert!(found > 0.9985, "{rule}: {found} of {:?}", lit.at);
        }
        let truth = truth(&lit.at, &lit.light(Sides::Two)).expect("a surface").energy;
        assert!(truth > 0.999, "{truth} of {:?}", lit.at);
    }
}

/// A light that moves by an angle d changes the reflection by at most the lobe's peak along its outline. In the space
/// of normals the image moves by at most d / alpha. The change is at most this shift times the length of a lobe's
/// outline, at most a turn, divided by pi. The weight changes as fast.
#[test]
fn small_steps_make_small_changes() {
    for rule in NormalsRule::ALL {
        let by_rule = |by: fn(&Lit, Sides, NormalsRule) -> f64| move |lit: &Lit| by(lit, Sides::Two, *rule);
        for roughness in [Roughness::All, Roughness::Anisotropic] {
            for (digits, energy) in [("f64", by_rule(energy_by)), ("f32", by_rule(energy_in_f32))] {
                let steepest = steepest_step(roughness, &energy);
                println!("{rule}, {roughness:?}, {digits}: changes by {steepest:.2} step / alpha at most");
                assert!(steepest < 2.0, "{rule}, {roughness:?}, {digits}: {steepest}");
            }
        }
    }
}

/// The largest change in steps of 1e-4, relative to the step and to 1 / alpha. Steps move the light, turn the surface
/// about its normal, or move the view.
fn steepest_step(roughness: Roughness, energy: &(dyn Fn(&Lit) -> f64 + Sync)) -> f64 {
    const STEP: f64 = 1e-4;
    let slope = |(i, lit): (usize, &Lit)| {
        let turn = DQuat::from_axis_angle(Draw::new(i as u64).vector().normalize(), STEP);
        let mut moved = lit.clone();
        moved.vertices.iter_mut().for_each(|v| *v = turn * *v);
        let mut turned = lit.clone();
        turned.at.phi += STEP;
        let mut raised = lit.clone();
        raised.at.theta = (raised.at.theta - STEP).max(0.0);
        let per_step = lit.at.alpha_x.min(lit.at.alpha_y) / STEP;
        let slopes = [moved, turned, raised].map(|other| (energy(&other) - energy(lit)).abs() * per_step);
        slopes.into_iter().fold(0.0, f64::max)
    };
    Draw::many(51 + roughness as u64, 4000, roughness).par_iter().enumerate().map(slope).reduce(|| 0.0, f64::max)
}

/// Steps through a light. Nothing jumps where numbers in f32 and f64 cross a condition.
#[test]
#[allow(clippy::type_complexity, reason = "a list of named paths")]
fn nothing_jumps_along_a_path() {
    const STEPS: u32 = 4000;
    let paths: [(&str, fn(f64) -> (Configuration, DVec3)); 4] = [
        ("an edge through the mirror direction", |t| (at(0.1, 0.02, 0.7), DVec3::new(-1.6 + 2.0 * t, 0.1, 1.0))),
        ("a light that sets", |t| (at(0.4, 0.1, 1.0), DVec3::new(-1.5, 0.2, 1.0 - 2.5 * t))),
        ("a view that sinks", |t| (at(0.3, 0.05, 0.2 + 1.36 * t), DVec3::new(-2.0, 0.0, 0.4))),
        ("a surface that turns", |t| {
            (Configuration { phi: TAU * t, ..at(0.5, 0.05, 1.2) }, DVec3::new(-1.5, 0.3, 0.6))
        }),
    ];
    for (name, path) in paths {
        let energies: Vec<f64> = (0..=STEPS)
            .map(|i| {
                let (at, centre) = path(f64::from(i) / f64::from(STEPS));
                let (x, y) = (DVec3::new(0.1, 0.5, 0.1), DVec3::new(0.0, 0.1, 0.5));
                energy(
                    &Lit { at, vertices: vec![centre - x - y, centre + x - y, centre + x + y, centre - x + y] },
                    Sides::Two,
                )
            })
            .collect();
        let most = energies.iter().copied().fold(0.0, f64::max);
        let jump = energies.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        // The second difference of a smooth path is far smaller than the first. A step that differs from its neighbours
        // is a jump.
        let kink = energies.windows(3).map(|s| (s[2] - 2.0 * s[1] + s[0]).abs()).fold(0.0, f64::max);
        println!("{name}: {most:.3} at most, steps {jump:.1e}, kinks {kink:.1e}");
        assert!(most > 0.1 && jump < 20.0 / f64::from(STEPS) && kink < 0.5 * jump, "{name}: {most} {jump} {kink}");
    }
}

fn at(alpha_x: f64, alpha_y: f64, theta: f64) -> Configuration {
    Configuration { alpha_x, alpha_y, theta, phi: 0.0 }
}

#[test]
fn below_the_surface_is_exactly_nothing() {
    let mut dark = 0;
    for mut lit in Draw::many(61, 500, Roughness::Extreme) {
        let top = lit.vertices.iter().map(|v| v.z).fold(f64::MIN, f64::max);
        lit.vertices.iter_mut().for_each(|v| v.z -= top);
        for rule in NormalsRule::ALL {
            let found = by_normals(&lit.at, &lit.light(Sides::Two), *rule).expect("a surface");
            assert_eq!([found.energy, found.fresnel], [0.0; 2], "{lit:?}");
        }
        dark += 1;
    }
    assert_eq!(dark, 500);
}

#[test]
fn two_sides_see_what_the_lit_one_sees() {
    for lit in Draw::many(62, 500, Roughness::All) {
        let mut turned = lit.clone();
        turned.vertices.reverse();
        let both = energy(&lit, Sides::Two);
        let sides = [energy(&lit, Sides::One), energy(&turned, Sides::One)];
        assert!((sides[0].max(sides[1]) - both).abs() < 1e-8 && sides[0].min(sides[1]) == 0.0, "{sides:?} {both}");
    }
    // Vertices run clockwise as seen from the lit side.
    let below = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let lamp = Lit { at: at(0.5, 0.5, 0.2), vertices: below.map(|(x, y)| DVec3::new(x, y, 1.0)).to_vec() };
    assert!(energy(&lamp, Sides::One) > 0.1);
}

/// The halves of a light add up to the light: exactly in the visible part, and up to the error of the weight in the
/// energy.
#[test]
fn parts_add_up() {
    let differences = |roughness: Roughness| {
        let halves = Draw::many(63 + roughness as u64, 2000, roughness);
        let of = |lit: &Lit| {
            let [a, b, c, d] = lit.vertices[..] else { panic!("four vertices") };
            let fans = [vec![a, b, c], vec![a, c, d]];
            let (ab, cd) = (a.lerp(b, 0.3), c.lerp(d, 0.6));
            let strips = [vec![a, ab, cd, d], vec![ab, b, c, cd]];
            let difference = |parts: [Vec<DVec3>; 2]| {
                let parts = parts.map(|vertices| Lit { at: lit.at, vertices });
                [
                    (v(&parts[0]) + v(&parts[1]) - v(lit)).abs(),
                    (energy(&parts[0], Sides::Two) + energy(&parts[1], Sides::Two) - energy(lit, Sides::Two)).abs(),
                ]
            };
            let [fan, strip] = [difference(fans), difference(strips)];
            [fan[0].max(strip[0]), fan[1].max(strip[1])]
        };
        let most = |a: [f64; 2], b: [f64; 2]| [a[0].max(b[0]), a[1].max(b[1])];
        halves.par_iter().map(of).reduce(|| [0.0; 2], most)
    };
    for roughness in [Roughness::All, Roughness::Anisotropic, Roughness::Extreme] {
        let [visible, energy] = differences(roughness);
        println!("{roughness:?}: parts add up to {visible:.1e} in V, {energy:.4} in energy");
        assert!(visible < 1e-9 && energy < 0.09, "{roughness:?}: {visible} {energy}");
    }
}

/// A normal number, zero, one, or a number close to zero.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        -3.0..3.0,
        Just(0.0),
        Just(1.0),
        (-3_i64..3).prop_map(|ulps| ulps as f64 * 1e-16),
        -1e-6..1e-6,
        Just(1e6)
    ]
}

fn hard_alpha() -> impl Strategy<Value = f64> {
    prop_oneof![1e-5..1.0, Just(1e-5), Just(1.0), 1e-5..1e-3]
}

fn hard_theta() -> impl Strategy<Value = f64> {
    prop_oneof![0.0..1.57, Just(0.0), Just(0.999_99 * std::f64::consts::FRAC_PI_2)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    /// Includes outlines that are not valid lights.
    #[test]
    fn never_negative_never_nan_never_above_one(
        vertices in prop::collection::vec((coordinate(), coordinate(), coordinate()), 3..=MAX_VERTICES),
        alpha_x in hard_alpha(), alpha_y in hard_alpha(), theta in hard_theta(), phi in prop_oneof![0.0..TAU, Just(0.0)],
    ) {
        let wo = ltcforge_fit::math::direction(theta, phi);
        let double: Vec<[f64; 3]> = vertices.iter().map(|(x, y, z)| [*x, *y, *z]).collect();
        let single: Vec<[f32; 3]> = double.iter().map(|v| v.map(|x| x as f32)).collect();
        for rule in NormalsRule::ALL {
            for sides in [Sides::One, Sides::Two] {
                let exact = reflected([alpha_x, alpha_y], wo.to_array(), &double, sides, *rule);
                prop_assert!(exact.iter().all(|part| (0.0..=1.0).contains(part)), "{:?}", exact);
                let alpha = [alpha_x as f32, alpha_y as f32];
                let shader = reflected(alpha, wo.as_vec3().to_array(), &single, sides, *rule);
                prop_assert!(shader.iter().all(|part| (0.0..=1.0).contains(part)), "{:?}", shader);
            }
        }
    }
}

/// The visible part of a light whose edge passes close to the shaded point. Distances are fractions of the edge's
/// length. The limits of the mean error, in f64 and f32, are about twice the measured errors.
#[test]
fn an_edge_may_be_close_to_the_shaded_point() {
    for (distance, limits) in [(1e-4, [6e-5, 2e-4]), (1e-5, [6e-5, 1e-3]), (1e-6, [3e-3, 1e-2])] {
        let mut errors = [Vec::new(), Vec::new()];
        for (i, Lit { at, .. }) in Draw::many(31, 300, Roughness::All).into_iter().enumerate() {
            let (along, [sine, cosine]) =
                (0.3 * (i as f64).sin(), <[f64; 2]>::from((0.2 + 0.009 * i as f64).sin_cos()));
            let corner = |y: f64, up: f64| {
                DQuat::from_rotation_z(i as f64) * DVec3::new(up * cosine, y + along, distance + up * sine)
            };
            let lit = Lit {
                at,
                vertices: [(-0.5, 0.0), (0.5, 0.0), (0.5, 1.0), (-0.5, 1.0)].map(|(y, up)| corner(y, up)).to_vec(),
            };
            let exact = v(&lit).abs();
            let corners: Vec<[f64; 3]> = lit.vertices.iter().map(DVec3::to_array).collect();
            let found = region(lit.alpha(), lit.wo().to_array(), &corners, Sides::Two, NormalsRule::Balanced);
            errors[0].push((found.map_or(0.0, |found| found.visible) - exact).abs());
            let corners: Vec<[f32; 3]> = lit.vertices.iter().map(|v| v.as_vec3().to_array()).collect();
            let (alpha, wo) = (lit.alpha().map(|x| x as f32), lit.wo().as_vec3().to_array());
            let found = region(alpha, wo, &corners, Sides::Two, NormalsRule::Balanced);
            errors[1].push((found.map_or(0.0, |found| f64::from(found.visible)) - exact).abs());
        }
        for (mut errors, limit) in errors.into_iter().zip(limits) {
            errors.sort_by(f64::total_cmp);
            let mean = errors.iter().sum::<f64>() / errors.len() as f64;
            println!("{distance}: mean {mean:.2e}, p95 {:.2e}, max {:.2e}", errors[285], errors[299]);
            assert!(mean < limit, "{distance}: {mean}");
        }
    }
}
