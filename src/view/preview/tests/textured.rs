//! Compares pictures on lights on the GPU with f64, for thousands of random lights.

use std::ops::ControlFlow;

use glam::{DMat3, DVec3};

use super::report_skipped;
use crate::preview::gpu::{GpuFailure, tests::pictures};
use ltcforge_files::recipe_document;
use ltcforge_fit::{Layout, Ltc, Plan, Sides, fit_plan, math::from_row_major};
use ltcforge_light::{
    CosineSpace, LightModel, PolygonLight,
    cases::{Draw, Lit, Roughness},
    normals::NormalsRule,
    textured::{
        LightImage, LightPyramid, ProfileWindow, Reading as OfPicture, Readings, TexturedLight, colour, ltc_readings,
        normals_readings,
    },
};
use ltcforge_shaders::{Additions, Lights, LitBy, Reading, functions};

/// `rows` are the rows of an LTC's matrix, or of its inverse.
const CASE: &str = "
struct Case {
    wo: vec3<f32>,
    alpha_x: f32,
    alpha_y: f32,
    amplitude: f32,
    fresnel: f32,
    corners: array<vec4<f32>, 4>,
    rows: array<vec4<f32>, 3>,
}

@group(1) @binding(0) var<uniform> given: array<Case, 64>;
@group(1) @binding(1) var<storage, read_write> found: array<vec4<f32>, 64>;
";
const NORMALS: &str = "
@compute @workgroup_size(64)
fn pictures(@builtin(local_invocation_index) index: u32) {
    let given = given[index];
    let view = normals_view(given.alpha_x, given.alpha_y, given.wo);
    let corners = array(given.corners[0].xyz, given.corners[1].xyz, given.corners[2].xyz, given.corners[3].xyz);
    let textured = normals_textured_rectangle(view, corners, true, 0u, 5.0);
    found[index] = vec4(textured.colour, textured.parts.x);
}
";
const LTC: &str = "
@compute @workgroup_size(64)
fn pictures(@builtin(local_invocation_index) index: u32) {
    let given = given[index];
    let rows = mat3x3(given.rows[0].xyz, given.rows[1].xyz, given.rows[2].xyz);
    let corners = array(given.corners[0].xyz, given.corners[1].xyz, given.corners[2].xyz, given.corners[3].xyz);
    let textured = ltc_textured_rectangle(LtcInverse(transpose(rows), 1.0), corners, true, 0u, 5.0);
    found[index] = vec4(textured.colour, textured.covered);
}
";
/// The reflected light with a picture, and the same light without the picture.
const BOTH_BY_NORMALS: &str = "
@compute @workgroup_size(64)
fn pictures(@builtin(local_invocation_index) index: u32) {
    let given = given[index];
    let view = normals_view(given.alpha_x, given.alpha_y, given.wo);
    let corners = array(given.corners[0].xyz, given.corners[1].xyz, given.corners[2].xyz, given.corners[3].xyz);
    let textured = normals_textured_rectangle(view, corners, true, 0u, BASE);
    found[index] = vec4(textured.colour * textured.parts.x, normals_rectangle(view, corners, true).x);
}
";
/// The same comparison by a table, for a reflectance of 0.5 at normal incidence.
const BOTH_BY_LTC: &str = "
@compute @workgroup_size(64)
fn pictures(@builtin(local_invocation_index) index: u32) {
    let given = given[index];
    let inverse = ltc_inverse(transpose(mat3x3(given.rows[0].xyz, given.rows[1].xyz, given.rows[2].xyz)));
    let corners = array(given.corners[0].xyz, given.corners[1].xyz, given.corners[2].xyz, given.corners[3].xyz);
    let reflected = 0.5 * (given.amplitude + given.fresnel);
    let textured = ltc_textured_rectangle(inverse, corners, true, 0u, BASE);
    found[index] = reflected * vec4(textured.colour * textured.covered, ltc_rectangle(inverse, corners, true));
}
";

