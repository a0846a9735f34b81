//! Checks the figures of docs/textured.md with fewer lights.

use std::{collections::BTreeMap, sync::LazyLock};

use glam::DQuat;
use ltcforge::{
    fit::Sides,
    light::{PolygonLight, TableUse},
};
use ltcforge_light::cases::{Draw, Lit, Roughness, jump};

use super::*;
use crate::textured::cases::Set;

const DOCUMENT: &str = include_str!("../../../docs/textured.md");

/// The tested sets, with the number of lights per set. They are the first of the 900 lights in the document.
const TESTED: [Set; 5] = [Set::Random, Set::Anisotropic, Set::Grazing, Set::Rough, Set::Floor];
const LIGHTS: usize = 180;
/// The relative tolerance of the mean and of the 95th percentile, compared with all 900 lights.
const MARGIN: [f64; 2] = [0.12, 0.15];

/// The tested rows of the document's table.
const ROWS: [&str; 3] = ["LTC, its own kernel, 4", "`normals`, `balanced`, 1", "`normals`, `balanced`, 4"];

static TABLE: LazyLock<Table> =
    LazyLock::new(|| fitted(&Recipe::builder().preset(Preset::Paper).build().expect("a recipe")));

/// Mean and 95th percentile of a row, for each set.
fn stated(row: &str) -> BTreeMap<&'static str, [f64; 2]> {
    let cells = |line: &'static str| line.trim_matches('|').split('|').map(str::trim).skip(1);
    let head = DOCUMENT.lines().find(|line| line.starts_with("| | random (mean")).expect("a table");
    let line = DOCUMENT.lines().find(|line| line.starts_with(&format!("| {row} |"))).expect("a row");
    let number = |text: &str| format!("0{}", text.trim()).parse::<f64>().expect("a number");
    let pair = |cell: &str| {
        let mut numbers = cell.split(',').map(number);
        [0; 2].map(|_| numbers.next().expect("two numbers"))
    };
    cells(head).map(|cell| cell.split(' ').next().unwrap_or(cell)).zip(cells(line).map(pair)).collect()
}

#[test]
fn errors_agree_with_the_document() {
    let pictures: Vec<Pictures> = cases::FORMS.into_par_iter().map(Pictures::new).collect();
    let ways = ways([&TABLE, &TABLE], &pictures);
    let tested = ROWS.map(|row| (ways.iter().find(|(name, _)| name == row).expect("a way"), stated(row)));
    let mut outside = Vec::new();
    for set in TESTED {
        let cases = cases(set, LIGHTS, &pictures);
        for ((name, way), stated) in &tested {
            let errors = cases.par_iter().flat_map_iter(|case| {
                let found = way(case);
                found.into_iter().zip(&case.truth).map(|(found, truth)| (found - truth).abs()).collect::<Vec<_>>()
            });
            let Spread { mean, p95, .. } = Spread::of(errors.collect());
            let [a, b] = stated[set.name()];
            println!("{name}, {}: {mean:.5} / {p95:.4}, documented {a} / {b}", set.name());
            if (mean / a - 1.0).abs() > MARGIN[0] || (p95 / b - 1.0).abs() > MARGIN[1] {
                outside.push(format!("{name}, {}: {mean:.5} / {p95:.4}, not {a} / {b}", set.name()));
            }
        }
    }
    assert!(outside.is_empty(), "{outside:#?}");
}

/// Bisects random paths to find jumps, as `jumps_along_random_paths_are_small` of the library does for `normals`.
#[test]
fn tables_jump_only_by_rounding_errors() {
    let pyramid = &Pictures::new([128, 128]).pyramids[0];
    let used = (TableUse::default(), Readings::Four);
    let most = |seed: u64| {
        let mut draw = Draw::new(4600 + seed);
        let lit = draw.lit_by(Roughness::All, [0.05, 1.2]);
        let axis = draw.vector().normalize();
        let [angle, phi] = [0.0, 0.0].map(|_: f64| draw.within(-1.0, 1.0));
        let theta = draw.within(0.0, 1.5);
        jump(|t| {
            let Lit { mut at, mut vertices } = lit.clone();
            let turn = DQuat::from_axis_angle(axis, angle * (t - 0.5));
            for v in &mut vertices {
                *v = turn * *v;
            }
            at.phi += 0.1 * phi * t;
            at.theta += (theta - lit.at.theta) * 0.1 * t;
            let light = PolygonLight::new(vertices, Sides::Two).and_then(TexturedLight::new).expect("a rectangle");
            light.by_table(&TABLE, &at, pyramid, used).expect("a light").energy[2]
        })
    };
    let jumps: Vec<f64> = (0..300).into_par_iter().map(most).collect();
    let most = jumps.iter().copied().fold(0.0, f64::max);
    println!("largest jump: {most:.1e}");
    assert!(most < 1e-9, "{most}");
}
