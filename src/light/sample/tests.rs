//! Tests of drawn directions and their density.

mod compared;

use super::{
    sets::{LightSet, cornered, over_triangle, triangles},
    *,
};
use crate::{
    NormalsRule,
    cases::{Draw, Lit, Roughness},
    normals::region,
    truth,
};
use ltcforge_fit::brdf::{Brdf, Ggx};
use std::f64::consts::FRAC_1_PI;

/// A matrix with all kinds of distortion.
fn matrix() -> DMat3 {
    DMat3::from_cols(DVec3::new(0.4, 0.0, -0.3), DVec3::new(0.1, 0.6, 0.0), DVec3::new(0.5, 0.1, 1.0))
}

#[test]
fn the_density_integrates_to_one() {
    let mut worst = 0.0_f64;
    let mut tested = 0;
    for (index, set) in LightSet::EIGHT.into_iter().cycle().take(64).enumerate() {
        let lit = cornered(&set.draw(&mut Draw::new(60_100 + index as u64)), 3 + index / 8 % 6);
        let light = lit.light(Sides::Two);
        for sampler in [LightSampler::normals(&lit.at, &light), LightSampler::ltc(matrix(), &light)] {
            let sampler = sampler.expect("a sampler");
            let parts = triangles(&lit.vertices).into_iter().map(|part| over_triangle(&|wi| sampler.pdf(wi), part, 22));
            let sum: f64 = parts.sum();
            worst = worst.max((sum - 1.0).abs());
            assert!((sum - 1.0).abs() < 1e-4, "{set:?} {lit:?}: {sum}");
            tested += 1;
        }
    }
    println!("{tested} integrals, off by {worst:.1e}");
}

/// The mean of `of` over the density, its relative variance, and the largest error of a drawn density.
fn estimate(of: impl Fn(DVec3) -> f64, draws: impl Fn([f64; 2]) -> Option<SampledDirection>, seed: u64) -> [f64; 2] {
    let side = 64;
    let mut draw = Draw::new(seed);
    let mut sums = [0.0; 2];
    for (i, j) in (0..side).flat_map(|i| (0..side).map(move |j| (i, j))) {
        let u = [i, j].map(|k| (f64::from(k) + draw.within(0.0, 1.0)) / f64::from(side));
        let Some(drawn) = draws(u) else { continue };
        assert!((drawn.wi.length() - 1.0).abs() < 1e-12);
        let value = of(drawn.wi) / drawn.pdf;
        sums = [sums[0] + value, sums[1] + value * value];
    }
    let [mean, square] = sums.map(|sum| sum / f64::from(side * side));
    [mean, square / (mean * mean) - 1.0]
}

/// Lights of each set that reflect at least a thousandth of the lobe.
const LIGHTS: usize = 100;