/// A picture with a dot, a checkerboard and a ramp. `side` is its size in texels.
fn picture(side: usize) -> LightPyramid {
    let texel = |i: usize| {
        let [u, v] = [i % side, i / side].map(|x| (64 * x) as f32 / side as f32);
        let dot = f32::from((u - 40.0).hypot(v - 24.0) < 6.0);
        [dot, f32::from((u as usize / 8 + v as usize / 8).is_multiple_of(2)), u / 63.0]
    };
    LightPyramid::new(&LightImage::new(side, side, (0..side * side).map(texel).collect()).expect("an image"))
}

/// A light, its numbers in 32 bits, and an LTC around the mirror direction of the view.
struct Single {
    words: [f32; 36],
    alpha: [f64; 2],
    wo: [f64; 3],
    corners: [[f64; 3]; 4],
    ltc: Ltc,
}

impl Single {
    fn of(lit: &Lit) -> Self {
        let single = |v: DVec3| v.as_vec3().as_dvec3();
        let wo = single(lit.wo());
        let alpha = lit.alpha().map(|x| f64::from(x as f32));
        let corners = [0, 1, 2, 3].map(|i| single(lit.vertices[i]));
        let towards = DVec3::new(-wo.x, -wo.y, wo.z);
        let matrix = DMat3::from_cols(DVec3::X * alpha[0], DVec3::Y * alpha[1], towards);
        let ltc = Ltc::new(matrix).expect("an LTC");
        let mut words = [0.0; 36];
        let mut put = |at: usize, v: [f64; 3]| words[at..at + 3].copy_from_slice(&v.map(|x| x as f32));
        put(0, wo.to_array());
        put(3, [alpha[0], alpha[1], 0.0]);
        for (i, corner) in corners.iter().enumerate() {
            put(8 + 4 * i, corner.to_array());
        }
        put_rows(&mut words, &ltc.inverse());
        Self { words, alpha, wo: wo.normalize().to_array(), corners: corners.map(|v| v.to_array()), ltc }
    }
}

/// Writes the rows of a matrix into the words of a case.
fn put_rows(words: &mut [f32; 36], matrix: &DMat3) {
    for row in 0..3 {
        words[24 + 4 * row..27 + 4 * row].copy_from_slice(&matrix.row(row).to_array().map(|x| x as f32));
    }
}

/// The result of an entry point for each light. `None` without a GPU.
fn found(source: &str, picture: (&LightPyramid, u32), words: &[[f32; 36]]) -> Option<Vec<[f32; 4]>> {
    let (groups, rest) = words.as_chunks::<64>();
    assert!(rest.is_empty(), "the shader takes 64 at a time");
    match pictures::run::<_, [[f32; 4]; 64]>(source, "pictures", picture, groups) {
        Ok(found) => Some(found.into_flattened()),
        Err(GpuFailure::Absent(reason)) => {
            report_skipped(&reason);
            None
        }
        Err(error) => panic!("{error}"),
    }
}

/// A shader that supports pictures on lights.
fn textured(lit_by: LitBy, number: Readings) -> String {
    let lit_by = lit_by.with(Additions { textured: Some(number), ..Additions::default() }).expect("pictures");
    functions(lit_by, Reading::default(), Lights::All) + CASE
}

#[test]
fn the_shaders_read_pictures_like_f64() {
    let mut draw = Draw::new(4410);
    let lights: Vec<Single> = (0..32 * 64).map(|_| Single::of(&draw.lit_by(Roughness::All, [0.05, 1.2]))).collect();
    let normals = LitBy::new(LightModel::Normals, None).expect("a model");
    let picture = picture(64);
    for number in Readings::ALL {
        for rule in NormalsRule::SHADED {
            let expected = |light: &Single| {
                let Single { alpha, wo, corners, .. } = light;
                let ([energy, _], readings) = normals_readings(*alpha, *wo, corners, Sides::Two, (rule, *number));
                (readings, energy)
            };
            let text = (normals.by_rule(Some(rule)).expect("a rule"), 0, NORMALS);
            check(text, *number, &picture, &lights, expected);
        }
        let expected = |light: &Single| {
            let readings = ltc_readings(&CosineSpace::from(&light.ltc), &light.corners, *number);
            (readings, light.ltc.polygon(&light.corners.map(DVec3::from_array), Sides::Two))
        };
        check((LitBy::from(Layout::Reflected), 5, LTC), *number, &picture, &lights, expected);
    }
}

