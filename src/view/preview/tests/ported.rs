//! Tests the exported shader on the GPU and its twin on the CPU.

use std::f64::consts::TAU;

use glam::{DVec3, Vec3};

use super::report_skipped;
use crate::preview::{
    ShaderTable, TexelFormat,
    cpu::tests as cpu,
    gpu::{GpuFailure, tests::example},
};
use ltcforge_fit::{
    Layout, Ltc, Sides,
    math::{from_row_major, sin_cos},
};
use ltcforge_light::{
    CosineSpace, Gaussian, LightModel,
    cases::{Draw, Lit, Roughness},
    gaussians::{self, SgLight},
    normals::{NormalsRule, reflected},
};
use ltcforge_shaders::{Bound, CASES, CORNERS, Case, Golden, Language, LitBy, SG_LIGHT, TOLERANCE, golden_table};
use ltcforge_translate::port;

pub(super) fn lit_by(model: LightModel, layout: Option<Layout>) -> LitBy {
    LitBy::new(model, layout).expect("a model that supports this layout")
}

#[test]
fn the_twin_of_the_shader_gives_the_printed_values() {
    for &layout in Layout::ALL {
        for format in [TexelFormat::F32, TexelFormat::F16] {
            let table = ShaderTable::new(&golden_table(layout), format);
            for case in CASES {
                let Golden { matrix, amplitude, fresnel, covered } = case.golden(layout);
                let wo = Vec3::from_array(case.wo.map(|x| x as f32));
                let corners = CORNERS.map(|corner| Vec3::from_array(corner.map(|x| x as f32)));
                let (m, terms) = cpu::lit(&table, case.alpha_x as f32, case.alpha_y as f32, wo, &corners);
                let found = m.transpose().to_cols_array().into_iter().chain(terms);
                for (found, expected) in found.zip(matrix.into_iter().chain([amplitude, fresnel, covered])) {
                    assert!((f64::from(found) - expected).abs() < TOLERANCE, "{layout:?} {case:?}: {found} {expected}");
                }
            }
        }
    }
}

/// A light for `ltc_example`: `count` vertices, or the centre and half axes of a disk if `count` is 0.
pub(super) struct ExampleLight {
    pub(super) count: u8,
    pub(super) given: Vec<DVec3>,
    /// The polygon for the integral in f64.
    pub(super) outline: Vec<DVec3>,
    /// Radius or width.
    pub(super) size: f64,
}

impl ExampleLight {
    /// The part of an LTC that the light covers, in f64.
    pub(super) fn covered(&self, space: &CosineSpace<f64>, sides: Sides) -> f64 {
        match (self.count, &self.given[..]) {
            (0, [centre, x, y]) => space.ellipse(*centre, [*x, *y], sides),
            (1, [centre]) => space.sphere(*centre, self.size),
            (2, [start, end]) => space.tube([*start, *end], self.size),
            (9, [start, end]) => space.line([*start, *end], self.size),
            _ => space.polygon(&self.outline, sides),
        }
    }
}

/// The lights that only LTCs support: a sphere, a tube and a line. The horizon cuts each of them.
pub(super) fn round_lights() -> Vec<ExampleLight> {
    let ends = vec![DVec3::new(0.3, -0.8, 0.9), DVec3::new(0.1, 1.2, -0.4)];
    let light =
        |count: u8, given: &[DVec3], size: f64| ExampleLight { count, given: given.into(), outline: vec![], size };
    vec![light(1, &[DVec3::new(0.5, 0.4, 0.3)], 0.45), light(2, &ends, 0.25), light(9, &ends, 0.1)]
}

