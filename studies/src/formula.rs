//! Finds the numbers of model `ltc-formula`: see docs/formula.md.
//!
//! The optimiser is Levenberg-Marquardt. Weights that follow the residuals make the objective nearly the sum
//! of absolute errors. All random numbers come from the seed, and sums have a fixed order.

use std::{f64::consts::TAU, fmt::Write as _};

use ltcforge::{
    fit::Sides,
    light::ltc::{
        FormulaLobe,
        formula::{COUNT, Feature, Polynomial},
    },
};

use glam::DVec3;
use rayon::prelude::*;

pub use ltcforge::light::ltc::formula::COEFFICIENTS;

use crate::{
    draw::Draw,
    lights::{Case, Kind, Spread, cases},
    markdown::short,
};

/// Characters of a line.
const LINE: usize = 120;
/// Significant digits of a number in the source, and most digits after the point.
const DIGITS: [i32; 2] = [4, 5];
/// Errors below this are negligible: the objective is quadratic there.
const NEGLIGIBLE: f64 = 1e-3;
/// The weight of the squared error relative to the absolute error. It reduces large errors.
const LARGE: f64 = 10.0;
/// Reflectance at normal and at grazing incidence of the plastic in the objective.
const PLASTIC: [f64; 2] = [0.04, 1.0];
/// The weight of an error of the plastic, whose light is a twentieth of the metal's.
const OF_PLASTIC: f64 = 6.0;
/// The weight of the squared numbers in the objective. Without it, large numbers would cancel each other.
const SMALL: f64 = 3e-6;
/// The weight of a determinant below [`LEAST`].
const OF_LOBE: f64 = 0.3;
/// The least determinant, relative to the determinant without corrections.
const LEAST: f64 = 0.1;
/// The weight of an error in Schlick's part of the metal.
const OF_SCHLICK: f64 = 0.5;

/// The kinds in the search, and their weights.
const KINDS: [(Kind, f64); 14] = [
    (Kind::Random, 4.0),
    (Kind::Isotropic, 2.5),
    (Kind::Anisotropic, 9.0),
    (Kind::Huge, 2.0),
    (Kind::Extreme, 0.5),
    (Kind::NearHorizon, 0.5),
    (Kind::Floor, 0.5),
    (Kind::Around, 0.5),
    (Kind::Sliver, 1.0),
    (Kind::Steep, 1.5),
    (Kind::Strip, 2.0),
    (Kind::Sharp, 3.0),
    (Kind::Across, 0.5),
    (Kind::Tiny, 1.0),
];

/// The options of [`find`].
#[derive(Debug, Clone, Copy)]
pub struct Options {
    /// Lights of each kind in the search. The same number is held out.
    pub lights: usize,
    /// Steps of the search.
    pub steps: usize,
    /// Seed of the lights.
    pub seed: u64,
}

/// The numbers found, with the objectives of the current and the found numbers.
#[derive(Debug, Clone)]
pub struct Found {
    /// The numbers, rounded to the digits of the source.
    pub numbers: [f64; COUNT],
    /// Objectives of the current and the found numbers on the cases of the search.
    pub training: [f64; 2],
    /// Objectives on held-out cases.
    pub held_out: [f64; 2],
}

/// The reflected light: for a Fresnel factor of one, weighted by Schlick's factor, and of the plastic.
#[must_use]
pub fn reflected(numbers: &[f64; COUNT], case: &Case) -> [f64; 3] {
    let lit = &case.lit;
    let of = |fresnel| {
        let lobe = FormulaLobe::by(numbers, lit.alpha(), lit.wo(), fresnel);
        (lobe.parts, lobe.space.polygon(&lit.vertices, Sides::Two))
    };
    let ([energy, schlick], covered) = of([1.0, 1.0]);
    let (_, of_plastic) = of(PLASTIC);
    [energy * covered, schlick * covered, plastic([energy, schlick]) * of_plastic]
}

fn plastic([energy, schlick]: [f64; 2]) -> f64 {
    PLASTIC[0] * (energy - schlick) + PLASTIC[1] * schlick
}

fn truth(case: &Case) -> [f64; 3] {
    [case.truth[0], case.truth[1], plastic(case.truth)]
}

