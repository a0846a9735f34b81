//! The variance of other ways to sample a light, and of the ratio estimator: the tables of docs/sampling.md.
//!
//! The variance of a density `p` is `E[f^2 / p] / I^2 - 1` for the light I, over draws of any sampler.

use super::*;
use crate::ltc::{CosineSpace, FormulaLobe};

/// The columns of the first table.
const WAYS: [&str; 8] = [
    "area",
    "solid angle",
    "visible normals",
    "both, half each",
    "isotropic LTC, projected",
    "our LTC, projected",
    "our LTC, this map",
    "normals",
];

/// The lobe of the formula for metal: its space, and its matrix.
fn formula(alpha: [f64; 2], wo: DVec3) -> (CosineSpace<f64>, DMat3) {
    let space = FormulaLobe::new(alpha, wo.to_array(), [1.0, 1.0]).space;
    let inverse = DMat3::from_cols_array_2d(&space.rows()).transpose();
    (space, inverse.inverse())
}

/// The density of an LTC, restricted to a light of which it covers the part `covered`.
fn projected((space, m): &(CosineSpace<f64>, DMat3), covered: f64, wi: DVec3) -> f64 {
    let y = DVec3::from(space.of(wi.to_array()));
    let length = y.length();
    FRAC_1_PI * y.z.max(0.0) / length.powi(4) / m.determinant().abs() / covered
}

/// The variance of each way. A way that misses a part of the light is biased, and has the variance of the rest.
fn variances(lit: &Lit, light: &PolygonLight, own: &LightSampler) -> [f64; WAYS.len()] {
    let wo = lit.wo();
    let alpha = lit.alpha();
    let ggx = Ggx { alpha_x: alpha[0], alpha_y: alpha[1] };
    let area_normal = (lit.vertices[1] - lit.vertices[0]).cross(lit.vertices[3] - lit.vertices[0]);
    let solid_angle = LightSampler::solid_angle(light).expect("a sampler");
    let mean = (alpha[0] * alpha[1]).sqrt();
    let lobes = [formula([mean, mean], wo), formula(alpha, wo)];
    let above = above_surface(light).expect("a plane");
    let covered = lobes.each_ref().map(|(space, _)| space.polygon(&above, Sides::Two).max(1e-12));
    let by_map = LightSampler::ltc(lobes[1].1, light).expect("a sampler");
    let densities = |wi: DVec3| {
        let corner = lit.vertices[0].dot(area_normal);
        let r = corner / wi.dot(area_normal);
        let cosine = (wi.dot(area_normal) / area_normal.length()).abs();
        let [uniform, normals] = [solid_angle.pdf(wi), ggx.pdf(wo, wi)];
        [
            r * r / (cosine * area_normal.length()),
            uniform,
            normals,
            0.5 * (uniform + normals),
            projected(&lobes[0], covered[0], wi),
            projected(&lobes[1], covered[1], wi),
            by_map.pdf(wi),
            own.pdf(wi),
        ]
    };
    let side = 64;
    let mut draw = Draw::new(60_700);
    let (mut first, mut second) = ([0.0; WAYS.len()], [0.0; WAYS.len()]);
    // Half of the draws come from the solid angle, so that no part of the light is rare.
    for (i, j) in (0..side).flat_map(|i| (0..side).map(move |j| (i, j))) {
        let u = [i, j].map(|k| (f64::from(k) + draw.within(0.0, 1.0)) / f64::from(side));
        let from = if (i + j) % 2 == 0 { own } else { &solid_angle };
        let Some(drawn) = from.sample(u) else { continue };
        let value = ggx.eval_cos(wo, drawn.wi);
        let weight = 1.0 / (0.5 * (own.pdf(drawn.wi) + solid_angle.pdf(drawn.wi)));
        for (way, density) in densities(drawn.wi).into_iter().enumerate() {
            if density > 0.0 {
                first[way] += value * weight;
                second[way] += value * value / density * weight;
            }
        }
    }
    std::array::from_fn(|way| second[way] * f64::from(side * side) / (first[way] * first[way]) - 1.0)
}