pub(super) fn example_lights() -> Vec<ExampleLight> {
    let corners = CORNERS.map(DVec3::from_array);
    let mut lights = vec![ExampleLight { count: 4, given: corners.into(), outline: corners.into(), size: 0.0 }];
    // The vertices run clockwise as seen from the shaded point. At least one is below the horizon.
    let (centre, x, y) = (DVec3::new(0.3, 0.2, 0.6), DVec3::new(0.9, 0.0, 0.4), DVec3::new(0.0, -0.8, 0.5));
    let around = |n: u32| -> Vec<DVec3> {
        let at = |k: u32| sin_cos(-TAU * f64::from(k) / f64::from(n));
        (0..n).map(|k| centre + x * at(k).1 + y * at(k).0).collect()
    };
    for count in [3_u8, 5, 7, 8] {
        let outline = around(count.into());
        lights.push(ExampleLight { count, given: outline.clone(), outline, size: 0.0 });
    }
    lights.push(ExampleLight { count: 0, given: vec![centre, x, y], outline: around(512), size: 0.0 });
    lights
}

/// The words of the uniform of `ltc_example`.
pub(super) fn case_words(case: &Case, light: &ExampleLight, two_sided: bool) -> [f32; 40] {
    let mut words = [0.0; 40];
    words[..3].copy_from_slice(&case.wo.map(|x| x as f32));
    words[3] = case.alpha_x as f32;
    let two_sided = f32::from(u8::from(two_sided));
    words[4..8].copy_from_slice(&[case.alpha_y as f32, light.count.into(), two_sided, light.size as f32]);
    for (place, vertex) in words[8..].chunks_exact_mut(4).zip(&light.given) {
        place[..3].copy_from_slice(&vertex.as_vec3().to_array());
    }
    words
}

/// Runs the file of `ltcforge shader` on the GPU: `M`, the terms, and the part that each kind of light covers.
#[test]
fn the_exported_shader_agrees_with_f64() {
    let mut covered_somewhere = 0;
    for &layout in Layout::ALL {
        let table = golden_table(layout);
        let wgsl = String::from_utf8(port(Language::Wgsl, layout).expect("WGSL")).expect("UTF-8");
        let mut lights = example_lights();
        lights.extend(round_lights());
        let tried: Vec<_> = CASES
            .iter()
            .flat_map(|case| lights.iter().flat_map(move |l| [false, true].map(|two| (case, l, two))))
            .collect();
        let words: Vec<[f32; 40]> =
            tried.iter().map(|(case, light, two_sided)| case_words(case, light, *two_sided)).collect();
        let shader = ShaderTable::new(&table, TexelFormat::F32);
        // A result has the columns of M, then the terms and the covered parts.
        let found: Vec<[f32; 16]> = match example::run(&wgsl, "ltc_example", Some((&shader, Bound::Volumes)), &words) {
            Ok(found) => found,
            Err(GpuFailure::Absent(reason)) => return report_skipped(&reason),
            Err(error) => panic!("{error}"),
        };
        for ((case, light, two_sided), found) in tried.into_iter().zip(found) {
            let Golden { matrix, amplitude, fresnel, .. } = case.golden(layout);
            let sides = if two_sided { Sides::Two } else { Sides::One };
            let ltc = Ltc::new(from_row_major(&matrix)).expect("a regular matrix");
            let covered = light.covered(&CosineSpace::from(&ltc), sides);
            let what = format!("{layout:?} {case:?} {} vertices, {two_sided}", light.count);
            for (row, column) in (0..9).map(|k| (k / 3, k % 3)) {
                let (found, expected) = (f64::from(found[4 * column + row]), matrix[3 * row + column]);
                assert!((found - expected).abs() < TOLERANCE, "{what}: m{row}{column} is {found}, not {expected}");
            }
            for (found, expected) in found[12..15].iter().zip([amplitude, fresnel, covered]) {
                assert!((f64::from(*found) - expected).abs() < TOLERANCE, "{what}: {found}, not {expected}");
            }
            covered_somewhere += usize::from(covered > 0.05);
        }
    }
    assert!(covered_somewhere > 30, "{covered_somewhere}");
}