/// Lamps with a profile of 512 x 512 texels. Each shader has a second function for them.
#[test]
fn the_shaders_read_profiles_like_f64() {
    let mut draw = Draw::new(4414);
    let lights: Vec<Single> = (0..32 * 64).map(|_| Single::of(&draw.lit_by(Roughness::All, [0.05, 1.2]))).collect();
    let profile = picture(512);
    let of_lamp = |light: &Single, readings: Vec<OfPicture<f64>>| {
        let corners = light.corners.map(DVec3::from_array).to_vec();
        let lamp = PolygonLight::new(corners, Sides::Two).and_then(TexturedLight::new).expect("a rectangle");
        let window = ProfileWindow::new(&lamp);
        readings.iter().map(|reading| window.of_profile(reading)).collect()
    };
    let of_lamps = |entry: &str| {
        let entry = entry.replace("_textured_rectangle", "_profile_rectangle").replace(", 0u, 5.0)", ", 0u)");
        assert!(entry.contains("_profile_rectangle") && entry.contains(", 0u)"));
        entry
    };
    for rule in NormalsRule::SHADED {
        let normals = LitBy::new(LightModel::Normals, None).and_then(|lit_by| lit_by.by_rule(Some(rule)));
        let expected = |light: &Single| {
            let how = (rule, Readings::Four);
            let ([energy, _], readings) = normals_readings(light.alpha, light.wo, &light.corners, Sides::Two, how);
            (of_lamp(light, readings), energy)
        };
        check((normals.expect("a rule"), 0, &of_lamps(NORMALS)), Readings::Four, &profile, &lights, expected);
    }
    let expected = |light: &Single| {
        let readings = ltc_readings(&CosineSpace::from(&light.ltc), &light.corners, Readings::Four);
        (of_lamp(light, readings), light.ltc.polygon(&light.corners.map(DVec3::from_array), Sides::Two))
    };
    check((LitBy::from(Layout::Reflected), 5, &of_lamps(LTC)), Readings::Four, &profile, &lights, expected);
}

/// Compares colours and energies with f64. 99 of 100 colours are within 0.001, and 999 of 1000 within 0.004. The limits
/// allow for the 8-bit weights of GPU samplers.
fn check(
    (lit_by, first, entry): (LitBy, u32, &str),
    number: Readings,
    picture: &LightPyramid,
    lights: &[Single],
    expected: impl Fn(&Single) -> (Vec<OfPicture<f64>>, f64),
) {
    let words: Vec<[f32; 36]> = lights.iter().map(|light| light.words).collect();
    let Some(found) = found(&(textured(lit_by, number) + entry), (picture, first), &words) else { return };
    let mut differences = Vec::new();
    for (light, [r, g, b, part]) in lights.iter().zip(found) {
        let (readings, energy) = expected(light);
        assert!((f64::from(part) - energy).abs() < 5e-3, "{}: {part} {energy}", lit_by.name());
        if energy > 1e-4 {
            let wanted = colour(&readings, picture);
            let off = [r, g, b].into_iter().zip(wanted).map(|(found, wanted)| (f64::from(found) - wanted).abs());
            differences.push(off.fold(0.0, f64::max));
        }
    }
    differences.sort_by(f64::total_cmp);
    let count = differences.len();
    let [usual, rare, most] = [count * 99 / 100, count * 999 / 1000, count - 1].map(|i| differences[i]);
    println!("{}: {count} colours off by {usual:.1e} (p99), {rare:.1e} (p99.9), {most:.1e}", lit_by.name());
    assert!(count > 1500 && usual < 1e-3 && rare < 4e-3, "{}: {usual} {rare} {most}", lit_by.name());
}