/// A training case: a light or a lobe.
enum Lesson {
    /// A light.
    Light(Case),
    /// A lobe whose determinant must be positive: roughness along x and y, and the view direction.
    Lobe([f64; 2], [f64; 3]),
}

/// The residuals of a lesson.
fn residuals(numbers: &[f64; COUNT], lesson: &Lesson) -> [f64; 3] {
    match lesson {
        Lesson::Light(case) => {
            let (found, truth) = (reflected(numbers, case), truth(case));
            let weights = [1.0, OF_SCHLICK, OF_PLASTIC];
            std::array::from_fn(|i| weights[i] * (found[i] - truth[i]))
        }
        Lesson::Lobe([x, y], wo) => {
            let stretched = DVec3::new(x * wo[0], y * wo[1], wo[2]).normalize() + DVec3::Z;
            let cosine =
                DVec3::new(x * stretched.x, y * stretched.y, stretched.z).normalize().dot(DVec3::from_array(*wo));
            // The determinant relative to that without corrections.
            let relative = |f0| {
                FormulaLobe::by(numbers, [*x, *y], *wo, [f0, 1.0]).space.determinant() * x * y / (2.0 * cosine * cosine)
            };
            [1.0, PLASTIC[0], 0.0].map(|f0| OF_LOBE * (LEAST - relative(f0)).max(0.0))
        }
    }
}

fn loss(x: f64) -> f64 {
    x.hypot(NEGLIGIBLE) - NEGLIGIBLE + LARGE * x * x
}

/// The slope of the loss, divided by the residual.
fn importance(x: f64) -> f64 {
    1.0 / x.hypot(NEGLIGIBLE) + 2.0 * LARGE
}

type Weighed = (f64, Lesson);

fn draw(seed: u64, lights: usize) -> Vec<Weighed> {
    let kinds = KINDS.into_iter().enumerate();
    let of_lights = kinds.flat_map(|(i, (kind, weight))| {
        cases(kind, 100 * seed + i as u64, lights).into_iter().map(move |case| (weight, Lesson::Light(case)))
    });
    let mut draw = Draw::new(seed);
    let lobes = (0..2 * lights).map(|_| {
        let alpha = [0, 1].map(|_| draw.logarithmic(1e-5, 1.0));
        let (height, phi) = (draw.logarithmic(1e-4, 1.0), draw.within(0.0, TAU));
        let flat = (1.0 - height * height).sqrt();
        (1.0, Lesson::Lobe(alpha, [flat * phi.cos(), flat * phi.sin(), height]))
    });
    of_lights.chain(lobes).collect()
}

/// The mean loss over the cases.
#[must_use]
fn objective(numbers: &[f64; COUNT], cases: &[Weighed]) -> f64 {
    let losses: Vec<f64> = cases
        .par_iter()
        .map(|(weight, case)| weight * residuals(numbers, case).map(loss).iter().sum::<f64>())
        .collect();
    let size = numbers.iter().map(|number| number * number).sum::<f64>();
    losses.iter().sum::<f64>() / cases.iter().map(|(weight, _)| weight).sum::<f64>() + SMALL * size
}

/// The gradient of the objective, and the Gauss-Newton matrix.
fn slopes(numbers: &[f64; COUNT], cases: &[Weighed]) -> (Vec<f64>, Vec<Vec<f64>>) {
    const STEP: f64 = 1e-5;
    let chunk = |cases: &[Weighed]| {
        let (mut gradient, mut matrix) = (vec![0.0; COUNT], vec![vec![0.0; COUNT]; COUNT]);
        for (weight, case) in cases {
            let at = residuals(numbers, case);
            let moved: Vec<[f64; 3]> = (0..COUNT)
                .map(|k| {
                    let mut moved = *numbers;
                    moved[k] += STEP;
                    residuals(&moved, case)
                })
                .collect();
            for part in 0..3 {
                let by = weight * importance(at[part]);
                let slope: Vec<f64> = moved.iter().map(|moved| (moved[part] - at[part]) / STEP).collect();
                for i in 0..COUNT {
                    gradient[i] += by * at[part] * slope[i];
                    for j in 0..=i {
                        matrix[i][j] += by * slope[i] * slope[j];
                    }
                }
            }
        }
        (gradient, matrix)
    };
    let parts: Vec<_> = cases.par_chunks(512).map(chunk).collect();
    let (mut gradient, mut matrix) = (vec![0.0; COUNT], vec![vec![0.0; COUNT]; COUNT]);
    let all = 2.0 * SMALL * cases.iter().map(|(weight, _)| weight).sum::<f64>();
    for i in 0..COUNT {
        gradient[i] = all * numbers[i];
        matrix[i][i] = all;
    }
    for (some, more) in parts {
        for i in 0..COUNT {
            gradient[i] += some[i];
            for j in 0..=i {
                matrix[i][j] += more[i][j];
            }
        }
    }
    (gradient, matrix)
}

