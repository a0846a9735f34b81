//! Compares the shader without textures on the GPU with the function that it evaluates.

use glam::DVec3;

use super::report_skipped;
use crate::preview::gpu::{GpuFailure, tests::example};
use ltcforge_fit::{Configuration, IsotropicFunction, Layout, testing::planted_isotropic};
use ltcforge_shaders::Namespace;
use ltcforge_shaders::{Additions, Language, Lights};
use ltcforge_translate::include_function;

#[test]
fn the_shader_without_textures_agrees_with_the_function() {
    const EXAMPLE: &str = "
@group(0) @binding(0) var<uniform> tried: array<vec4<f32>, 2>;
@group(0) @binding(1) var<storage, read_write> found: array<vec4<f32>, 4>;

@compute @workgroup_size(1)
fn tried_once() {
    let lobe = ltc_lookup(tried[0].w, tried[1].x, tried[0].xyz);
    found[0] = vec4(lobe.m[0], 0.0);
    found[1] = vec4(lobe.m[1], 0.0);
    found[2] = vec4(lobe.m[2], 0.0);
    found[3] = vec4(lobe.amplitude, lobe.fresnel, 0.0, 0.0);
}
";
    let function = IsotropicFunction::of(&planted_isotropic(Layout::Reflected)).expect("a function");
    let source =
        include_function(Language::Wgsl, &function, &[], Lights::All, Additions::default(), &Namespace::default())
            .expect("WGSL");
    let mut tried = Vec::new();
    // The first three values are below the least fitted alpha.
    for alpha in [0.0, 1e-5, 5e-5, 0.0002, 0.01, 0.13, 0.6, 1.0] {
        for theta in [0.0, 0.3, 1.0, 1.4, 1.56] {
            // With a view from directly above, a lobe has no azimuth.
            for phi in [0.0, 1.1, -2.5].into_iter().filter(|phi| theta > 0.0 || *phi == 0.0) {
                tried.push(Configuration { alpha_x: alpha, alpha_y: alpha, theta, phi });
            }
        }
    }
    let words: Vec<[f32; 8]> = tried
        .iter()
        .map(|at| {
            let wo = DVec3::new(at.theta.sin() * at.phi.cos(), at.theta.sin() * at.phi.sin(), at.theta.cos()).as_vec3();
            [wo.x, wo.y, wo.z, at.alpha_x as f32, at.alpha_y as f32, 0.0, 0.0, 0.0]
        })
        .collect();
    let found: Vec<[f32; 16]> = match example::run(&format!("{source}{EXAMPLE}"), "tried_once", None, &words) {
        Ok(found) => found,
        Err(GpuFailure::Absent(reason)) => return report_skipped(&reason),
        Err(error) => panic!("{error}"),
    };
    for (at, found) in tried.iter().zip(found) {
        let wanted = function.lobe(at);
        for (row, column) in (0..9).map(|k| (k / 3, k % 3)) {
            let (found, wanted) = (f64::from(found[4 * column + row]), wanted.matrix[3 * row + column]);
            assert!((found - wanted).abs() < 2e-5, "{at:?}: m{row}{column} is {found}, not {wanted}");
        }
        for (found, wanted) in [(found[12], wanted.amplitude), (found[13], wanted.fresnel)] {
            assert!((f64::from(found) - wanted.expect("a term")).abs() < 2e-5, "{at:?}: {found}, not {wanted:?}");
        }
    }
}