/// A light with a picture of one colour, of any size, lights like a light without a picture: by `normals` and by a
/// fitted table.
#[test]
fn a_picture_of_one_colour_lights_like_no_picture() {
    const COLOUR: [f32; 3] = [0.3, 1.1, 3.7];
    let recipe = recipe_document::parse(br#"{"preset": "draft"}"#, u64::MAX).expect("a recipe");
    let table = fit_plan(&Plan::new(&recipe), &|_| ControlFlow::Continue(())).expect("nothing stops it");
    let mut draw = Draw::new(4412);
    let by_table = |lit: &Lit| {
        let found = table.lookup(&lit.at);
        let mut words = Single::of(lit).words;
        put_rows(&mut words, &from_row_major(&found.matrix));
        [words[5], words[6]] = [found.amplitude, found.fresnel].map(|term| term.expect("a term") as f32);
        words
    };
    let words: Vec<[f32; 36]> = (0..16 * 64).map(|_| by_table(&draw.lit_by(Roughness::All, [0.05, 1.2]))).collect();
    let normals = LitBy::new(LightModel::Normals, None).expect("a model");
    let by_rule = |rule| (normals.by_rule(Some(rule)).expect("a rule"), 0, BOTH_BY_NORMALS);
    for (lit_by, first, entry) in
        NormalsRule::SHADED.map(by_rule).into_iter().chain([(LitBy::from(table.layout), 5, BOTH_BY_LTC)])
    {
        for [width, height] in [[1, 1], [37, 5], [64, 64], [512, 1]] {
            let image = LightImage::new(width, height, vec![COLOUR; width * height]).expect("an image");
            let base = format!("\nconst BASE: f32 = {:?};\n", 0.5 * ((width * height) as f64).log2() - 1.0);
            let source = textured(lit_by, Readings::Four) + &base + entry;
            let Some(found) = found(&source, (&LightPyramid::new(&image), first), &words) else { return };
            let mut lit = 0;
            let mut most = 0.0_f32;
            for [r, g, b, plain] in found {
                lit += u32::from(plain > 0.01);
                for (channel, colour) in [r, g, b].into_iter().zip(COLOUR) {
                    most = most.max((channel / colour - plain).abs());
                }
            }
            println!("{}, {width} x {height}: {lit} lights off by {most:.1e}", lit_by.name());
            assert!(lit > 500 && most < 1e-4, "{}, {width} x {height}: {lit} {most}", lit_by.name());
        }
    }
}

/// The shader returns finite values for matrices that no fit produces: nearly of rank one or two, and of any scale,
/// with small and large lights at all distances.
#[test]
fn the_shaders_return_finite_values_for_degenerate_matrices() {
    let mut draw = Draw::new(4413);
    let case = |i: usize| {
        let mut words = Single::of(&draw.lit_by(Roughness::All, [0.001, 20.0])).words;
        let [a, b, c] = [0; 3].map(|_| draw.vector());
        let little = 10_f64.powf(draw.within(-12.0, 0.0));
        let matrix = match i % 4 {
            0 => DMat3::from_cols(a, b, draw.within(-1.0, 1.0) * a + b + little * c),
            1 => DMat3::from_cols(a, a + little * b, draw.within(-1.0, 1.0) * a + little * c),
            2 => DMat3::from_cols(a, b * little, c),
            _ => DMat3::from_cols(a, b, c * little),
        };
        put_rows(&mut words, &(matrix * 10_f64.powf(draw.within(-8.0, 8.0))));
        let far = 10_f64.powf(draw.within(-6.0, 6.0)) as f32;
        words[8..24].iter_mut().for_each(|x| *x *= far);
        [words[5], words[6]] = [1.0, 1.0];
        words
    };
    let words: Vec<[f32; 36]> = (0..64 * 64).map(case).collect();
    let source = textured(LitBy::from(Layout::Reflected), Readings::Four) + "const BASE: f32 = 5.0;" + BOTH_BY_LTC;
    let Some(found) = found(&source, (&picture(64), 5), &words) else { return };
    let lit = found.iter().filter(|found| found[3] > 0.0).count();
    let wrong: Vec<_> =
        words.iter().zip(&found).filter(|(_, found)| !found.iter().all(|x| (-1e-6..=1.00001).contains(x))).collect();
    println!("{} of {} are not finite; {lit} are lit", wrong.len(), words.len());
    assert!(wrong.is_empty() && lit > 1000, "{lit}, {}: {:?}", wrong.len(), wrong.first());
}