/// The variance without shadows. docs/sampling.md has the same table for other samplers.
#[test]
fn the_variance_of_eight_sets_is_small() {
    let mut means = Vec::new();
    for (number, set) in LightSet::EIGHT.into_iter().enumerate() {
        let mut draw = Draw::new(60_200 + number as u64);
        let mut sums = [0.0; 4];
        let mut counted = 0;
        while counted < LIGHTS {
            let lit = cornered(&set.draw(&mut draw), [4, 4, 3, 5, 8][counted % 5]);
            let light = lit.light(Sides::Two);
            let lobe = truth(&lit.at, &light).expect("a truth");
            let energy = lobe.energy;
            if energy < 1e-3 {
                continue;
            }
            let ggx = Ggx { alpha_x: lit.at.alpha_x, alpha_y: lit.at.alpha_y };
            let specular = |wi: DVec3| ggx.eval_cos(lit.wo(), wi);
            let own = LightSampler::normals(&lit.at, &light).expect("a sampler");
            let [mean, variance] = estimate(specular, |u| own.sample(u), 60_300);
            let tolerance = 2e-3 + 5.0 * (variance / 4096.0).sqrt();
            assert!((mean / energy - 1.0).abs() < tolerance, "{set:?} {lit:?}: {mean} {energy}");
            let region = region(
                lit.alpha(),
                lit.wo().to_array(),
                &lit.vertices.iter().map(glam::DVec3::to_array).collect::<Vec<_>>(),
                Sides::Two,
                NormalsRule::Balanced,
            );
            let flux = region.map_or(DVec3::ZERO, |region| DVec3::from(region.flux));
            let about = LightSampler::normals_about(&lit.at, &light, flux).expect("a sampler");
            let [mean, of_about] = estimate(specular, |u| about.sample(u), 60_304);
            assert!((mean / energy - 1.0).abs() < tolerance, "{set:?} {lit:?}: {mean} {energy}");
            let uniform = LightSampler::solid_angle(&light).expect("a sampler");
            let of_uniform = estimate(specular, |u| uniform.sample(u), 60_301)[1];
            // Diffuse and specular together, chosen by their energies: a plastic of albedo a half.
            let diffuse = LightSampler::ltc(DMat3::IDENTITY, &light).expect("a sampler");
            let lambert = |wi: DVec3| 0.5 * FRAC_1_PI * wi.z.max(0.0);
            let schlick = |wi: DVec3| 0.04 + 0.96 * (1.0 - lit.wo().dot((lit.wo() + wi).normalize())).max(0.0).powi(5);
            let shiny = 0.04 * energy + 0.96 * lobe.fresnel;
            let [below, _] = estimate(lambert, |u| diffuse.sample(u), 60_302);
            let both = Mixture { samplers: [own, diffuse], share: shiny / (shiny + below) };
            let of_both = estimate(|wi| specular(wi) * schlick(wi) + lambert(wi), |u| both.sample(u), 60_303)[1];
            sums = [sums[0] + variance, sums[1] + of_uniform, sums[2] + of_both, sums[3] + of_about];
            counted += 1;
        }
        let mean = sums.map(|sum| sum / LIGHTS as f64);
        println!("{set:?}: normals, solid angle, both, about the mean normal: {mean:.3?}");
        assert!(set == LightSet::Rough || mean[0] < 0.12 * mean[1], "{set:?} {mean:?}");
        means.push(mean);
    }
    let [own, both, about] = [0, 2, 3].map(|k| means.iter().map(|mean| mean[k]).sum::<f64>() / 8.0);
    println!("mean: normals {own:.3}, both {both:.3}, about the mean normal {about:.3}");
    assert!(own < 0.09 && both < 0.05 && about < 0.09, "{own} {both} {about}");
}

/// Cells along each side of a rectangle.
const CELLS: usize = 8;
const DRAWS: u32 = 40_000;
/// For 63 degrees of freedom, chance exceeds this value in one of 100,000 tests.
const MOST_CHI_SQUARE: f64 = 124.0;

/// The cell of the rectangle that a direction hits.
fn cell(lit: &Lit, wi: DVec3) -> usize {
    let (corner, x, y) = (lit.vertices[0], lit.vertices[1] - lit.vertices[0], lit.vertices[3] - lit.vertices[0]);
    let normal = x.cross(y);
    let p = wi * (corner.dot(normal) / wi.dot(normal)) - corner;
    let [s, t] = [x, y].map(|side| p.dot(side) / side.length_squared());
    assert!([s, t].iter().all(|k| (-1e-6..1.0 + 1e-6).contains(k)), "outside the light: {s} {t}");
    let [i, j] = [s, t].map(|k| ((k * CELLS as f64) as usize).min(CELLS - 1));
    i * CELLS + j
}