/// The ratio estimator behind a half-plane: the mean of `n MSE`, divided by the mean of `S (1 - S)` for the visible part
/// S, and the mean bias, for a sampler.
fn ratio(lit: &Lit, sampler: &LightSampler, draws: usize, seed: u64) -> [f64; 3] {
    let ggx = Ggx { alpha_x: lit.at.alpha_x, alpha_y: lit.at.alpha_y };
    let mut draw = Draw::new(seed);
    // An edge through the middle of the reflected light, in a random direction.
    let all: Vec<(DVec3, f64)> = (0..2048)
        .filter_map(|_| {
            let drawn = sampler.sample([draw.within(0.0, 1.0), draw.within(0.0, 1.0)])?;
            Some((drawn.wi, ggx.eval_cos(lit.wo(), drawn.wi) / drawn.pdf))
        })
        .collect();
    let total: f64 = all.iter().map(|(_, value)| value).sum();
    let middle = all.iter().map(|(wi, value)| *wi * *value).sum::<DVec3>() / total;
    let across = middle.cross(draw.vector());
    let seen = |wi: DVec3| wi.dot(across) > 0.0;
    let part = all.iter().filter(|(wi, _)| seen(*wi)).map(|(_, value)| value).sum::<f64>() / total;
    let (mut square, mut bias) = (0.0, 0.0);
    let trials = 2048;
    for _ in 0..trials {
        let mut sums = [0.0; 2];
        for _ in 0..draws {
            let (wi, value) = all[(draw.within(0.0, 1.0) * all.len() as f64) as usize];
            sums = [sums[0] + value, sums[1] + if seen(wi) { value } else { 0.0 }];
        }
        let error = if sums[0] > 0.0 { sums[1] / sums[0] - part } else { -part };
        square += error * error;
        bias += error;
    }
    [draws as f64 * square / f64::from(trials), part * (1.0 - part), (bias / f64::from(trials)).abs()]
}

fn row(variances: [f64; WAYS.len()]) -> String {
    WAYS.iter().zip(variances).map(|(way, x)| format!("{way} {x:.3}")).collect::<Vec<_>>().join("; ")
}

#[test]
fn the_tables_of_the_document() {
    let mut table = Vec::new();
    let mut ratios = [[0.0; 3]; 3];
    for (number, set) in LightSet::EIGHT.into_iter().chain([LightSet::Needle]).enumerate() {
        let mut draw = Draw::new(60_800 + number as u64);
        let mut sums = [0.0; WAYS.len()];
        let mut counted = 0;
        while counted < LIGHTS {
            let lit = set.draw(&mut draw);
            let light = lit.light(Sides::Two);
            if truth(&lit.at, &light).expect("a truth").energy < 1e-3 {
                continue;
            }
            let own = LightSampler::normals(&lit.at, &light).expect("a sampler");
            for (sum, variance) in sums.iter_mut().zip(variances(&lit, &light, &own)) {
                *sum += variance / LIGHTS as f64;
            }
            if set != LightSet::Needle && counted < 24 {
                for (sums, draws) in ratios.iter_mut().zip([1, 4, 16]) {
                    let found = ratio(&lit, &own, draws, 60_900 + counted as u64);
                    for (sum, value) in sums.iter_mut().zip(found) {
                        *sum += value / (24.0 * 8.0);
                    }
                }
            }
            counted += 1;
        }
        println!("{set:?}: {}", row(sums));
        table.push(sums);
    }
    let means: [f64; WAYS.len()] = std::array::from_fn(|way| table[..8].iter().map(|row| row[way]).sum::<f64>() / 8.0);
    println!("mean: {}", row(means));
    for ([square, ideal, bias], draws) in ratios.into_iter().zip([1, 4, 16]) {
        println!(
            "ratio, {draws} draws: n MSE {square:.3}, ideal {ideal:.3}, {:.3} of it; bias {bias:.3}",
            square / ideal
        );
    }
    assert!(ratios[1][0] < 1.10 * ratios[1][1], "{ratios:?}");
    assert!(means[7] < 0.09 && means[7] < 0.1 * means[0] && means[7] < 0.1 * means[3], "{means:?}");
}
