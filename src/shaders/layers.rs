//! The shader text that combines layers, for any light model.

use super::{header::commented, sources::joined, stamp::head};
use ltcforge_fit::{
    brdf::{Brdf, Fuzz},
    math::direction,
};

/// The licence. The functions for fuzz come from MaterialX, which is only under Apache-2.0.
const LICENCE: &str = "(MIT OR Apache-2.0) AND Apache-2.0";

/// The revision. It is raised when the values of the check change.
const REVISION: u32 = 1;

/// The first part of the comment: description, functions and use.
const ABOUT: &str = "\
Metals and layers under area lights, as in OpenPBR: a coat and fuzz over a base. Works with any model; no bindings.

FUNCTIONS
  layers_metal(parts, f0, tint)  reflected light of a metal by F82. parts is the result of normals_rectangle, or
      vec2(lobe.amplitude, lobe.fresnel) times the result of ltc_rectangle.
  layers_fuzz(roughness, wo)  the lobe of fuzz for one view, in the tangent frame, normal +z. Pass
      LtcInverse(inverse, 1.0) to ltc_rectangle and the other shapes. albedo is the part of all light that it reflects.
  layers_albedo(amplitude, fresnel, f0)  the albedo of a dielectric, from the terms of a table's lobe.
  layers_coated(base, coat, albedo, weight, transmittance)  the light of a base under a coat.
  layers_fuzzed(below, fuzz, albedo, weight)  the light of all layers below under fuzz.

USE
  Add up the reflected light of all lights for base, coat and fuzz separately. Then combine the three sums:
    let fuzz = layers_fuzz(fuzz_roughness, wo);
    let fuzz_light = radiance * fuzz_color * fuzz.albedo * ltc_rectangle(LtcInverse(fuzz.inverse, 1.0), corners, false);
    let albedo = layers_albedo(coat_lobe.amplitude, coat_lobe.fresnel, 0.04);
    let coated = layers_coated(base_light, coat_light, albedo, coat_weight, coat_color);
    let colour = layers_fuzzed(coated, fuzz_light, fuzz.albedo, fuzz_weight);

";

/// The cases for checking a port: roughness, and polar angle and azimuth of the view.
pub const FUZZ_CASES: [[f64; 3]; 4] = [[0.2, 1.3, 0.4], [0.5, 0.6, -2.0], [0.8, 0.0, 0.0], [1.0, 1.5, 3.0]];

/// The result of `layers_fuzz` for a case: the columns of the inverse, and the albedo.
#[must_use]
pub fn fuzz_values([roughness, theta, phi]: [f64; 3]) -> [f64; 10] {
    let (fuzz, wo) = (Fuzz::new(roughness), direction(theta, phi));
    // The last row of the matrix is that of the unit matrix, so the last row of the inverse is the same.
    let inverse = fuzz.ltc(wo).unwrap_or_default().inverse().to_cols_array();
    std::array::from_fn(|i| inverse.get(i).copied().unwrap_or_else(|| fuzz.albedo(wo.z)))
}

/// The comment at the top of the text.
#[must_use]
pub fn layers_comment() -> String {
    let case = |case: [f64; 3]| {
        let [roughness, theta, phi] = case;
        let wo = direction(theta, phi).to_array().map(|x| format!("{x:.6}")).join(", ");
        let numbers = fuzz_values(case).map(|x| format!("{:.5}", (x * 1e5).round() / 1e5 + 0.0)).join(" ");
        format!("  layers_fuzz({roughness}, ({wo}))\n      {numbers}\n")
    };
    let check = FUZZ_CASES.map(case).concat();
    commented(&format!("{}{ABOUT}CHECK\n  Columns of the inverse, and the albedo:\n{check}", head(LICENCE, REVISION)))
}

/// The functions, and a fragment shader named `ltc_included` that calls each of them.
#[must_use]
pub fn layers_source() -> String {
    let caller = "
@fragment
fn ltc_included() -> @location(0) vec4<f32> {
    let fuzz = layers_fuzz(0.5, vec3(0.0, 0.0, 1.0));
    let coated = layers_coated(fuzz.inverse[0], vec3(0.1), layers_albedo(0.9, 0.1, 0.04), 0.5, vec3(1.0));
    let metal = layers_metal(vec2(0.5, 0.1), coated, coated);
    return vec4(layers_fuzzed(metal, coated, fuzz.albedo, 0.5), 1.0);
}
";
    format!("{}{caller}", joined(&["layers"]))
}