/// Solves a positive definite system by Cholesky's factors. The lower half of `matrix` is read.
fn solved(mut matrix: Vec<Vec<f64>>, right: &[f64]) -> Option<Vec<f64>> {
    let count = right.len();
    for i in 0..count {
        for j in 0..=i {
            let sum = (0..j).fold(matrix[i][j], |sum, k| sum - matrix[i][k] * matrix[j][k]);
            if i == j {
                if sum <= 0.0 {
                    return None;
                }
                matrix[i][i] = sum.sqrt();
            } else {
                matrix[i][j] = sum / matrix[j][j];
            }
        }
    }
    let mut x = right.to_vec();
    for i in 0..count {
        x[i] = (0..i).fold(x[i], |sum, k| sum - matrix[i][k] * x[k]) / matrix[i][i];
    }
    for i in (0..count).rev() {
        x[i] = (i + 1..count).fold(x[i], |sum, k| sum - matrix[k][i] * x[k]) / matrix[i][i];
    }
    Some(x)
}

/// Starting coefficients: no corrections. The amplitude is `g^2`, and the incidence is `g`.
fn start() -> [f64; COUNT] {
    let mut numbers = [0.0; COUNT];
    let mut set = |polynomial: Polynomial, product: [Feature; 2], value| {
        let at = polynomial.products().iter().position(|other| *other == product);
        numbers[polynomial.start() + at.expect("a term of the polynomial")] = value;
    };
    set(Polynomial::Incidence, [Feature::Weight, Feature::One], 1.0);
    numbers
}

/// Searches from the numbers without corrections.
#[must_use]
pub fn find(options: &Options) -> Found {
    let [training, held_out] = [options.seed, options.seed + 1].map(|seed| draw(seed, options.lights));
    let mut numbers = start();
    let mut best = objective(&numbers, &training);
    let mut damping = 1e-2;
    for _ in 0..options.steps {
        let (gradient, matrix) = slopes(&numbers, &training);
        let (before, mut is_better) = (best, false);
        for _ in 0..8 {
            let mut damped = matrix.clone();
            for (i, row) in damped.iter_mut().enumerate() {
                row[i] += damping * row[i] + 1e-9;
            }
            if let Some(change) = solved(damped, &gradient) {
                let moved: [f64; COUNT] = std::array::from_fn(|k| numbers[k] - change[k]);
                let found = objective(&moved, &training);
                if found < best {
                    (numbers, best, is_better) = (moved, found, true);
                    damping = (damping * 0.3).max(1e-9);
                    break;
                }
            }
            damping *= 4.0;
        }
        if !is_better || before - best < 1e-5 * best {
            break;
        }
    }
    let numbers = numbers.map(rounded);
    let [training, held_out] =
        [training, held_out].map(|cases| [&COEFFICIENTS, &numbers].map(|numbers| objective(numbers, &cases)));
    Found { numbers, training, held_out }
}

/// A number rounded to the digits of the source.
fn rounded(x: f64) -> f64 {
    if x == 0.0 {
        return 0.0;
    }
    let one = 10_f64.powi((DIGITS[0] - 1 - x.abs().log10().floor() as i32).min(DIGITS[1]));
    if one >= 1.0 { (x * one).round() / one } else { (x * one).round() * one.recip().round() }
}

/// The numbers as written in `src/light/ltc/formula/numbers.rs`.
#[must_use]
pub fn as_rust(numbers: &[f64; COUNT]) -> String {
    let mut out = "pub const COEFFICIENTS: [f64; COUNT] = [".to_owned();
    let mut length = LINE;
    for number in numbers.map(|number| format!("{number:?},")) {
        let is_full = length + 1 + number.len() > LINE;
        let space = if is_full { "\n    " } else { " " };
        length = if is_full { 4 } else { length + 1 } + number.len();
        out += space;
        out += &number;
    }
    out + "\n];\n"
}

