//! Finds the numbers of `LOSS` in `src/light/albedo.rs`: a cubic for the part of uniform light that GGX loses.

use std::{f64::consts::FRAC_PI_2, fmt::Write as _};

use ltcforge::{
    BrdfKind, Configuration,
    fit::{
        brdf::{Brdf, Ggx},
        math::{Lattice, direction, recurrence4},
    },
    light::albedo::{LOSS, albedo, compensation, factors, inputs, sampled},
};
use rayon::prelude::*;

use crate::linear::solve;

/// Surfaces in the search. Half as many surfaces are held out.
pub const PLACES: usize = 12_000;
/// Samples of a lobe. With more samples, the albedo changes by less than 2e-4.
const SAMPLES: usize = 4096;
/// The most grazing view in the search, in quarter turns: 89.9 degrees.
const LOWEST: f64 = 89.9 / 90.0;
/// The starts of the two sequences of surfaces: for the search, and for the held-out surfaces.
const STARTS: [[f64; 4]; 2] = [[0.5; 4], [0.137, 0.593, 0.871, 0.219]];
/// Rounds of the search. Each round raises the weights of large errors.
const ROUNDS: usize = 8;
/// An error of at least this size triples the weight in the next round.
const LARGE: f64 = 0.01;
/// A constant on the diagonal of the mean normal equations. It keeps the numbers small.
const RIDGE: f64 = 1e-8;

/// A surface, a view, and the directional albedo of the surface for this view.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    alpha: [f64; 2],
    wo: [f64; 3],
    albedo: f64,
}

impl Place {
    /// The angle between the view and the normal.
    fn theta(&self) -> f64 {
        self.wo[2].acos()
    }
}

/// Surfaces, evenly spaced in the square root of the larger alpha and in the ratio. A third of them are isotropic.
/// Views are evenly spaced in their angles. `held_out` selects the other sequence.
#[must_use]
pub fn places(count: usize, held_out: bool) -> Vec<Place> {
    let start = STARTS[usize::from(held_out)];
    let place = |i: usize| {
        let [root, ratio, theta, phi] = recurrence4(i, start);
        let larger = (root * root).max(1e-4);
        let alpha = if i.is_multiple_of(3) { [larger; 2] } else { [larger, (larger * ratio).max(1e-4)] };
        let wo = direction(FRAC_PI_2 * LOWEST * theta, FRAC_PI_2 * phi);
        let surface = Ggx { alpha_x: alpha[0], alpha_y: alpha[1] };
        let drawn = Lattice::new(SAMPLES, [0.0; 2]);
        let sum: f64 = drawn.points().map(|u| surface.sample(wo, u).weight).sum();
        Place { alpha, wo: wo.to_array(), albedo: sum / SAMPLES as f64 }
    };
    (0..count).into_par_iter().map(place).collect()
}

/// Errors of albedos: mean, 95th percentile, and largest.
#[must_use]
pub fn errors(places: &[Place], of: impl Fn(&Place) -> f64) -> [f64; 3] {
    let mut errors: Vec<f64> = places.iter().map(|place| (of(place) - place.albedo).abs()).collect();
    errors.sort_by(f64::total_cmp);
    let count = errors.len();
    [errors.iter().sum::<f64>() / count as f64, errors[count * 95 / 100], errors[count - 1]]
}

/// The numbers with the least weighted sum of squared errors, rounded to four decimals.
///
/// # Panics
/// Never: the ridge makes the equations positive definite.
#[must_use]
pub fn find(places: &[Place]) -> [f64; 31] {
    let rows: Vec<[f64; 31]> = places.iter().map(|place| factors(inputs(place.alpha, place.wo))).collect();
    let mut weights = vec![1.0; places.len()];
    let mut numbers = [0.0; 31];
    for _ in 0..ROUNDS {
        let total: f64 = weights.iter().sum();
        let mut matrix = vec![0.0; 31 * 31];
        let mut right = vec![0.0; 31];
        for ((row, place), weight) in rows.iter().zip(places).zip(&weights) {
            for i in 0..31 {
                right[i] += weight / total * row[i] * (1.0 - place.albedo);
                for j in 0..31 {
                    matrix[31 * i + j] += weight / total * row[i] * row[j];
                }
            }
        }
        (0..31).for_each(|i| matrix[32 * i] += RIDGE);
        let found = solve(matrix, right).expect("the ridge makes the matrix positive definite");
        numbers.iter_mut().zip(found).for_each(|(number, found)| *number = (found * 1e4).round() / 1e4);
        for ((row, place), weight) in rows.iter().zip(places).zip(&mut weights) {
            let error = (loss(row, &numbers) - (1.0 - place.albedo)).abs();
            *weight *= (1.0 + 2.0 * error / LARGE).min(3.0);
        }
    }
    numbers
}

/// The errors of the cubic with these numbers.
#[must_use]
pub fn errors_of(places: &[Place], numbers: &[f64; 31]) -> [f64; 3] {
    errors(places, |place| (1.0 - loss(&factors(inputs(place.alpha, place.wo)), numbers)).clamp(0.2, 1.0))
}

fn loss(factors: &[f64; 31], numbers: &[f64; 31]) -> f64 {
    factors.iter().zip(numbers).map(|(factor, number)| factor * number).sum()
}

