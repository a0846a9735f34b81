//! The comment at the top of the shader for model `normals`.

use super::{
    Language,
    gaussians_header::bindings,
    golden::{CASES, CORNERS, listed},
    header::{commented, fixed},
    model_shader::{ModelShader, caller},
    stamp::{LICENCE, head},
};
use ltcforge_fit::Sides;
use ltcforge_light::normals::{NormalsRule, reflected};

/// The files of the shader text for a rule.
pub(super) fn normals_files(rule: NormalsRule) -> &'static [&'static str] {
    match rule {
        NormalsRule::Fast => {
            &["normals_view", "normals_arcs_rough", "normals_edge", "normals_fast", "normals_rectangle", "normals_disk"]
        }
        NormalsRule::Balanced => &[
            "normals_view",
            "normals_arcs",
            "normals_edge",
            "normals_outline",
            "normals_balanced",
            "normals_rectangle",
            "normals_disk",
        ],
        NormalsRule::Fine | NormalsRule::Exact => &[
            "normals_view",
            "normals_arcs",
            "normals_edge",
            "normals_outline",
            "normals_fine",
            "normals_rectangle",
            "normals_disk",
        ],
    }
}

/// The shader for light in the space of normals, by a rule.
pub(super) fn shader(rule: NormalsRule) -> &'static ModelShader {
    match rule {
        NormalsRule::Fast => &FAST,
        NormalsRule::Balanced => &BALANCED,
        NormalsRule::Fine | NormalsRule::Exact => &FINE,
    }
}

/// Defines the shader for a rule. The comments of rules differ in the rule's name and in the values of the check.
macro_rules! by_rule {
    ($rule:expr) => {
        ModelShader {
            prefix: "normals",
            functions: |_| normals_files($rule),
            example: "normals_example",
            caller: |_, _| caller("let view = normals_view(0.5, 0.5, vec3(0.0, 0.0, 1.0));", CALLS),
            program_comment: |language, _| normals_header($rule, language),
            include_comment: |_, _, _, _, _| normals_include_header($rule),
        }
    };
}
static FAST: ModelShader = by_rule!(NormalsRule::Fast);
static BALANCED: ModelShader = by_rule!(NormalsRule::Balanced);
static FINE: ModelShader = by_rule!(NormalsRule::Fine);

const CALLS: &str = "    let disk = normals_disk(view, vertices[0], vertices[1], vertices[2], true);
    return vec4(normals_rectangle(view, corners, true) + normals_polygon(view, &vertices, 4u, true), disk);
";

/// The revision. It is raised when the values of the check change for any rule.
const REVISION: u32 = 3;

/// The first part of the comment: description and functions.
const ABOUT: &str = "\
Area lights on GGX without a table, in the space of its normals, by rule {rule}.

  normals_view(alpha_x, alpha_y, wo)  once for a point and view: roughness, and the view in the tangent frame, normal +z.
  normals_rectangle, normals_polygon, normals_disk  for each light. Vertices are relative to the point in this frame and
      run clockwise as seen from the side that emits. The third corner of a rectangle is not read.
      Light of radiance L arrives as L (f0 (x - y) + f90 y).
  normals_rectangle_lit, normals_polygon_lit  light is the same; flux is for sampler_normals_about of the samplers.
";

/// The description of the example program.
const EXAMPLE: &str = "\
  normals_example calls them. Replace it with your own code, and delete all bindings.

EXAMPLE
  Case: 10 x vec4 of f32. First wo and alpha_x. Second alpha_y; number of vertices of the light (3 to 8, 0 for a disk);
  1 if both sides emit, else 0; and 0. Then eight vertices, each followed by 0. For a disk: centre, half_x, half_y.
  Result: a vec4 of f32, the two parts and 0, 0.
";

/// The comment of the program, in lines that start with `//`.
fn normals_header(rule: NormalsRule, language: Language) -> String {
    commented(&format!("{}\n{EXAMPLE}{}\n\n{}", about(rule), bindings(language), check(rule)))
}

/// The comment of the shader text.
fn normals_include_header(rule: NormalsRule) -> String {
    commented(&format!("{}\n{}", about(rule), check(rule)))
}

fn about(rule: NormalsRule) -> String {
    head(LICENCE, REVISION) + &ABOUT.replace("{rule}", rule.name())
}

/// The values to check a port against.
fn check(rule: NormalsRule) -> String {
    let corners = CORNERS.map(|corner| format!("({})", listed(&corner))).join(" ");
    let values: Vec<String> = CASES
        .iter()
        .map(|case| {
            let parts = reflected([case.alpha_x, case.alpha_y], case.wo, &CORNERS, Sides::One, rule).map(fixed);
            format!("  {} {} ({}): {}\n", case.alpha_x, case.alpha_y, listed(&case.wo), parts.join(" "))
        })
        .collect();
    format!("CHECK of the rectangle {corners}, alpha_x alpha_y (wo): x y, within 0.00002\n{}", values.concat())
}