/// The polynomials as written in `shaders/ltc_formula.wgsl`.
#[must_use]
pub fn as_wgsl(numbers: &[f64; COUNT]) -> String {
    let line = |polynomial: &Polynomial| {
        let products = polynomial.products();
        let numbers = &numbers[polynomial.start()..];
        let mut firsts: Vec<Feature> = Vec::new();
        for [first, _] in products {
            if !firsts.contains(first) {
                firsts.push(*first);
            }
        }
        let group = |first: &Feature| {
            let terms: Vec<String> = products
                .iter()
                .zip(numbers)
                .filter(|([other, _], _)| other == first)
                .map(|([_, second], number)| match word(*second) {
                    "" => format!("{number:?}"),
                    word => format!("{number:?} * {word}"),
                })
                .collect();
            match (word(*first), terms.len()) {
                ("", _) => terms.join(" + "),
                (word, 1) => format!("{word} * {}", terms[0]),
                (word, _) => format!("{word} * ({})", terms.join(" + ")),
            }
        };
        let groups: Vec<String> = firsts.iter().map(group).collect();
        let joined = format!("    let {} = {};\n", name(*polynomial), groups.join(" + "));
        if joined.len() <= LINE + 1 {
            return joined;
        }
        format!("    let {} = {};\n", name(*polynomial), groups.join("\n        + "))
    };
    Polynomial::ALL.iter().map(line).collect::<String>().replace("+ -", "- ")
}

/// The name of a polynomial in the shader.
fn name(polynomial: Polynomial) -> &'static str {
    match polynomial {
        Polynomial::Stretch => "stretch",
        Polynomial::Tilt => "tilt",
        Polynomial::Along => "along",
        Polynomial::Row => "row",
        Polynomial::Swell => "swell",
        Polynomial::Lift => "lift",
        Polynomial::ByLarger => "by_larger",
        Polynomial::BySmaller => "by_smaller",
        Polynomial::Incidence => "incidence",
    }
}

/// The name of a feature in the shader; empty for the number one.
fn word(feature: Feature) -> &'static str {
    match feature {
        Feature::One => "",
        Feature::Larger => "larger",
        Feature::Smaller => "smaller",
        Feature::Axis => "a",
        Feature::Mu => "mu",
        Feature::Length => "size",
        Feature::Cosine => "d",
        Feature::Weight => "g",
        Feature::Rise => "rise",
        Feature::Share => "share",
    }
}

/// A Markdown table of errors by kind.
#[must_use]
pub fn by_kind(seed: u64, lights: usize, candidates: &[(&str, &[f64; COUNT])]) -> String {
    let kinds = [
        Kind::Random,
        Kind::Anisotropic,
        Kind::Sharp,
        Kind::Steep,
        Kind::Strip,
        Kind::Huge,
        Kind::Tiny,
        Kind::Extreme,
        Kind::Isotropic,
    ];
    let mut out = "| lights |".to_owned();
    for (name, _) in candidates {
        let _ = write!(out, " {name}: energy mean / p95 / max; Schlick; plastic |");
    }
    let _ = writeln!(out, "\n|---|{}", "---|".repeat(candidates.len()));
    for (i, kind) in kinds.into_iter().enumerate() {
        let cases = cases(kind, 1000 * seed + i as u64, lights);
        let _ = write!(out, "| {} |", kind.name());
        for (_, numbers) in candidates {
            let found: Vec<[f64; 3]> = cases.par_iter().map(|case| reflected(numbers, case)).collect();
            let errors = |part: usize| {
                let errors = cases.iter().zip(&found).map(|(case, found)| (found[part] - truth(case)[part]).abs());
                Spread::of(errors.collect())
            };
            let Spread { mean, p95, max, .. } = errors(0);
            let light = cases.iter().map(|case| truth(case)[2]).sum::<f64>() / cases.len() as f64;
            let cells = [mean, p95, max].map(|x| short(x, 3)).join(" / ");
            let plastic = 100.0 * errors(2).mean / light;
            let _ = write!(out, " {cells}; {}; {plastic:.1} % |", short(errors(1).mean, 2));
        }
        out.push('\n');
    }
    out
}
