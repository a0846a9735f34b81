//! The comment at the top of the shader for light by a Gaussian without a table.

use super::{
    Language,
    golden::{CASES, CORNERS, listed},
    header::{commented, fixed},
    model_shader::{ModelShader, caller},
    stamp::{LICENCE, head},
};
use ltcforge_fit::Sides;
use ltcforge_light::gaussians::{Gaussian, SgLight, reflected, reflected_sg};

/// The shader for light by a Gaussian.
pub(super) const SHADER: ModelShader = ModelShader {
    prefix: "gaussians",
    functions: |_| &["ltc_math", "gaussians_light"],
    example: "gaussians_example",
    caller: |_, _| gaussians_caller("gaussians_view"),
    program_comment: |language, _| gaussians_header(language),
    include_comment: |_, _, _, _, _| gaussians_include_header(),
};

/// The fragment shader that calls every function. `view` is the name of the function that returns the view.
pub(super) fn gaussians_caller(view: &str) -> String {
    caller(&format!("let view = {view}(1u, 0.5, 0.5, vec3(0.0, 0.0, 1.0));"), CALLS)
}

const CALLS: &str = "    let disk = gaussians_disk(view, vertices[0], vertices[1], vertices[2], true);
    let polygon = gaussians_polygon(view, vertices, 4u, true) + gaussians_sg(view, vertices[0], 1.0, 1.0);
    return vec4(gaussians_rectangle(view, corners, true) + polygon, disk);
";

/// The revision. It is raised when the values of the check change.
const REVISION: u32 = 1;

/// The first part of the comment: description and functions.
const ABOUT: &str = "\
Area lights on anisotropic GGX by one Gaussian on the sphere: no table, cheap and coarse.

FUNCTIONS
  gaussians_view(kind, alpha_x, alpha_y, wo)  the lobe of a surface seen from wo, for all lights at the point. kind is 0
      for a spherical Gaussian (sg), 1 for an anisotropic Gaussian (asg); pass a constant. GGX roughness along x and y is
      above 0. wo is the view direction in the tangent frame, normal +z, of unit length.
{lights}";

/// The functions for lights by a Gaussian, with or without a table.
pub(super) const LIGHTS: &str =
    "  gaussians_rectangle(view, corners, two_sided), gaussians_polygon(view, vertices, count, two_sided),
  gaussians_disk(view, centre, half_x, half_y, two_sided)
      reflected light of a light of radiance one. x: for a Fresnel factor of one. y: the same, weighted by Schlick's
      (1 - cos)^5. Vertices are relative to the shaded point, in the tangent frame, convex, and run clockwise as
      seen from the side that emits. A disk emits towards half_x x half_y.
  gaussians_sg(view, axis, sharpness, amplitude)
      the same for a light amplitude exp(sharpness (w . axis - 1)), as in lightmaps and probes.
  Light of radiance L arrives as L (f0 (x - y) + f90 y).
";

/// The description of the example program.
const EXAMPLE: &str = "\
  gaussians_example calls them. Replace it with your own code, and delete all bindings.

EXAMPLE
  Case: 10 x vec4 of f32. First wo and alpha_x. Second alpha_y; number of vertices of the light (3 to 8, 0 for a disk,
  1 for a spherical Gaussian); 1 if both sides emit, else 0; the kind. Then eight vertices, each followed by 0. For a
  disk: centre, half_x, half_y. For a Gaussian: its axis, then sharpness and amplitude.
  Result: a vec4 of f32, the two parts and 0, 0.
";

/// How to use the functions of the shader text.
const USE: &str = "
USE
  Call gaussians_view once for a point and view, then one function for each light. Isotropic surfaces have
  alpha_x = alpha_y. There are no bindings. Diffuse light is not included: use Lambert's form factor of the light.
";

/// The spherical Gaussian of the check.
pub const SG_LIGHT: SgLight<f64> = SgLight { axis: [-0.48, 0.36, 0.8], sharpness: 12.0, amplitude: 1.5 };

pub(super) fn bindings(language: Language) -> &'static str {
    match language {
        Language::Wgsl => "  here      group 0: case 0, result 1",
        Language::Spirv => "  here      set 0: case 0, result 1",
        Language::Glsl | Language::Glsl330 | Language::GlslEs => "  here      uniform block 0, storage block 1",
        Language::Hlsl => "  here      b0 and u1 of space0",
        Language::Msl => "  here      buffers 0 and 1",
    }
}

/// The comment of the program, in lines that start with `//`.
fn gaussians_header(language: Language) -> String {
    commented(&format!("{}{EXAMPLE}{}\n\n{}", about(), bindings(language), check()))
}

/// The comment of the shader text.
fn gaussians_include_header() -> String {
    commented(&format!("{}{USE}\n{}", about(), check()))
}

fn about() -> String {
    head(LICENCE, REVISION) + &ABOUT.replace("{lights}", LIGHTS)
}

/// The values to check a port against.
fn check() -> String {
    let corners = CORNERS.map(|corner| format!("({})", listed(&corner))).join(" ");
    let SgLight { axis, sharpness, amplitude } = SG_LIGHT;
    let values: Vec<String> = CASES
        .iter()
        .map(|case| {
            let alpha = [case.alpha_x, case.alpha_y];
            let joined = |of: &dyn Fn(Gaussian) -> [f64; 2]| {
                Gaussian::ALL.iter().map(|kind| of(*kind).map(fixed).join(" ")).collect::<Vec<_>>().join(" | ")
            };
            format!(
                "  {}\n    rectangle {}\n    gaussian {}\n",
                case.named(),
                joined(&|kind| reflected(kind, alpha, case.wo, &CORNERS, Sides::One)),
                joined(&|kind| reflected_sg(kind, alpha, case.wo, &SG_LIGHT))
            )
        })
        .collect();
    format!(
        "CHECK\n  The two parts by sg | asg, for the one-sided rectangle\n  {corners}, and for the spherical\n  \
         Gaussian of axis ({}), sharpness {sharpness}, amplitude {amplitude}.\n  \
         A port in 32 bits comes within 0.00002 of each number.\n{}",
        listed(&axis),
        values.concat()
    )
}