/// The numbers, as written in `src/light/albedo.rs`.
#[must_use]
pub fn as_rust(numbers: &[f64; 31]) -> String {
    let rows = numbers
        .chunks(8)
        .map(|row| format!("    {},\n", row.iter().map(f64::to_string).collect::<Vec<_>>().join(", ")));
    format!("pub const LOSS: [f64; 31] = [\n{}];", rows.collect::<String>())
}

/// The numbers, as written in `shaders/ltc_albedo.wgsl`: the quadratics for s, a and b.
#[must_use]
pub fn as_wgsl(n: &[f64; 31]) -> String {
    let dot = |range: std::ops::Range<usize>, with: &str| {
        let numbers = n[range].iter().map(|x| format!("{x:?}")).collect::<Vec<_>>();
        format!("dot(vec{}({}), {with})", numbers.len(), numbers.join(", "))
    };
    [
        format!("    let of_s = {:?} + {}\n", n[0], dot(1..5, "v")),
        format!("        + v.x * {}\n        + v.y * {}\n", dot(5..9, "v"), dot(9..12, "v.yzw")),
        format!("        + v.z * {} + {:?} * v.w * v.w;\n", dot(12..14, "v.zw"), n[14]),
        format!("    let of_a = {:?} + {}\n        + v.x * {}\n", n[15], dot(16..19, "v.xzw"), dot(19..22, "v.xzw")),
        format!("        + v.z * {} + {:?} * v.w * v.w;\n", dot(22..24, "v.zw"), n[24]),
        format!("    let of_b = {:?} + {}\n", n[25], dot(26..28, "v.xw")),
        format!("        + v.x * {} + {:?} * v.w * v.w;\n", dot(28..30, "v.xw"), n[30]),
    ]
    .concat()
}

/// The errors of the current and the found numbers on held-out surfaces, then the found numbers, then [`materials`].
#[must_use]
pub fn text(count: usize) -> String {
    let found = find(&places(count, false));
    let held_out = places(count / 2, true);
    let (low, usual): (Vec<Place>, Vec<Place>) = held_out.iter().partition(|place| place.theta() > 88_f64.to_radians());
    let mut out = String::new();
    // Writing to a String cannot fail.
    for (name, places) in [("views to 88 degrees", &usual), ("views from 88 to 89.9 degrees", &low)] {
        let errors = |numbers: &[f64; 31]| errors_of(places, numbers).map(|x| format!("{x:.4}")).join(" / ");
        let (current, new) = (errors(&LOSS), errors(&found));
        let _ = writeln!(out, "{name}, mean / 95th percentile / largest error: current {current}, found {new}");
    }
    let least = usual.iter().map(|place| place.albedo).fold(1.0, f64::min);
    let _ = writeln!(out, "least albedo {least:.3}");
    let worst = errors(&usual, |place| albedo(place.alpha, place.wo))[2];
    let _ = writeln!(out, "largest error of the library {worst:.4}");
    let _ = writeln!(out, "{}\n{}", as_rust(&found), as_wgsl(&found));
    out + &materials()
}

/// The number of views in a mean. Views are evenly spaced in the squared cosine, because uniform light weights a view
/// by its cosine.
const VIEWS: usize = 64;

/// The tables of docs/materials.md: the part of a white sky that isotropic surfaces reflect. The columns are one
/// bounce, one bounce with the factor, and the series of bounces of Kulla and Conty. For the mean albedo `A`, the
/// series adds `f0^2 A / (1 - f0 (1 - A))` of the light that one bounce loses.
///
/// # Panics
/// Never: each surface and view is within bounds.
#[must_use]
pub fn materials() -> String {
    let mut out = String::from("docs/materials.md, albedo: mean, and for views of 0, 45, 75 and 85 degrees:\n\n");
    out += "| alpha | mean | 0 degrees | 45 degrees | 75 degrees | 85 degrees |\n|---|---|---|---|---|---|\n";
    let brdf = BrdfKind::Ggx.into();
    let of = |alpha: f64, theta: f64| {
        sampled(&brdf, &Configuration { alpha_x: alpha, alpha_y: alpha, theta, phi: 0.0 }).expect("a surface")
    };
    let mean = |alpha: f64| {
        let cosine = |i: usize| ((i as f64 + 0.5) / VIEWS as f64).sqrt();
        (0..VIEWS).map(|i| of(alpha, cosine(i).acos())).sum::<f64>() / VIEWS as f64
    };
    let alphas = [0.0625, 0.25, 0.5625, 1.0];
    for alpha in alphas {
        let views = [0.0_f64, 45.0, 75.0, 85.0].map(|degrees| format!("{:.2}", of(alpha, degrees.to_radians())));
        // Writing to a String cannot fail.
        let _ = writeln!(out, "| {alpha} | {:.2} | {} |", mean(alpha), views.join(" | "));
    }
    out += "\ndocs/materials.md, reflected part of a white sky: one bounce, with the factor, by the series:\n\n";
    let heads = alphas.map(|alpha| format!("alpha {alpha}")).join(" | ");
    let _ = writeln!(out, "| f0 | {heads} |\n|---|---|---|---|---|");
    for f0 in [1.0, 0.9, 0.5, 0.2, 0.04] {
        let cells = alphas.map(|alpha| {
            let a = mean(alpha);
            let series = f0 * f0 * a / (1.0 - f0 * (1.0 - a));
            let by_series = f0 * a + (1.0 - a) * series;
            format!("{:.3}, {:.3}, {by_series:.3}", f0 * a, f0 * a * compensation(a, f0))
        });
        let _ = writeln!(out, "| {f0} | {} |", cells.join(" | "));
    }
    out
}
