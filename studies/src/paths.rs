//! Measures model `normals` along paths: lights that grow, and lights and views that move smoothly. Mean errors hide
//! these faults, but eyes see them.

use ltcforge::{
    fit::Sides,
    light::{
        NormalsRule,
        normals::{BULGE, reflected, visible_by_arcs},
    },
};

use glam::DVec3;
use rayon::prelude::*;

use crate::lights::{Kind, Lit, Spread, lits, truth_of};

/// Points of a growth path.
const GROWTH: usize = 60;
/// Points of a smooth path, and of its truth.
const SMOOTH: [usize; 2] = [1000, 100];
/// The slope change within one step of a smooth path that counts as a false step if the truth does not have it, relative
/// to the largest slope of the truth.
const STEP: f64 = 0.05;
/// The tolerance of the truth of smooth paths.
pub const TOLERANCE: f64 = 1e-5;
/// The tolerance of the truth where a smooth path bends.
const TOLERANCE_OF_BENDS: f64 = 1e-8;
/// Reflectance at normal incidence of the plastic.
const PLASTIC: f64 = 0.04;

/// A path of lights, for a parameter from 0 to 1.
type Path<'a> = &'a dyn Fn(&Lit, f64) -> Lit;

/// The faults of a rule, or of V alone, along the paths.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Faults {
    /// The share of smooth paths with false steps, for metal and for plastic.
    pub false_steps: [f64; 2],
    /// p95 of the relative error of strips that reflect more than .001.
    pub strips: f64,
    /// The share of strips growing to one side that lose over a tenth of their light.
    pub lost: f64,
    /// The largest loss of a light growing to one side: p99 over the paths, and the share of paths above .005.
    pub to_one_side: [f64; 2],
    /// p99 and maximum of the largest loss of a light growing about its middle, for metal and for plastic.
    pub about_middle: [[f64; 2]; 2],
}

fn vertices(lit: &Lit, of: impl Fn(&[DVec3; 4]) -> [DVec3; 4]) -> Lit {
    let corners = std::array::from_fn(|i| DVec3::from_array(lit.vertices[i]));
    Lit { at: lit.at, vertices: of(&corners).map(|v| v.to_array()).to_vec() }
}

/// Grows from a twentieth of its size to four times its size, about its middle.
#[must_use]
pub fn about_middle(lit: &Lit, t: f64) -> Lit {
    vertices(lit, |v| {
        let centre = 0.5 * (v[0] + v[2]);
        v.map(|corner| centre + (corner - centre) * 0.05 * 80_f64.powf(t))
    })
}

/// Grows from a twentieth of its width to four times its width, while one edge stays.
#[must_use]
pub fn to_one_side(lit: &Lit, t: f64) -> Lit {
    vertices(lit, |v| {
        let size = 0.05 * 80_f64.powf(t);
        [v[0], v[0] + (v[1] - v[0]) * size, v[3] + (v[2] - v[3]) * size, v[3]]
    })
}

/// Moves by its own width, turns about its normal and tilts the view. It stays above the surface.
#[must_use]
pub fn smooth(lit: &Lit, t: f64) -> Lit {
    let moved = vertices(lit, |v| {
        let centre = 0.5 * (v[0] + v[2]);
        let shift = (v[1] - v[0]) * (t - 0.5);
        let normal = (v[1] - v[0]).cross(v[2] - v[1]).normalize();
        let turn = glam::DQuat::from_axis_angle(normal, 0.6 * t);
        v.map(|corner| centre + shift + turn * (corner - centre))
    });
    let mut at = moved.at;
    at.theta = (at.theta + 0.1 * t).min(1.5);
    Lit { at, ..moved }
}

/// The largest fall of a sequence below its earlier maximum; with `relative`, divided by this maximum where it is above
/// .01.
fn fall(values: impl Iterator<Item = f64>, relative: bool) -> f64 {
    let fallen = |(most, worst): (f64, f64), x: f64| {
        let most = most.max(x);
        let part = if relative { if most > 0.01 { (most - x) / most } else { 0.0 } } else { most - x };
        (most, worst.max(part))
    };
    values.fold((0.0, 0.0), fallen).1
}

fn along(lit: &Lit, path: Path<'_>, count: usize) -> impl Iterator<Item = Lit> {
    (0..count).map(move |i| path(lit, i as f64 / (count - 1) as f64))
}

fn plastic([energy, schlick]: [f64; 2]) -> f64 {
    PLASTIC * (energy - schlick) + schlick
}

fn share(values: &[f64], above: f64) -> f64 {
    values.iter().filter(|x| **x > above).count() as f64 / values.len() as f64
}

/// The largest slope of values along a path.
fn slope(values: &[f64]) -> f64 {
    values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max) * (values.len() - 1) as f64
}

/// True if the slope of `values` changes by more than [`STEP`] of `largest` within one step, where the slope of the
/// truth does not. `truth` is only evaluated where the values bend.
fn has_false_step(values: &[f64], largest: f64, truth: impl Fn(usize) -> f64) -> bool {
    let least = STEP * largest.max(1e-9) / (values.len() - 1) as f64;
    let bend = |of: &dyn Fn(usize) -> f64, i: usize| of(i + 1) - 2.0 * of(i) + of(i - 1);
    let value = |i: usize| values[i];
    (1..values.len() - 1)
        .filter(|i| bend(&value, *i).abs() > least)
        .any(|i| (bend(&value, i) - bend(&truth, i)).abs() > least)
}

