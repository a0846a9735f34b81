//! Compares the closed form in the space of normals on the GPU with f64, for thousands of random lights.

use glam::Vec3;

use super::{report_skipped, shader_table};
use crate::preview::{
    TexelFormat,
    gpu::{GpuFailure, tests::example},
};
use ltcforge_fit::Sides;
use ltcforge_light::{
    LightModel,
    cases::{Draw, Lit, Roughness},
    normals::{NormalsRule, reflected},
};
use ltcforge_shaders::{Bound, Lights, LitBy, Reading, functions};

/// Integrates the light of a case: a rectangle, or another polygon.
const ENTRY: &str = "
struct Case {
    wo: vec3<f32>,
    alpha_x: f32,
    alpha_y: f32,
    count: f32,
    corners: array<vec4<f32>, 8>,
}

@group(1) @binding(0) var<uniform> given: array<Case, 256>;
@group(1) @binding(1) var<storage, read_write> found: array<vec2<f32>, 256>;

@compute @workgroup_size(256)
fn rectangles(@builtin(local_invocation_index) index: u32) {
    let given = given[index];
    let view = normals_view(given.alpha_x, given.alpha_y, given.wo);
    let corners = array(given.corners[0].xyz, given.corners[1].xyz, given.corners[2].xyz, given.corners[3].xyz);
    found[index] = normals_rectangle(view, corners, true);
}

@compute @workgroup_size(256)
fn polygons(@builtin(local_invocation_index) index: u32) {
    let given = given[index];
    let view = normals_view(given.alpha_x, given.alpha_y, given.wo);
    var corners: array<vec3<f32>, 8>;
    for (var i = 0u; i < 8u; i++) {
        corners[i] = given.corners[i].xyz;
    }
    found[index] = normals_polygon(view, &corners, u32(given.count), true);
}
";

/// Random lights, and the same number of walls: on the surface, above it, or partly below it.
pub(super) fn lights(roughness: Roughness) -> Vec<Lit> {
    let mut draw = Draw::new(91);
    let mut lights = Draw::many(92, 10 * 256, roughness);
    for _ in 0..5 * 256 {
        let (foot, tilt) = (draw.within(-0.2, 0.3), draw.within(-0.05, 0.05));
        lights.extend([draw.wall(roughness, foot, tilt), draw.wall(roughness, 0.0, 0.0)]);
    }
    lights.extend((0..2 * 256).map(|_| draw.lit_by(roughness, [50.0, 50.0])));
    lights
}

/// Replaces each rectangle by a polygon with 3 to 8 corners on the ellipse within it.
pub(super) fn rounded(lights: Vec<Lit>) -> Vec<Lit> {
    let of = |(i, lit): (usize, Lit)| {
        let [a, b, c, d] = lit.vertices[..] else { panic!("a rectangle") };
        let (middle, x, y) = ((a + b + c + d) * 0.25, (b - a) * 0.5, (d - a) * 0.5);
        let count = 3 + i % 6;
        let at = |k: usize| {
            let (sin, cos) = (std::f64::consts::TAU * (k as f64 + 0.4) / count as f64).sin_cos();
            middle + x * cos + y * sin
        };
        Lit { vertices: (0..count).map(at).collect(), ..lit }
    };
    lights.into_iter().enumerate().map(of).collect()
}

/// A light, rounded to 32 bits.
pub(super) struct Single {
    pub(super) wo: Vec3,
    pub(super) alpha: [f32; 2],
    pub(super) corners: Vec<Vec3>,
}

impl Single {
    pub(super) fn of(lit: &Lit) -> Self {
        let corners = lit.vertices.iter().map(|v| v.as_vec3()).collect();
        Self { wo: lit.wo().as_vec3(), alpha: lit.alpha().map(|x| x as f32), corners }
    }

    pub(super) fn words(&self) -> [f32; 40] {
        let mut words = [0.0; 40];
        words[..3].copy_from_slice(&self.wo.to_array());
        words[3..5].copy_from_slice(&self.alpha);
        words[5] = self.corners.len() as f32;
        for (place, corner) in words[8..].chunks_exact_mut(4).zip(&self.corners) {
            place[..3].copy_from_slice(&corner.to_array());
        }
        words
    }

    /// The result in f64, for the same numbers rounded to 32 bits.
    fn exact(&self, rule: NormalsRule) -> [f64; 2] {
        let corners: Vec<[f64; 3]> = self.corners.iter().map(|v| v.as_dvec3().to_array()).collect();
        let wo = self.wo.as_dvec3().normalize().to_array();
        reflected(self.alpha.map(f64::from), wo, &corners, Sides::Two, rule)
    }
}

#[test]
fn the_shader_agrees_with_f64_for_any_light() {
    for (roughness, limits) in
        [(Roughness::All, [2e-4, 5e-3]), (Roughness::Anisotropic, [2e-4, 5e-3]), (Roughness::Extreme, [1e-3, 5e-2])]
    {
        for rule in NormalsRule::SHADED {
            check(rule, "rectangles", &lights(roughness), limits);
            check(rule, "polygons", &rounded(lights(roughness)), limits);
        }
    }
}

/// Compares the results of an entry point with f64. 999 of 1000 numbers are within the first limit, and all are within
/// the second.
fn check(rule: NormalsRule, entry: &str, lights: &[Lit], limits: [f64; 2]) {
    let normals =
        LitBy::new(LightModel::Normals, None).and_then(|normals| normals.by_rule(Some(rule))).expect("a rule");
    let source = functions(normals, Reading::default(), Lights::All) + ENTRY;
    let table = shader_table(TexelFormat::F32);
    let lights: Vec<Single> = lights.iter().map(Single::of).collect();
    let words: Vec<[f32; 40]> = lights.iter().map(Single::words).collect();
    let (groups, rest) = words.as_chunks::<256>();
    assert!(rest.is_empty(), "the shader takes 256 at a time");
    let found = match example::run::<_, [[f32; 2]; 256]>(&source, entry, Some((&*table, Bound::Volumes)), groups) {
        Ok(found) => found.into_flattened(),
        Err(GpuFailure::Absent(reason)) => return report_skipped(&reason),
        Err(error) => panic!("{error}"),
    };
    let mut differences = Vec::new();
    for (light, found) in lights.iter().zip(found) {
        for (found, expected) in found.into_iter().zip(light.exact(rule)) {
            assert!((0.0..=1.0).contains(&found), "{found} by {rule} of {:?} {:?}", light.alpha, light.corners);
            differences.push((f64::from(found) - expected).abs());
        }
    }
    differences.sort_by(f64::total_cmp);
    let [rare, most] = [differences.len() * 999 / 1000, differences.len() - 1].map(|i| differences[i]);
    println!("{rule} {entry}: off by {rare:.1e} (p99.9), {most:.1e}");
    assert!(rare < limits[0] && most < limits[1], "{rule} {entry}: {rare} {most}");
}
