//! The comment at the top of the shader without a table.

use super::{
    Language,
    golden::{CASES, CORNERS},
    header::{commented, fixed, listed},
    model_shader::{ModelShader, caller},
};
use ltcforge_fit::Sides;
use ltcforge_light::normals::{WeightRule, reflected};

/// The light in the space of normals.
pub(super) const SHADER: ModelShader = ModelShader {
    prefix: "normals",
    functions: |_| {
        &["normals_corner", "normals_edge", "normals_outline", "normals_weight", "normals_fan", "normals_light"]
    },
    example: "normals_example",
    caller: |_| caller("let view = normals_view(0.5, 0.5, vec3(0.0, 0.0, 1.0));", CALLS),
    program_comment: |language, _| normals_header(language),
    include_comment: |_, _, _, _, _| normals_include_header(),
};

const CALLS: &str = "    let disk = normals_disk(view, vertices[0], vertices[1], vertices[2], true, 0u);
    return vec4(normals_rectangle(view, corners, true, 0u) + normals_polygon(view, &vertices, 4u, true, 0u), disk);
";

/// The opening comment: what the shader is, and its licence.
const ABOUT: &str = "\
Area lights on anisotropic GGX in closed form, in the space of its normals: no table.
Made by ltcforge {version}. SPDX-License-Identifier: MIT OR Apache-2.0

FUNCTIONS
  normals_view(alpha_x, alpha_y, wo)  a surface seen from a direction, for all lights at the point. GGX roughness along
      x and y; wo is the view direction in the tangent frame, normal +z, of unit length.
  normals_rectangle(view, corners, two_sided, rule), normals_polygon(view, vertices, count, two_sided, rule),
  normals_disk(view, centre, half_x, half_y, two_sided, rule)
      what is reflected of a light of radiance one: for a Fresnel factor of one, and the part of it that Schlick's
      (1 - cos)^5 weighs. The light's vertices are relative to the shaded point, in the tangent frame, convex, and run
      clockwise seen from the lit side; a disk's is towards half_x x half_y.
  rule  how the weight of shadowing is averaged: 0 over triangles between the mean normal and each edge; 1 at the mean
      normal, which is cheaper; 2 over twice as many triangles. Give it as a constant: compilers then drop the others.
  Light of radiance L arrives as L (f0 (x - y) + f90 y).
";

/// The program beside the functions.
const EXAMPLE: &str = "\
  normals_example calls them; it stands for your own code, and all bindings go with it.

EXAMPLE
  Case: 10 x vec4 of f32. wo and alpha_x; alpha_y, how many vertices the light has (3 to 8, or 0 for a disk), 1 if it is
  lit from both sides, else 0, and the rule; then eight vertices with 0 after each, of a disk centre, half_x and half_y.
  Result: a vec4 of f32, the two parts and 0, 0.
";

/// How the functions are used where they are included.
const USE: &str = "
USE
  normals_view once for a point and view, then one call for each light. Isotropic surfaces have alpha_x = alpha_y. Nothing
  is bound. Diffuse light is not here: it is Lambert's form factor of the light.
";

fn bindings(language: Language) -> &'static str {
    match language {
        Language::Wgsl => "  here      group 0: case 0, result 1",
        Language::Spirv => "  here      set 0: case 0, result 1",
        Language::Glsl | Language::Glsl330 | Language::GlslEs => "  here      uniform block 0, storage block 1",
        Language::Hlsl => "  here      b0 and u1 of space0",
        Language::Msl => "  here      buffers 0 and 1",
    }
}

/// The comment of the program, in lines that begin with `//`.
fn normals_header(language: Language) -> String {
    commented(&format!("{}{EXAMPLE}{}\n\n{}", about(), bindings(language), check()))
}

/// The comment of the text to include.
fn normals_include_header() -> String {
    commented(&format!("{}{USE}\n{}", about(), check()))
}

fn about() -> String {
    ABOUT.replace("{version}", env!("CARGO_PKG_VERSION"))
}

/// The values to check a port against.
fn check() -> String {
    let corners = CORNERS.map(|corner| format!("({})", listed(&corner))).join(" ");
    let values: Vec<String> = CASES
        .iter()
        .map(|case| {
            let of = |rule| reflected([case.alpha_x, case.alpha_y], case.wo, &CORNERS, Sides::One, rule).map(fixed);
            let parts = WeightRule::ALL.iter().map(|rule| of(*rule).join(" ")).collect::<Vec<_>>();
            format!(
                "  alpha_x {} alpha_y {} wo ({})\n    parts {}\n",
                case.alpha_x,
                case.alpha_y,
                listed(&case.wo),
                parts.join(" | ")
            )
        })
        .collect();
    format!(
        "CHECK\n  The parts of the one-sided rectangle {corners},\n  by rules 0 | 1 | 2. A port in 32 bits \
         comes within 0.00002 of each number.\n{}",
        values.concat()
    )
}
