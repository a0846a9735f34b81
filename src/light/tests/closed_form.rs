//! Compares the closed form in the space of normals with the truth.

use glam::DVec3;
use rayon::prelude::*;

use crate::cases::{Draw, Lit, Roughness};
use crate::{
    NormalsRule, ReflectedLight, by_normals,
    normals::{reflected, visible},
    truth::integral,
    truth_within,
};
use ltcforge_fit::Sides;

/// The tolerance of the truth, for errors of a thousandth.
const TOLERANCE: f64 = 1e-5;

fn triples(vertices: &[DVec3]) -> Vec<[f64; 3]> {
    vertices.iter().map(DVec3::to_array).collect()
}

fn found(lit: &Lit, rule: NormalsRule) -> ReflectedLight {
    by_normals(&lit.at, &lit.light(Sides::Two), rule).expect("a surface")
}

fn in_f32(lit: &Lit, rule: NormalsRule) -> [f32; 2] {
    let vertices: Vec<[f32; 3]> = lit.vertices.iter().map(|v| v.as_vec3().to_array()).collect();
    reflected(lit.alpha().map(|x| x as f32), lit.wo().as_vec3().to_array(), &vertices, Sides::Two, rule)
}

/// Mean, 95th percentile and maximum.
fn spread(mut errors: Vec<f64>) -> [f64; 3] {
    errors.sort_by(f64::total_cmp);
    let count = errors.len();
    [errors.iter().sum::<f64>() / count as f64, errors[count * 95 / 100], errors[count - 1]]
}

/// The half widths of random lights. [`HUGE`] lights have half widths of 50.
const USUAL: [f64; 2] = [0.05, 1.2];
const HUGE: [f64; 2] = [50.0, 50.0];

/// Errors of energy and Fresnel part for each rule.
fn errors(seed: u64, count: usize, roughness: Roughness, sizes: [f64; 2]) -> Vec<(NormalsRule, [f64; 3], [f64; 3])> {
    let mut draw = Draw::new(seed);
    let cases: Vec<Lit> = (0..count).map(|_| draw.lit_by(roughness, sizes)).collect();
    let wanted: Vec<ReflectedLight> = cases
        .par_iter()
        .map(|lit| truth_within(TOLERANCE, &lit.at, &lit.light(Sides::Two)).expect("a surface"))
        .collect();
    let mean = wanted.iter().map(|wanted| wanted.energy).sum::<f64>() / count as f64;
    assert!(mean > 0.2, "lobes miss most lights: {mean}");
    let of = |rule: NormalsRule| {
        let found: Vec<ReflectedLight> = cases.par_iter().map(|lit| found(lit, rule)).collect();
        let pairs = || found.iter().zip(&wanted);
        let energy = spread(pairs().map(|(found, wanted)| (found.energy - wanted.energy).abs()).collect());
        let fresnel = spread(pairs().map(|(found, wanted)| (found.fresnel - wanted.fresnel).abs()).collect());
        println!("seed {seed} {roughness:?} {sizes:?} {rule}: energy {energy:.5?} fresnel {fresnel:.5?}");
        (rule, energy, fresnel)
    };
    NormalsRule::ALL.iter().map(|rule| of(*rule)).collect()
}

/// The errors of the weight, as in the documentation. The limits are a tenth to a half above the measured errors.
#[test]
fn errors_come_from_the_weight() {
    let limits = |roughness: Roughness, sizes: [f64; 2], rule: NormalsRule| match (roughness, rule) {
        (_, NormalsRule::Fast) if sizes == HUGE => [0.006, 0.026, 0.12],
        (_, NormalsRule::Balanced) if sizes == HUGE => [0.0034, 0.015, 0.1],
        (_, _) if sizes == HUGE => [0.0026, 0.01, 0.08],
        (Roughness::All, NormalsRule::Fast) => [0.0011, 0.0055, 0.1],
        (_, NormalsRule::Fast) => [0.0015, 0.0075, 0.1],
        (Roughness::All, NormalsRule::Balanced) => [0.0008, 0.0038, 0.1],
        (_, NormalsRule::Balanced) => [0.0009, 0.0048, 0.1],
        (Roughness::All, _) => [0.0005, 0.0025, 0.08],
        (_, _) => [0.0006, 0.0031, 0.06],
    };
    for (seed, count, roughness, sizes) in
        [(11, 2000, Roughness::All, USUAL), (14, 1500, Roughness::Anisotropic, USUAL), (16, 1500, Roughness::All, HUGE)]
    {
        for (rule, energy, fresnel) in errors(seed, count, roughness, sizes) {
            for (found, limit) in energy.into_iter().zip(limits(roughness, sizes, rule)) {
                assert!(found < limit, "{seed} {roughness:?} {sizes:?} {rule}: {energy:?}");
            }
            let most = (1.1 * energy[0]).max(0.0005);
            assert!(fresnel[0] < most && fresnel[2] < 0.2, "{seed} {roughness:?} {sizes:?} {rule}: {fresnel:?}");
        }
    }
}