/// Smooth paths: the lights stay above the surface, and the surface is not a mirror.
#[must_use]
pub fn smooth_paths(seed: u64, count: usize) -> Vec<Lit> {
    let is_smooth = |lit: &Lit| {
        lit.at.alpha_x.min(lit.at.alpha_y) > 0.05
            && [0.0, 0.5, 1.0].into_iter().all(|t| smooth(lit, t).vertices.iter().all(|v| v[2] > 0.05))
    };
    lits(Kind::Random, seed, 40 * count).into_iter().filter(is_smooth).take(count).collect()
}

/// Measures a function for the light of a rule. `scale` multiplies the number of paths: 1 for 2,000 growth paths, 500
/// strips and 80 smooth paths.
#[must_use]
pub fn measure(seed: u64, scale: f64, reflected: impl Fn(&Lit) -> [f64; 2] + Sync) -> Faults {
    let count = |usual: f64| (usual * scale).ceil() as usize;
    let falls = |lights: &[Lit], path: fn(&Lit, f64) -> Lit, relative: bool, of: fn([f64; 2]) -> f64| -> Vec<f64> {
        lights.par_iter().map(|lit| fall(along(lit, &path, GROWTH).map(|lit| of(reflected(&lit))), relative)).collect()
    };
    let energy: fn([f64; 2]) -> f64 = |parts| parts[0];
    let growing = lits(Kind::Random, seed, count(1000.0));
    let growing = [growing, lits(Kind::Anisotropic, seed + 1, count(1000.0))].concat();
    let sides = falls(&growing, to_one_side, false, energy);
    let middle = [energy, plastic].map(|of| Spread::of(falls(&growing, about_middle, false, of)));

    let cases = crate::lights::cases(Kind::Strip, seed + 2, count(500.0));
    let bright = cases.iter().filter(|case| case.truth[0] > 0.001);
    let relative = bright.map(|case| (reflected(&case.lit)[0] - case.truth[0]).abs() / case.truth[0]).collect();
    let strips: Vec<Lit> = cases.iter().map(|case| case.lit.clone()).collect();

    let false_steps: Vec<[bool; 2]> = smooth_paths(seed + 3, count(80.0))
        .par_iter()
        .map(|lit| {
            let found: Vec<[f64; 2]> = along(lit, &smooth, SMOOTH[0]).map(|lit| reflected(&lit)).collect();
            let coarse: Vec<[f64; 2]> = along(lit, &smooth, SMOOTH[1]).map(|lit| truth_of(&lit, TOLERANCE)).collect();
            let at = |i: usize| truth_of(&smooth(lit, i as f64 / (SMOOTH[0] - 1) as f64), TOLERANCE_OF_BENDS);
            [energy, plastic].map(|of| {
                let [found, coarse] = [&found, &coarse].map(|values| values.iter().map(|x| of(*x)).collect::<Vec<_>>());
                has_false_step(&found, slope(&coarse), |i| of(at(i)))
            })
        })
        .collect();
    let p99 = Spread::of(sides.clone()).p99;
    Faults {
        false_steps: [0, 1]
            .map(|part| false_steps.iter().filter(|has| has[part]).count() as f64 / false_steps.len() as f64),
        strips: Spread::of(relative).p95,
        lost: share(&falls(&strips, to_one_side, true, energy), 0.1),
        to_one_side: [p99, share(&sides, 0.005)],
        about_middle: middle.map(|spread| [spread.p99, spread.max]),
    }
}

/// The light by a rule.
pub fn by_rule(rule: NormalsRule) -> impl Fn(&Lit) -> [f64; 2] + Sync {
    move |lit| reflected(lit.alpha(), lit.wo(), &lit.vertices, Sides::Two, rule)
}

/// The visible part alone, by four arcs per edge.
#[must_use]
pub fn visible_alone(lit: &Lit) -> [f64; 2] {
    [visible_by_arcs(lit.alpha(), lit.wo(), &lit.vertices, BULGE).abs(), 0.0]
}

/// A Markdown table of the faults of V alone and of each rule.
#[must_use]
pub fn table(seed: u64, scale: f64) -> String {
    let rules = NormalsRule::ALL.iter().map(|rule| row(rule.name(), measure(seed, scale, by_rule(*rule))));
    let alone = row("V alone", measure(seed, scale, visible_alone));
    HEAD.to_owned() + &rules.collect::<String>() + &alone
}

/// The head of a table of faults.
pub const HEAD: &str = "| | false steps, F0 1, .04 | strips: p95 | lose a tenth | to one side: p99, above .005 | about \
                        the middle: p99, max | plastic |\n|---|---|---|---|---|---|---|\n";

/// A row of a table of faults.
#[must_use]
pub fn row(name: &str, faults: Faults) -> String {
    let Faults { false_steps, strips, lost, to_one_side, about_middle } = faults;
    let percent = |x: f64| format!("{:.1} %", 100.0 * x);
    let [metal, plastic] = about_middle.map(|[p99, max]| format!("{p99:.4}, {max:.4}"));
    format!(
        "| {name} | {}, {} | {strips:.3} | {} | {:.4}, {} | {metal} | {plastic} |\n",
        percent(false_steps[0]),
        percent(false_steps[1]),
        percent(lost),
        to_one_side[0],
        percent(to_one_side[1]),
    )
}