/// The constant for cheaper polygons, disks and spheres does not change tubes and lines.
#[test]
fn the_cheap_horizon_does_not_change_tubes_and_lines() {
    let table = golden_table(Layout::Reflected);
    let wgsl = String::from_utf8(port(Language::Wgsl, Layout::Reflected).expect("WGSL")).expect("UTF-8");
    let cheap = wgsl.replace("LTC_CHEAP_HORIZON: bool = false", "LTC_CHEAP_HORIZON: bool = true");
    assert_ne!(cheap, wgsl);
    let lights = round_lights();
    let long: Vec<_> = lights.iter().filter(|light| light.count != 1).collect();
    let tried: Vec<_> = CASES.iter().flat_map(|case| long.iter().map(move |light| (case, *light))).collect();
    let words: Vec<[f32; 40]> = tried.iter().map(|(case, light)| case_words(case, light, false)).collect();
    let shader = ShaderTable::new(&table, TexelFormat::F32);
    let found: Vec<[f32; 16]> = match example::run(&cheap, "ltc_example", Some((&shader, Bound::Volumes)), &words) {
        Ok(found) => found,
        Err(GpuFailure::Absent(reason)) => return report_skipped(&reason),
        Err(error) => panic!("{error}"),
    };
    let mut lit = 0.0;
    for ((case, light), found) in tried.into_iter().zip(found) {
        let ltc = Ltc::new(from_row_major(&case.golden(Layout::Reflected).matrix)).expect("a regular matrix");
        let covered = light.covered(&CosineSpace::from(&ltc), Sides::One);
        assert!((f64::from(found[14]) - covered).abs() < TOLERANCE, "{case:?}: {} {covered}", found[14]);
        lit += covered;
    }
    assert!(lit > 0.1, "{lit}");
}

/// Runs the files without a table on the GPU: every rule and every kind of light, lit from one side and from both
/// sides.
#[test]
fn the_shader_without_a_table_agrees_with_f64() {
    let lights = example_lights();
    let mut tried = Vec::new();
    for (case, light) in CASES.iter().flat_map(|case| lights.iter().map(move |light| (case, light))) {
        tried.extend([false, true].map(|two_sided| (case, light, two_sided)));
    }
    let words: Vec<[f32; 40]> =
        tried.iter().map(|(case, light, two_sided)| case_words(case, light, *two_sided)).collect();
    for rule in NormalsRule::SHADED {
        let by_rule = lit_by(LightModel::Normals, None).by_rule(Some(rule)).expect("a rule");
        let wgsl = String::from_utf8(port(Language::Wgsl, by_rule).expect("WGSL")).expect("UTF-8");
        let found: Vec<[f32; 4]> = match example::run(&wgsl, "normals_example", None, &words) {
            Ok(found) => found,
            Err(GpuFailure::Absent(reason)) => return report_skipped(&reason),
            Err(error) => panic!("{error}"),
        };
        let mut lit = 0;
        for ((case, light, two_sided), found) in tried.iter().zip(found) {
            let sides = if *two_sided { Sides::Two } else { Sides::One };
            // The shader replaces a disk by an octagon. f64 integrates a polygon with as many edges.
            let outline: Vec<[f64; 3]> = light.outline.iter().map(DVec3::to_array).collect();
            let expected = reflected([case.alpha_x, case.alpha_y], case.wo, &outline, sides, rule);
            // The weight of the closed form depends on the edges of the outline.
            let tolerance = if light.count == 0 { 2e-2 } else { TOLERANCE };
            for (found, expected) in found.into_iter().zip(expected) {
                let what = format!("{case:?} {} vertices, {two_sided}, {rule}", light.count);
                assert!((f64::from(found) - expected).abs() < tolerance, "{what}: {found}, not {expected}");
            }
            lit += usize::from(expected[0] > 0.05);
        }
        assert!(lit > 10, "{lit}");
    }
}