/// The integral of `c x dc` along the image of an edge, which is halved until it is short.
fn along_image(stretch: DVec3, wo: DVec3, a: DVec3, b: DVec3, halvings: u32) -> DVec3 {
    let image = |w: DVec3| ((wo + w.normalize()) / stretch).normalize();
    let is_short = halvings > 2 && [a, b].iter().all(|end| image(*end).dot(image(a + b)) > 0.95);
    if !is_short && halvings < 50 {
        let middle = (a + b).normalize();
        let half = |a: DVec3, b: DVec3| along_image(stretch, wo, a, b, halvings + 1);
        return half(a, middle) + half(middle, b);
    }
    let slice = |t: f64| {
        let (w, along) = (a + (b - a) * t, b - a);
        let length = w.length();
        let w = w / length;
        let (h, turning) = ((wo + w) / stretch, (along - w * w.dot(along)) / length / stretch);
        (h.cross(turning) / h.length_squared()).to_array()
    };
    DVec3::from_array(integral(&slice, [0.0, 1.0], 1e-12, 4))
}

/// V from a quadrature of `c x dc` along the image of the outline.
fn visible_by_quadrature(lit: &Lit) -> f64 {
    let [alpha_x, alpha_y] = lit.alpha();
    let (wo, stretch) = (lit.wo(), DVec3::new(alpha_x, alpha_y, 1.0));
    let mut outline: Vec<DVec3> = Vec::new();
    for (a, b) in lit.vertices.iter().zip(lit.vertices.iter().cycle().skip(1)) {
        outline.extend((a.z > 0.0).then(|| a.normalize()));
        if (a.z > 0.0) != (b.z > 0.0) {
            outline.push((*a - (*b - *a) * (a.z / (b.z - a.z))).with_z(0.0).normalize());
        }
    }
    let ends = outline.iter().zip(outline.iter().cycle().skip(1));
    let sum: DVec3 = ends.map(|(a, b)| along_image(stretch, wo, *a, *b, 0)).sum();
    sum.dot(stretch * wo) / (std::f64::consts::PI * (wo.z + (stretch * wo).length()))
}

/// The sum over the edges is as accurate as the quadrature. In f32 it loses the digits that rounded directions lose.
#[test]
fn the_visible_part_is_exact() {
    let cases = [
        (Roughness::All, 21, [1e-12, 2e-7, 1e-5]),
        (Roughness::Anisotropic, 22, [1e-12, 2e-7, 1e-5]),
        (Roughness::Extreme, 23, [2e-7, 1e-6, 1e-4]),
    ];
    for (roughness, seed, limits) in cases {
        let errors = |lit: &Lit| {
            let wanted = visible_by_quadrature(lit);
            let found = visible(lit.alpha(), lit.wo().to_array(), &triples(&lit.vertices));
            let vertices: Vec<[f32; 3]> = lit.vertices.iter().map(|v| v.as_vec3().to_array()).collect();
            let single = visible(lit.alpha().map(|x| x as f32), lit.wo().as_vec3().to_array(), &vertices);
            [found, f64::from(single)].map(|found| (found - wanted).abs())
        };
        let errors: Vec<[f64; 2]> = Draw::many(seed, 4000, roughness).par_iter().map(errors).collect();
        let [double, single] = [0, 1].map(|i| spread(errors.iter().map(|errors| errors[i]).collect()));
        println!(
            "{roughness:?}: V is off by {:.1e} at most, in f32 by {:.1e}, {:.1e}",
            double[2], single[0], single[2]
        );
        let found = [double[2], single[0], single[2]];
        assert!(found.iter().zip(limits).all(|(found, limit)| *found < limit), "{roughness:?}: {found:?}");
    }
}