#[test]
fn draws_follow_their_density() {
    for (index, set) in LightSet::EIGHT.into_iter().filter(|set| *set != LightSet::Cut).enumerate() {
        let lit = set.draw(&mut Draw::new(60_400 + index as u64));
        let light = lit.light(Sides::Two);
        let [corner, x, y] = [lit.vertices[0], lit.vertices[1] - lit.vertices[0], lit.vertices[3] - lit.vertices[0]];
        for sampler in [LightSampler::normals(&lit.at, &light), LightSampler::ltc(matrix(), &light)] {
            let sampler = sampler.expect("a sampler");
            let density = |wi: DVec3| if wi.z > 0.0 { sampler.pdf(wi) } else { 0.0 };
            let expected = |index: usize| {
                let at = |i: usize, j: usize| corner + x * (i as f64 / 8.0) + y * (j as f64 / 8.0);
                let (i, j) = (index / CELLS, index % CELLS);
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                f64::from(DRAWS) * (over_triangle(&density, [a, b, c], 12) + over_triangle(&density, [a, c, d], 12))
            };
            let mut draw = Draw::new(60_500);
            let mut found = vec![0.0; CELLS * CELLS];
            for _ in 0..DRAWS {
                let drawn = sampler.sample([draw.within(0.0, 1.0), draw.within(0.0, 1.0)]).expect("visible");
                assert!((sampler.pdf(drawn.wi) / drawn.pdf - 1.0).abs() < 1e-9);
                found[cell(&lit, drawn.wi)] += 1.0;
            }
            let cells = (0..CELLS * CELLS).map(|index| (expected(index), found[index]));
            let rare = cells.clone().filter(|(wanted, _)| *wanted <= 5.0);
            let rare = rare.fold((0.0, 0.0), |sum, cell| (sum.0 + cell.0, sum.1 + cell.1));
            let cells = cells.filter(|(wanted, _)| *wanted > 5.0).chain([rare]).filter(|(wanted, _)| *wanted > 1.0);
            let chi_square: f64 = cells.map(|(wanted, got)| (got - wanted) * (got - wanted) / wanted).sum();
            assert!(chi_square < MOST_CHI_SQUARE, "{set:?} {lit:?}: {chi_square}");
        }
    }
}

#[test]
fn extremes_have_no_nan_and_no_density_of_zero() {
    let mut draw = Draw::new(60_006);
    for index in 0..20_000 {
        let sizes = [[1e-4, 1e-2], [1e-2, 10.0], [10.0, 1e4]][index % 3];
        let mut lit = draw.lit_by(Roughness::Extreme, sizes);
        if index % 2 == 0 {
            lit.at.theta = draw.within(89.0, 89.99).to_radians();
            lit.at.alpha_x = 10_f64.powf(draw.within(-5.0, 0.0));
        }
        let Ok(light) = PolygonLight::new(lit.vertices.clone(), Sides::Two) else { continue };
        let sampler = LightSampler::normals(&lit.at, &light).expect("a sampler");
        for _ in 0..8 {
            let Some(drawn) = sampler.sample([draw.within(0.0, 1.0), draw.within(0.0, 1.0)]) else { continue };
            assert!(drawn.wi.is_finite() && drawn.pdf > 0.0 && drawn.pdf.is_finite(), "{lit:?} {drawn:?}");
        }
    }
}

#[test]
fn a_light_below_the_surface_or_turned_away_is_empty() {
    let at = Configuration { alpha_x: 0.3, alpha_y: 0.1, theta: 0.5, phi: 0.2 };
    let at_height = |z: f64| {
        let corners = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)];
        corners.map(|(x, y)| DVec3::new(x, y, z)).to_vec()
    };
    let is_empty = |vertices: Vec<DVec3>, sides| {
        let light = PolygonLight::new(vertices, sides).expect("convex");
        let empty = LightSampler::normals(&at, &light).expect("a sampler");
        assert_eq!(empty.is_empty(), empty.sample([0.5, 0.5]).is_none());
        // The closed form reflects light exactly where the sampler draws.
        assert_eq!(empty.is_empty(), truth(&at, &light).expect("a truth").energy == 0.0);
        empty.is_empty()
    };
    let reversed: Vec<DVec3> = at_height(1.0).into_iter().rev().collect();
    assert!(is_empty(at_height(-1.0), Sides::Two));
    assert!(!is_empty(at_height(1.0), Sides::Two) && !is_empty(reversed.clone(), Sides::Two));
    assert_ne!(is_empty(at_height(1.0), Sides::One), is_empty(reversed, Sides::One));
    let light = PolygonLight::new(at_height(1.0), Sides::Two).expect("convex");
    assert_eq!(LightSampler::ltc(DMat3::ZERO, &light).expect_err("no inverse"), LightError::Singular);
    let mut bent = at_height(1.0);
    bent[1].z = 1.1;
    let light = PolygonLight::new(bent, Sides::Two).expect("convex as seen from the point");
    let error = LightSampler::normals(&at, &light).expect_err("a bent polygon");
    assert!(error.to_string().contains("not planar: vertex"), "{error}");
}
