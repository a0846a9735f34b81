//! The comment at the top of the shader for light by a table of Gaussians.

use super::{
    Bound, Language,
    bindings::{bindings, included_bindings},
    gaussians_header::{LIGHTS, gaussians_caller},
    golden::{CASES, CORNERS, Case, listed},
    header::{bound_table, checked_table, commented, fixed},
    stamp::{LICENCE, head},
};
use super::{Lights, Namespace, Reading, model_shader::ModelShader};
use ltcforge_fit::Layout;
use ltcforge_light::Gaussian;

/// The shader for light by a table of Gaussians.
pub(super) const SHADER: ModelShader = ModelShader {
    prefix: "gaussians",
    functions: |_| &["ltc_math", "gaussians_light", "gaussians_table"],
    example: "gaussians_table_example",
    caller: |_, _| gaussians_caller("gaussians_lookup"),
    program_comment: gaussians_table_header,
    include_comment: gaussians_table_include_header,
};

/// The revision. It is raised when the values of the check change.
const REVISION: u32 = 1;

/// The first part of the comment: description and functions.
const ABOUT: &str = "\
Area lights on anisotropic GGX by one Gaussian on the sphere, by a table that ltcforge fitted with lobe sg or asg.

Reads tables of layout {layout}. It does not check the layout of a table.

FUNCTIONS
  gaussians_lookup(kind, alpha_x, alpha_y, wo)  the lobe of a surface seen from wo, for all lights at the point. kind is
      0 for a table of lobe sg, 1 for asg; pass a constant. GGX roughness along x and y. wo is the view direction in the
      tangent frame, normal +z, of unit length.
{lights}";

/// The description of the example program.
const EXAMPLE: &str = "\
EXAMPLE
  gaussians_table_example calls them. Replace it with your own code, and delete all bindings except group 0.
  Case: 10 x vec4 of f32. First wo and alpha_x. Second alpha_y; number of vertices of the light (3 to 8, 0 for a disk,
  1 for a spherical Gaussian); 1 if both sides emit, else 0; the kind. Then eight vertices, each followed by 0. For a
  disk: centre, half_x, half_y. For a Gaussian: its axis, then sharpness and amplitude.
  Result: a vec4 of f32, the two parts and 0, 0.
";

/// How to use the functions of the shader text.
const USE: &str = "
USE
  Call gaussians_lookup once for a point and view, then one function for each light. Isotropic surfaces have
  alpha_x = alpha_y. Diffuse light is not included: use Lambert's form factor of the light.
";

fn about(layout: Layout) -> String {
    head(LICENCE, REVISION) + &ABOUT.replace("{layout}", layout.name()).replace("{lights}", LIGHTS)
}

/// The comment of the program, in lines that start with `//`.
fn gaussians_table_header(language: Language, layout: Layout) -> String {
    let (table, bindings) = (bound_table(Bound::Volumes, layout), bindings(language));
    commented(&format!("{}\n{table}  {bindings}\n\n{EXAMPLE}\n{}", about(layout), check(layout)))
}

/// The comment of the shader text.
fn gaussians_table_include_header(
    language: Language,
    layout: Layout,
    reading: Reading,
    _: Lights,
    namespace: &Namespace,
) -> String {
    let (table, bindings) = (bound_table(reading.bound, layout), included_bindings(language, reading, namespace));
    commented(&format!("{}{USE}\n{table}  {bindings}\n\n{}", about(layout), check(layout)))
}

/// The values to check a port against.
fn check(layout: Layout) -> String {
    let corners = CORNERS.map(|corner| format!("({})", listed(&corner))).join(" ");
    let values: String = CASES.iter().map(|case| shown(case, layout)).collect();
    format!(
        "\
CHECK
{}
  The two parts for kind 0 | for kind 1, for the one-sided rectangle {corners}.
  A port in 32 bits comes within 0.00002 of each number.
{values}",
        checked_table(layout)
    )
}

fn shown(case: &Case, layout: Layout) -> String {
    let parts = Gaussian::ALL.iter().map(|kind| case.lit_by_gaussian(layout, *kind).map(fixed).join(" "));
    format!("  {}\n    rectangle {}\n", case.named(), parts.collect::<Vec<_>>().join(" | "))
}