/// Compares with the f32 numbers of the shaders.
#[test]
fn f32_gives_the_same_light_as_f64() {
    let limits = [
        (Roughness::All, 31, [1e-4, 5e-4]),
        (Roughness::Anisotropic, 32, [1e-4, 5e-4]),
        (Roughness::Extreme, 33, [2e-3, 0.15]),
    ];
    for (roughness, seed, [most, all]) in limits {
        let mut draw = Draw::new(seed);
        let sizes = |i: u32| if i.is_multiple_of(4) { HUGE } else { USUAL };
        let cases: Vec<Lit> = (0..20_000).map(|i| draw.lit_by(roughness, sizes(i))).collect();
        let difference = |lit: &Lit| {
            let single = in_f32(lit, NormalsRule::Balanced).map(f64::from);
            let double = found(lit, NormalsRule::Balanced);
            (single[0] - double.energy).abs().max((single[1] - double.fresnel).abs())
        };
        let mut differences: Vec<f64> = cases.par_iter().map(difference).collect();
        differences.sort_by(f64::total_cmp);
        let [typical, rare, worst] = [0.99, 0.999, 1.0].map(|part| differences[(part * 19_999.0) as usize]);
        println!("{roughness:?}: f32 off by {typical:.1e} (p99), {rare:.1e} (p99.9), {worst:.1e}");
        assert!(typical <= rare && rare < most && worst < all, "{roughness:?}: {typical} {rare} {worst}");
    }
}

/// Tests lights from points to half of all directions, with surfaces down to needles and mirrors.
#[test]
fn lights_of_any_size_are_right() {
    let mut draw = Draw::new(61);
    let cases: Vec<Lit> = (0..600).map(|_| draw.lit_by(Roughness::Extreme, [0.0005, 50.0])).collect();
    let error = |lit: &Lit| {
        let wanted = truth_within(1e-6, &lit.at, &lit.light(Sides::Two)).expect("a surface");
        [NormalsRule::Balanced, NormalsRule::Fine].map(|rule| (found(lit, rule).energy - wanted.energy).abs())
    };
    let errors: Vec<[f64; 2]> = cases.par_iter().map(error).collect();
    for (i, limits) in [[0.0007, 0.0035, 0.06], [0.0004, 0.002, 0.05]].into_iter().enumerate() {
        let found = spread(errors.iter().map(|errors| errors[i]).collect());
        println!("any size, {}: {found:.5?}", [NormalsRule::Balanced, NormalsRule::Fine][i]);
        assert!(found.iter().zip(limits).all(|(found, limit)| *found < limit), "{i}: {found:?}");
    }
}

/// Checks that no surface, view or light has a large error in f32. The truth takes a millisecond, so it is computed for
/// every twentieth case, and for cases where two other rules differ.
#[test]
fn random_configurations_are_right() {
    const COUNT: usize = 30_000;
    let worst_errors = [Roughness::All, Roughness::Anisotropic, Roughness::Extreme].map(|roughness| {
        let cases = Draw::many(41 + roughness as u64, COUNT / 3 + 1, roughness);
        let error = |(i, lit): (usize, &Lit)| {
            let double = found(lit, NormalsRule::Balanced);
            let [energy, fresnel] = in_f32(lit, NormalsRule::Balanced).map(f64::from);
            let single = ReflectedLight { energy, fresnel };
            for part in [double.energy, double.fresnel, energy, fresnel] {
                assert!((0.0..=1.0).contains(&part), "{single:?} {double:?} {lit:?}");
            }
            let [fine, fast] = [NormalsRule::Fine, NormalsRule::Fast].map(|rule| found(lit, rule).energy);
            let (to_fine, to_fast) = ((energy - fine).abs(), (energy - fast).abs());
            if i % 20 > 0 && to_fine < 0.01 && to_fast < 0.05 {
                return to_fine;
            }
            let wanted = truth_within(1e-4, &lit.at, &lit.light(Sides::Two)).expect("a surface");
            (single.energy - wanted.energy).abs()
        };
        let mut errors: Vec<f64> = cases.par_iter().enumerate().map(error).collect();
        errors.sort_by(f64::total_cmp);
        let [rare, worst] = [errors[errors.len() * 999 / 1000], errors[errors.len() - 1]];
        println!("{roughness:?}: p99.9 {rare:.4}, max {worst:.4}");
        [rare, worst]
    });
    assert!(worst_errors.iter().all(|[rare, worst]| *rare < 0.03 && *worst < 0.1), "{worst_errors:?}");
}