/// A light for spherical Gaussians.
pub(super) fn sg_light() -> ExampleLight {
    let SgLight { axis, sharpness, amplitude } = SG_LIGHT;
    let given = vec![axis.into(), DVec3::new(sharpness, amplitude, 0.0)];
    ExampleLight { count: 1, given, outline: Vec::new(), size: 0.0 }
}

/// Runs the file for light by a Gaussian on the GPU: both Gaussians and every kind of light, lit from one side and from
/// both sides.
#[test]
fn the_shader_of_a_gaussian_agrees_with_f64() {
    let wgsl = port(Language::Wgsl, lit_by(LightModel::Asg, None)).expect("WGSL");
    let wgsl = String::from_utf8(wgsl).expect("UTF-8");
    let mut lights = example_lights();
    lights.push(sg_light());
    let mut tried = Vec::new();
    for (case, light) in CASES.iter().flat_map(|case| lights.iter().map(move |light| (case, light))) {
        for two_sided in [false, true] {
            tried.extend(Gaussian::ALL.iter().map(|gaussian| (case, light, two_sided, *gaussian)));
        }
    }
    let words: Vec<[f32; 40]> = tried
        .iter()
        .map(|(case, light, two_sided, gaussian)| {
            let mut words = case_words(case, light, *two_sided);
            words[7] = f32::from(*gaussian as u8);
            words
        })
        .collect();
    let found: Vec<[f32; 4]> = match example::run(&wgsl, "gaussians_example", None, &words) {
        Ok(found) => found,
        Err(GpuFailure::Absent(reason)) => return report_skipped(&reason),
        Err(error) => panic!("{error}"),
    };
    let mut lit = 0;
    for ((case, light, two_sided, gaussian), found) in tried.into_iter().zip(found) {
        let sides = if two_sided { Sides::Two } else { Sides::One };
        let alpha = [case.alpha_x, case.alpha_y];
        let outline: Vec<[f64; 3]> = light.outline.iter().map(DVec3::to_array).collect();
        let expected = match light.count {
            1 => gaussians::reflected_sg(gaussian, alpha, case.wo, &SG_LIGHT),
            _ => gaussians::reflected(gaussian, alpha, case.wo, &outline, sides),
        };
        // The points of the quadrature depend on the edges of the outline.
        let tolerance = if light.count == 0 { 4e-2 } else { TOLERANCE };
        for (found, expected) in found.into_iter().zip(expected) {
            let what = format!("{case:?} {} vertices, {two_sided}, {gaussian}", light.count);
            assert!((f64::from(found) - expected).abs() < tolerance, "{what}: {found}, not {expected}");
        }
        lit += usize::from(expected[0] > 0.05);
    }
    assert!(lit > 30, "{lit}");
}

/// The result of the shader does not change if the scene is mirrored or its corners are reordered, and it agrees with
/// f64.
#[test]
fn the_shader_of_a_gaussian_lights_equivalent_scenes_equally() {
    let wgsl = port(Language::Wgsl, lit_by(LightModel::Asg, None)).expect("WGSL");
    let wgsl = String::from_utf8(wgsl).expect("UTF-8");
    let mut draw = Draw::new(7);
    let scenes: Vec<Lit> = (0..12)
        .map(|k| draw.lit_by(Roughness::Anisotropic, if k % 2 == 0 { [0.05, 1.2] } else { [1.0, 8.0] }))
        .collect();
    for gaussian in Gaussian::ALL {
        // Only every seventh variant runs, because each needs a submission. Seven and eight have no common factor, so
        // all eight orders occur.
        let variants: Vec<(usize, Lit)> = scenes
            .iter()
            .enumerate()
            .flat_map(|(k, scene)| scene.variants().step_by(7).map(move |lit| (k, lit)))
            .collect();
        let words: Vec<[f32; 40]> = variants
            .iter()
            .map(|(_, lit)| {
                let [alpha_x, alpha_y] = lit.alpha();
                let given = lit.vertices.clone();
                let light = ExampleLight { count: 4, given, outline: Vec::new(), size: 0.0 };
                let mut words = case_words(&Case { alpha_x, alpha_y, wo: lit.wo().to_array() }, &light, true);
                words[7] = f32::from(*gaussian as u8);
                words
            })
            .collect();
        let found: Vec<[f32; 4]> = match example::run(&wgsl, "gaussians_example", None, &words) {
            Ok(found) => found,
            Err(GpuFailure::Absent(reason)) => return report_skipped(&reason),
            Err(error) => panic!("{error}"),
        };
        let mut lit = 0;
        for ((scene, variant), [energy, ..]) in variants.iter().zip(found) {
            let outline: Vec<[f64; 3]> = scenes[*scene].vertices.iter().map(DVec3::to_array).collect();
            let wo = scenes[*scene].wo().to_array();
            let [wanted, _] = gaussians::reflected(*gaussian, scenes[*scene].alpha(), wo, &outline, Sides::Two);
            assert!((f64::from(energy) - wanted).abs() < 1e-4, "{gaussian} {variant:?}: {energy}, not {wanted}");
            lit += usize::from(energy > 0.1);
        }
        assert!(lit > 40, "{lit}");
    }
}

