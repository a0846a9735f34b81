//! Pictures on lights on the GPU, for thousands of random lights, against f64.

use glam::{DMat3, DVec3};

use super::tell_skipped;
use crate::preview::gpu::{GpuFailure, tests::pictures};
use ltcforge_fit::{Layout, Ltc, Sides};
use ltcforge_light::{
    CosineSpace, LightModel,
    cases::{Draw, Lit, Roughness},
    normals::NormalsRule,
    textured::{LightImage, LightPyramid, Reading as OfPicture, Readings, colour, ltc_readings, normals_readings},
};
use ltcforge_shaders::{Additions, Lights, LitBy, Reading, functions};

/// The rows of the inverse of an LTC's matrix stand in the first corners' fourth numbers.
const CASE: &str = "
struct Case {
    wo: vec3<f32>,
    alpha_x: f32,
    alpha_y: f32,
    corners: array<vec4<f32>, 4>,
    inverse: array<vec4<f32>, 3>,
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
    let rows = mat3x3(given.inverse[0].xyz, given.inverse[1].xyz, given.inverse[2].xyz);
    let corners = array(given.corners[0].xyz, given.corners[1].xyz, given.corners[2].xyz, given.corners[3].xyz);
    let textured = ltc_textured_rectangle(LtcInverse(transpose(rows), 1.0), corners, true, 0u, 5.0);
    found[index] = vec4(textured.colour, textured.covered);
}
";

/// A dot, a checkerboard and a ramp of 64 x 64 texels.
fn picture() -> LightPyramid {
    let texel = |i: usize| {
        let [x, y] = [i % 64, i / 64];
        let dot = f32::from((x as f32 - 40.0).hypot(y as f32 - 24.0) < 6.0);
        [dot, f32::from((x / 8 + y / 8).is_multiple_of(2)), x as f32 / 63.0]
    };
    LightPyramid::new(&LightImage::new(64, 64, (0..64 * 64).map(texel).collect()).expect("an image"))
}

/// A light, its numbers in 32 bits, and an LTC around the reflected view.
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
        let rows = ltc.inverse().transpose();
        for (i, row) in [rows.x_axis, rows.y_axis, rows.z_axis].into_iter().enumerate() {
            put(24 + 4 * i, row.to_array());
        }
        Self { words, alpha, wo: wo.normalize().to_array(), corners: corners.map(|v| v.to_array()), ltc }
    }
}

#[test]
fn the_shaders_read_pictures_as_f64_does() {
    let mut draw = Draw::new(4410);
    let lights: Vec<Single> = (0..32 * 64).map(|_| Single::of(&draw.lit_by(Roughness::All, [0.05, 1.2]))).collect();
    let normals = LitBy::new(LightModel::Normals, None).expect("a model");
    for number in Readings::ALL {
        for rule in NormalsRule::SHADED {
            let of = |light: &Single| {
                let Single { alpha, wo, corners, .. } = light;
                let ([energy, _], readings) = normals_readings(*alpha, *wo, corners, Sides::Two, (rule, *number));
                (readings, energy)
            };
            check((normals.by_rule(Some(rule)).expect("a rule"), 0, NORMALS), *number, &lights, of);
        }
        let of = |light: &Single| {
            let readings = ltc_readings(&CosineSpace::from(&light.ltc), &light.corners, *number);
            (readings, light.ltc.polygon(&light.corners.map(DVec3::from_array), Sides::Two))
        };
        check((LitBy::from(Layout::Reflected), 5, LTC), *number, &lights, of);
    }
}

/// Compares colours and parts of lights with f64: 99 of 100 colours are within two thousandths, since samplers of GPUs weigh
/// texels by 8 bits, 999 of 1000 within a hundredth.
fn check(
    (lit_by, first, entry): (LitBy, u32, &str),
    number: Readings,
    lights: &[Single],
    of: impl Fn(&Single) -> (Vec<OfPicture<f64>>, f64),
) {
    let lit_by = lit_by.with(Additions { textured: Some(number), ..Additions::default() }).expect("pictures");
    let source = functions(lit_by, Reading::default(), Lights::All) + CASE + entry;
    let picture = picture();
    let words: Vec<[f32; 36]> = lights.iter().map(|light| light.words).collect();
    let (groups, rest) = words.as_chunks::<64>();
    assert!(rest.is_empty(), "the shader takes 64 at a time");
    let found = match pictures::run::<_, [[f32; 4]; 64]>(&source, "pictures", (&picture, first), groups) {
        Ok(found) => found.into_flattened(),
        Err(GpuFailure::Absent(reason)) => return tell_skipped(&reason),
        Err(error) => panic!("{error}"),
    };
    let mut differences = Vec::new();
    for (light, [r, g, b, part]) in lights.iter().zip(found) {
        let (readings, energy) = of(light);
        assert!((f64::from(part) - energy).abs() < 5e-3, "{}: {part} {energy}", lit_by.name());
        if energy > 1e-4 {
            let wanted = colour(&readings, &picture);
            let off = [r, g, b].into_iter().zip(wanted).map(|(found, wanted)| (f64::from(found) - wanted).abs());
            differences.push(off.fold(0.0, f64::max));
        }
    }
    differences.sort_by(f64::total_cmp);
    let count = differences.len();
    let [usual, rare, most] = [count * 99 / 100, count * 999 / 1000, count - 1].map(|i| differences[i]);
    println!("{}: {count} colours off by {usual:.1e} (p99), {rare:.1e} (p99.9), {most:.1e}", lit_by.name());
    assert!(count > 1500 && usual < 4e-4 && rare < 4e-3, "{}: {usual} {rare} {most}", lit_by.name());
}
