//! The comment at the top of the shader for model `ltc-formula`.

use super::{
    Lights,
    gaussians_header::bindings,
    golden::{CASES, CORNERS, listed},
    header::{commented, fixed, functions_of, lights_called},
    model_shader::{ModelShader, caller},
    stamp::{LICENCE, head},
};
use ltcforge_fit::Sides;
use ltcforge_light::ltc::FormulaLobe;

/// The shader for light by an LTC without a table.
pub(super) const SHADER: ModelShader = ModelShader {
    prefix: "ltc",
    functions: |lights| match lights {
        Lights::All => &["ltc_math", "ltc_rectangle", "ltc_light", "ltc_shapes", "ltc_formula"],
        Lights::Polygons => &["ltc_rectangle", "ltc_light", "ltc_formula"],
        Lights::Rectangles => &["ltc_rectangle", "ltc_formula"],
    },
    example: "ltc_formula_example",
    caller: |_, lights| {
        let lobe = "let lobe = ltc_formula(0.5, 0.5, vec3(0.0, 0.0, 1.0), 0.04, 1.0);\n    let inverse = lobe.inverse;";
        caller(lobe, &lights_called(lights))
    },
    program_comment: |language, _| {
        commented(&format!("{}{EXAMPLE}{}\n\n{}", about(Lights::All), bindings(language), check()))
    },
    include_comment: |_, _, _, lights, _| commented(&format!("{}{USE}\n{}", about(lights), check())),
};

/// The revision. It is raised when the values of the check change.
const REVISION: u32 = 1;

/// The first part of the comment: description and functions.
const ABOUT: &str = "\
Linearly Transformed Cosines: area lights on anisotropic GGX, by a formula, without a table.

FUNCTIONS
  ltc_formula(alpha_x, alpha_y, wo, f0, f90)  inverse, amplitude and fresnel of a material with this reflectance at
      normal and grazing incidence; 1.0, 1.0 for metals. GGX roughness along x and y is above 0. wo is the view
      direction in the tangent frame, normal +z, of unit length.
{lights}";

/// How to use the functions of the shader text.
const USE: &str = "
USE
  Call ltc_formula once for a point and view, then a function for each light.
";

/// The description of the example program.
const EXAMPLE: &str = "\
  ltc_formula_example calls them. Replace it with your own code, and delete all bindings.

EXAMPLE
  Case: 10 x vec4 of f32. First wo and alpha_x. Second alpha_y; shape of the light (3 to 8 for a polygon of so many
  vertices, 0 disk, 1 sphere, 2 tube, 9 line); 1 if both sides emit, else 0; radius or width. Then eight vertices, each
  followed by a number: f0 after the first, else 0. For a disk: centre, half_x, half_y. For a sphere: its centre. For a
  tube or line: both ends. f90 is 1.
  Result: a vec4 of f32, the two parts and 0, 0.
";

fn about(lights: Lights) -> String {
    // The first function inverts the matrix of a table.
    let functions = functions_of(lights).split_once('\n').map_or("", |(_, others)| others);
    head(LICENCE, REVISION) + &ABOUT.replace("{lights}", functions)
}

/// The values to check a port against.
fn check() -> String {
    let corners = CORNERS.map(|corner| format!("({})", listed(&corner))).join(" ");
    let values: Vec<String> = CASES
        .iter()
        .map(|case| {
            let of = |f0| {
                let lobe = FormulaLobe::new([case.alpha_x, case.alpha_y], case.wo, [f0, 1.0]);
                let [amplitude, fresnel] = lobe.parts.map(fixed);
                format!("{amplitude} {fresnel} {}", fixed(lobe.space.polygon(&CORNERS, Sides::One)))
            };
            format!("  {}\n    {} | {}\n", case.named(), of(1.0), of(0.04))
        })
        .collect();
    format!(
        "CHECK\n  amplitude, fresnel and covered by f0 = 1 | f0 = 0.04, f90 = 1, for the one-sided rectangle\n  \
         {corners}.\n  A port in 32 bits comes within 0.00002 of each number.\n{}",
        values.concat()
    )
}