/// Runs the file for light by a table of Gaussians, on the GPU and by its twin on the CPU.
#[test]
fn the_shader_of_a_table_of_gaussians_agrees_with_f64() {
    let layout = Layout::Reflected;
    let table = ShaderTable::new(&golden_table(layout), TexelFormat::F32);
    let wgsl = port(Language::Wgsl, lit_by(LightModel::Asg, Some(layout))).expect("WGSL");
    let wgsl = String::from_utf8(wgsl).expect("UTF-8");
    let corners = CORNERS.map(DVec3::from_array);
    let lights = [ExampleLight { count: 4, given: corners.into(), outline: corners.into(), size: 0.0 }, sg_light()];
    let mut tried = Vec::new();
    for (case, light) in CASES.iter().flat_map(|case| lights.iter().map(move |light| (case, light))) {
        tried.extend(Gaussian::ALL.iter().map(|gaussian| (case, light, *gaussian)));
    }
    let words: Vec<[f32; 40]> = tried
        .iter()
        .map(|(case, light, gaussian)| {
            let mut words = case_words(case, light, false);
            words[7] = f32::from(*gaussian as u8);
            words
        })
        .collect();
    let near = |found: [f32; 2], (case, light, gaussian): &(&Case, &ExampleLight, Gaussian), what: &str| {
        let expected = if light.count == 1 {
            let (shape, parts) = case.gaussian(layout, *gaussian);
            gaussians::reflected_sg_by(&shape, parts, &SG_LIGHT)
        } else {
            case.lit_by_gaussian(layout, *gaussian)
        };
        for (found, expected) in found.into_iter().zip(expected) {
            let off = (f64::from(found) - expected).abs();
            assert!(off < TOLERANCE, "{what} {case:?} {} {gaussian}: {found}, not {expected}", light.count);
        }
        assert!(expected[0] > 0.01, "{case:?} {} {gaussian}: {expected:?}", light.count);
    };
    for lit @ (Case { alpha_x, alpha_y, wo }, light, gaussian) in &tried {
        if light.count == 4 {
            let wo = Vec3::from_array(wo.map(|x| x as f32));
            let outline = CORNERS.map(|corner| corner.map(|x| x as f32));
            near(cpu::lit_by_gaussian(&table, *gaussian, [*alpha_x as f32, *alpha_y as f32], wo, &outline), lit, "cpu");
        }
    }
    let found: Vec<[f32; 4]> =
        match example::run(&wgsl, "gaussians_table_example", Some((&table, Bound::Volumes)), &words) {
            Ok(found) => found,
            Err(GpuFailure::Absent(reason)) => return report_skipped(&reason),
            Err(error) => panic!("{error}"),
        };
    for (lit, [energy, fresnel, ..]) in tried.iter().zip(found) {
        near([energy, fresnel], lit, "gpu");
    }
}
