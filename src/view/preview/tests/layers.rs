//! Compares the functions for layers on the GPU with f64.

use super::report_skipped;
use crate::preview::gpu::{GpuFailure, tests::example};
use ltcforge_fit::{brdf::edge_of_parts, math::direction};
use ltcforge_light::{
    ReflectedLight,
    layers::{coated, fuzzed},
};
use ltcforge_shaders::{FUZZ_CASES, fuzz_values, joined};

/// A program that calls the functions for one case: roughness and view direction, then five numbers for the layers.
const PROGRAM: &str = "
@group(0) @binding(0) var<uniform> layers_case: mat4x4<f32>;
@group(0) @binding(1) var<storage, read_write> layers_result: mat4x4<f32>;

@compute @workgroup_size(1)
fn layers_example() {
    let fuzz = layers_fuzz(layers_case[0].w, layers_case[0].xyz);
    let part = layers_case[1];
    let weight = layers_case[2].x;
    let coat = layers_coated(vec3(part.x), vec3(part.y), part.z, weight, vec3(part.w));
    let all = layers_fuzzed(coat, vec3(part.y), part.z, weight);
    layers_result = mat4x4<f32>(vec4(fuzz.inverse[0], fuzz.albedo), vec4(fuzz.inverse[1], coat.x),
        vec4(fuzz.inverse[2], all.x), vec4(layers_albedo(part.x, part.y, part.z), layers_metal(part.xy, vec3(part.z), vec3(part.w)).x, 0.0, 0.0));
}
";

#[test]
fn the_shader_of_layers_agrees_with_its_twin() {
    // F82 of the third metal is negative.
    let layers = [[0.6, 0.2, 0.3, 0.8], [0.9, 0.7, 0.9, 0.1], [0.9, 0.2, 0.0, 0.0], [0.4, 0.3, 0.5, 0.5]];
    let cases: Vec<[f32; 16]> = FUZZ_CASES
        .iter()
        .zip(layers)
        .map(|([roughness, theta, phi], of)| {
            let wo = direction(*theta, *phi);
            let numbers = [wo.x, wo.y, wo.z, *roughness, of[0], of[1], of[2], of[3], 0.5 * (of[0] + of[3])];
            std::array::from_fn(|i| numbers.get(i).map_or(0.0, |x| *x as f32))
        })
        .collect();
    let source = joined(&["layers"]) + PROGRAM;
    let found: Vec<[f32; 16]> = match example::run(&source, "layers_example", None, &cases) {
        Ok(found) => found,
        Err(GpuFailure::Absent(reason)) => return report_skipped(&reason),
        Err(error) => panic!("{error}"),
    };
    assert_eq!(found.len(), cases.len());
    for ((case, of), found) in FUZZ_CASES.into_iter().zip(layers).zip(found) {
        let [a0, a1, a2, b0, b1, b2, c0, c1, c2, albedo] = fuzz_values(case);
        let [base, coat, part, transmittance] = of;
        let weight = 0.5 * (base + transmittance);
        let below = coated(base, coat, part, weight, transmittance);
        let all = fuzzed(below, coat, part, weight);
        let of_terms = part * (base - coat) + coat;
        let light = ReflectedLight { energy: base, fresnel: coat };
        let metal = light.metal(edge_of_parts([base, coat]), [part, 1.0], transmittance);
        let wanted = [a0, a1, a2, albedo, b0, b1, b2, below, c0, c1, c2, all, of_terms, metal];
        for (i, (found, wanted)) in found.into_iter().zip(wanted).enumerate() {
            assert!((f64::from(found) - wanted).abs() < 1e-5, "{case:?} {i}: {found}, not {wanted}");
        }
    }
}
