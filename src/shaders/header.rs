//! The comment at the top of a translated shader.

use super::bindings::{bindings, included_bindings};
use super::model_shader::{ModelShader, caller};
use super::{
    Bound, Language, Lights,
    golden::{CASES, CORNERS, Case, Golden, SecondGolden, listed, table},
};
use super::{
    Namespace, Reading,
    stamp::{LICENCE, head},
};
use ltcforge_fit::{Layout, PerAxis, ShaderAxes};

/// The shader for light by a table of LTCs.
pub(super) const SHADER: ModelShader = ModelShader {
    prefix: "ltc",
    functions: light_files,
    example: "ltc_example",
    caller: |reading, lights| table_caller(reading.two_lobes, lights),
    program_comment: header,
    include_comment: table_include_header,
};

/// The files with the functions that integrate an LTC over lights.
pub(super) fn light_files(lights: Lights) -> &'static [&'static str] {
    match lights {
        Lights::All => &["ltc_math", "ltc_inverse", "ltc_rectangle", "ltc_light", "ltc_shapes"],
        Lights::Polygons => &["ltc_inverse", "ltc_rectangle", "ltc_light"],
        Lights::Rectangles => &["ltc_inverse", "ltc_rectangle"],
    }
}

/// The fragment shader that calls every function for a table of LTCs.
#[must_use]
pub fn table_caller(two_lobes: bool, lights: Lights) -> String {
    let lookup = "let lobe = ltc_lookup(0.5, 0.5, vec3(0.0, 0.0, 1.0));\n    ";
    let (before, m) = if two_lobes { (BLEND_CALLED, "blend") } else { ("", "lobe.m") };
    caller(&format!("{lookup}{before}let inverse = ltc_inverse({m});"), &lights_called(lights))
}

/// The calls of every function for lights.
pub(super) fn lights_called(lights: Lights) -> String {
    let (calls, parts) = match lights {
        Lights::All => ([SHAPES_CALLED, POLYGONS_CALLED], "disk + sphere, long"),
        Lights::Polygons => (["", POLYGONS_CALLED], "0.0, 0.0"),
        Lights::Rectangles => (["", RECTANGLES_CALLED], "0.0, 0.0"),
    };
    format!("{}    return vec4(polygon, {parts}, lobe.fresnel);\n", calls.concat())
}

const BLEND_CALLED: &str = "let blend = ltc_blend(ltc_lookup_both(0.5, 0.5, vec3(0.0, 0.0, 1.0)), 0.04, 1.0);
    ";
const SHAPES_CALLED: &str = "    let disk = ltc_disk(inverse, vertices[0], vertices[1], vertices[2], true);
    let sphere = ltc_sphere(inverse, vertices[0], 1.0);
    let long = ltc_tube(inverse, vertices[0], vertices[1], 1.0) + ltc_line(inverse, vertices[0], vertices[1], 1.0);
";
const POLYGONS_CALLED: &str =
    "    let polygon = ltc_rectangle(inverse, corners, true) + ltc_polygon(inverse, vertices, 4u, true);
";
const RECTANGLES_CALLED: &str = "    let polygon = ltc_rectangle(inverse, corners, true);\n";

/// The revision. It is raised when the values of the check change.
const REVISION: u32 = 1;

/// The first part of the comment: description and functions.
const ABOUT: &str = "\
Linearly Transformed Cosines: area lights on anisotropic GGX, by a table that ltcforge fitted.

Reads tables of layout {layout}. It does not check the layout of a table.

FUNCTIONS
  ltc_lookup(alpha_x, alpha_y, wo)  M, amplitude and fresnel. GGX roughness along x and y. wo is the view direction in
      the tangent frame, normal +z, of unit length. M maps the clamped cosine to the lobe, in the tangent frame.
{lights}";

/// The functions for tables of materials.
const MATERIALS: &str = "\x20     It searches for the material nearest in sqrt(alpha) and ratio.
  ltc_lookup_material(material, wo)  the same for a material's number in the recipe's list, without a search. The
      larger roughness is along x.
";

/// The functions for tables with two lobes.
const TWO_LOBES: &str = "  ltc_lookup_both(alpha_x, alpha_y, wo)  first, as from ltc_lookup; second, the matrix
      of the part weighted by Schlick's fifth power. Needs a table with fresnel two_lobes or blended_lobes. Light of
      radiance L arrives as L (f0 amplitude covered(first.m) + (f90 - f0) fresnel covered(second)).
  ltc_blend(lobes, f0, f90)         a single matrix for a material, to use as M below. It needs one integral instead of
      two. Tables with blended_lobes are fitted for it.
";

/// The functions for lights, for tables with and without textures.
#[must_use]
pub fn functions_of(lights: Lights) -> &'static str {
    match lights {
        Lights::All => LIGHTS,
        Lights::Polygons => POLYGONS,
        Lights::Rectangles => RECTANGLES,
    }
}

const RECTANGLES: &str = "  ltc_inverse(M)                    the inverse up to a factor, for all lights at the point.
  ltc_rectangle(inverse, corners, two_sided)  the part of the lobe that a rectangle or parallelogram covers, 0 to 1.
      Corners are relative to the shaded point, in the tangent frame, clockwise as seen from the side that emits.
  Light of radiance L arrives as L (f0 (amplitude - fresnel) + f90 fresnel) covered.
";

const POLYGONS: &str = "  ltc_inverse(M)                    the inverse up to a factor, for all lights at the point.
  ltc_rectangle(inverse, corners, two_sided), ltc_polygon(inverse, vertices, count, two_sided)
      the part of the lobe that a light covers, 0 to 1. Positions are relative to the shaded point, in the tangent frame.
      Outlines are convex and run clockwise as seen from the side that emits. A rectangle may be a parallelogram; its
      last corner is not read. A polygon of four vertices costs more. --lights polygons omits disks, spheres,
      tubes and lines.
  Light of radiance L arrives as L (f0 (amplitude - fresnel) + f90 fresnel) covered.
";

const LIGHTS: &str = "  ltc_inverse(M)                    the inverse up to a factor, for all lights at the point.
  ltc_rectangle(inverse, corners, two_sided), ltc_polygon(inverse, vertices, count, two_sided),
  ltc_disk(inverse, centre, half_x, half_y, two_sided), ltc_sphere(inverse, centre, radius),
  ltc_tube(inverse, start, end, radius), ltc_line(inverse, start, end, width)
      the part of the lobe that a light covers, 0 to 1. Positions are relative to the shaded point, in the tangent frame.
      Outlines are convex and run clockwise as seen from the side that emits. A rectangle may be a parallelogram; its
      last corner is not read. A polygon of four vertices costs more. A disk emits towards half_x x half_y. A tube has
      round ends. A line is the limit of a thin tube; its width is the diameter. Disks, spheres and tubes are exact.
      The constant LTC_CHEAP_HORIZON makes polygons, disks and spheres cheaper, but too bright by up to 0.16 at the
      horizon.
  Light of radiance L arrives as L (f0 (amplitude - fresnel) + f90 fresnel) covered.
";

/// The sentence about a program's entry point.
const CALLED: &str = "  ltc_example calls them. Replace it with your own code; delete all bindings except group 0.\n";

/// How to use the functions of the shader text.
const USE: &str = "
USE
  Call ltc_lookup and ltc_inverse once for a point and view, then one function for each light. Isotropic surfaces have
  alpha_x = alpha_y. Diffuse light is the albedo times the part covered for ltc_inverse of the unit matrix.
  A second table in the same shader needs its own names and bindings: ltcforge shader --prefix --first-binding.
";

/// The bindings of a table, in every language.
const TABLE: &str = "\
BINDINGS OF A TABLE
  uniform   36 words, nine vectors of four, which ltcforge export --for wgpu writes as ltc.json. Two vectors of u32:
            number of nodes of alpha, ratio, theta and phi; number of the layout, not read here
            ({numbers}),
            then 1 if ratio has the single node 1 and phi has one node, else 0; alpha_nodes if entries have two lobes,
            else 0; and 0. Seven vectors of f32, the first three for alpha, ratio, theta and phi, in the coordinates in
            which the layout's nodes are evenly spaced: the first node; the step between nodes (1 for a single node);
            one over the step. Then 1 / alpha_nodes (half of it for two lobes), 1 / (ratio_nodes theta_nodes),
            theta_nodes, 1 / phi_nodes; first and last alpha, first and last ratio; cosines of the last and first theta,
            0, 0; cosine and sine of the first phi, and of the last phi
  {textures}  Texels are in the order of the file's entries. Assemble them from the file's tensors matrix,
  amplitude and fresnel. Alpha is the larger roughness, ratio the smaller divided by the larger, theta and phi the
  angles of the view direction in radians.
";

/// The description of layout `materials`, which has materials on the alpha axis.
const PAIRS: &str = "\x20 In layout materials, the nodes of alpha are the materials; each has one ratio. The number
  after fresnel is the material's alpha at the first node of theta, its ratio at the second node, and 0 at the others.
";

/// The description of a table in three textures.
const VOLUMES: &str = "\
  matrix_a  3D texture, RGBA, 32 or 16 bit float: m00 m01 m02 m10 of each entry; m01 is row 0, column 1
  matrix_b  the same format: m11 m12 m20 m21
  terms     the same format: m22 amplitude fresnel 0; a table without terms has amplitude 1, fresnel 0
  The textures are phi wide, ratio * theta high and alpha deep: texel (p, r * theta_nodes + t, a) is entry [a, r, t, p]
  of the file's tensors. Second lobes (tensor matrix_2) follow all first lobes.
";

/// The description of a table in one texture.
const ARRAY: &str = "\
  layers    2D array, RGBA, 32 or 16 bit float, phi wide, ratio * theta high, with three layers for each node of alpha.
            Entry [a, r, t, p] of the file's tensors is at (p, r * theta_nodes + t). Layer a has m00 m01 m02 m10, layer
            alpha_nodes + a has m11 m12 m20 m21, layer 2 alpha_nodes + a has m22 amplitude fresnel 0. m01 is row 0,
            column 1. A table without terms has amplitude 1, fresnel 0
";

/// The input and output of `ltc_example`.
const EXAMPLE: &str = "\
EXAMPLE
  Case: 10 x vec4 of f32. First wo and alpha_x. Second alpha_y; shape of the light (3 to 8 for a polygon of so many
  vertices, 0 disk, 1 sphere, 2 tube, 9 line); 1 if both sides emit, else 0; radius or width. Then eight vertices, each
  followed by 0. For a disk: centre, half_x, half_y. For a sphere: its centre. For a tube or line: both ends.
  Result: 4 x vec4 of f32. The columns of M with 0 after each; amplitude, fresnel, covered, 0.
";

/// Licence, description and functions.
fn about(layout: Layout, two_lobes: bool, lights: Lights) -> String {
    let materials = if layout.is_of_materials() { MATERIALS } else { "" };
    let two_lobes = if two_lobes { TWO_LOBES } else { "" };
    let functions = [materials, two_lobes, functions_of(lights)].concat();
    head(LICENCE, REVISION) + &ABOUT.replace("{layout}", layout.name()).replace("{lights}", &functions)
}

pub(super) fn bound_table(bound: Bound, layout: Layout) -> String {
    let textures = match bound {
        Bound::Volumes => VOLUMES,
        Bound::Array => ARRAY,
    };
    let others = Layout::ALL.iter().filter(|other| !other.is_of_materials() || **other == layout);
    let numbers = others.map(|layout| format!("{layout} {}", layout.shader().number));
    let text = TABLE.replace("{numbers}", &numbers.collect::<Vec<_>>().join(", "));
    let pairs = if layout.is_of_materials() { PAIRS } else { "" };
    text.replace("{textures}", textures) + pairs
}

/// The comment of the shader for `layout`, in lines that start with `//`.
fn header(language: Language, layout: Layout) -> String {
    let table = bound_table(Bound::Volumes, layout);
    let text = format!(
        "{}{CALLED}\n{table}  {}\n\n{EXAMPLE}\n{}",
        about(layout, false, Lights::All),
        bindings(language),
        check(layout, false)
    );
    commented(&text)
}

/// The comment of a shader text that reads tables of `layout`.
fn table_include_header(
    language: Language,
    layout: Layout,
    reading: Reading,
    lights: Lights,
    namespace: &Namespace,
) -> String {
    let check = commented(&check(layout, reading.two_lobes));
    include_comment_of(language, layout, reading, lights, namespace, &check)
}

/// The comment of a shader text, in lines that start with `//`, followed by the lines `last`.
pub(super) fn include_comment_of(
    language: Language,
    layout: Layout,
    reading: Reading,
    lights: Lights,
    namespace: &Namespace,
    last: &str,
) -> String {
    let table = bound_table(reading.bound, layout);
    let bindings = included_bindings(language, reading, namespace);
    let about = about(layout, reading.two_lobes, lights);
    commented(&format!("{about}{USE}\n{table}  {bindings}\n\n")) + last
}

/// The text in lines that start with `//`.
#[must_use]
pub fn commented(text: &str) -> String {
    text.lines().map(|line| format!("// {line}").trim_end().to_owned() + "\n").collect()
}

/// The values to check a port against.
fn check(layout: Layout, two_lobes: bool) -> String {
    let corners = CORNERS.map(|corner| format!("({})", listed(&corner))).join(" ");
    let second = |case: &Case| if two_lobes { shown_second(&case.golden_second(layout)) } else { String::new() };
    let goldens: String = CASES.iter().map(|case| shown(case, &case.golden(layout)) + &second(case)).collect();
    let numbers = if two_lobes { SECOND_NUMBERS } else { "" };
    format!(
        "\
CHECK
{} Covered is the
  part that the one-sided rectangle {corners} covers.
  M is given by rows. A port in 32 bits comes within 0.00002 of each number.
{numbers}{goldens}",
        checked_table(layout)
    )
}

/// The description of the table's second lobes.
const SECOND_NUMBERS: &str = "  The second lobe has the numbers I[k] + e * (9 - k) / 1024, with the zeros of the first.
  Blended is the part that the rectangle covers of the blend for f0 = 0.04, f90 = 1.
";

fn shown_second(golden: &SecondGolden) -> String {
    format!("    second {}\n    blended {}\n", by_rows(&golden.matrix), fixed(golden.blended))
}

fn by_rows(matrix: &[f64; 9]) -> String {
    let rows = matrix.chunks(3).map(|row| row.iter().map(|x| fixed(*x)).collect::<Vec<_>>().join(" "));
    rows.collect::<Vec<_>>().join(" | ")
}

/// The description of the table that the check uses.
pub(super) fn checked_table(layout: Layout) -> String {
    let axes = table(layout).axes;
    let PerAxis { ratio: ratios, theta: thetas, phi: phis, .. } = layout.lengths(&axes);
    let ShaderAxes { nodes, start, step, roughness, cosines, azimuths, .. } = layout.shader_axes(&axes);
    let pairs = table(layout).materials().map(|pair| listed(&pair)).collect::<Vec<_>>().join(", ");
    let pairs = if pairs.is_empty() { pairs } else { format!("\n  Its materials are, by alpha and ratio, {pairs}.") };
    let across = if ratios == 1 { "\n  Numbers across the plane of incidence, k = 1 3 5 7, are 0." } else { "" };
    format!(
        "\x20 The table has the uniform nodes {}, start {}, step {},
  alpha and ratio {}, cosines {}, azimuths {}.
  Its entry e = ((a * {ratios} + r) * {thetas} + t) * {phis} + p has the numbers I[k] + e * (k + 1) / 1024 for
  k = 0 to 10: the matrix by rows, amplitude, fresnel. I = 1 0 0 0 1 0 0 0 1 1 0. All numbers are exact in
  16 bits.{across}{pairs}",
        listed(&nodes),
        listed(&start),
        listed(&step),
        listed(&roughness),
        listed(&cosines[..2]),
        listed(&azimuths),
    )
}

fn shown(case: &Case, golden: &Golden) -> String {
    format!(
        "  {}\n    M {}\n    amplitude {} fresnel {} covered {}\n",
        case.named(),
        by_rows(&golden.matrix),
        fixed(golden.amplitude),
        fixed(golden.fresnel),
        fixed(golden.covered),
    )
}

/// The number with six decimals. Zero has no sign.
pub(super) fn fixed(x: f64) -> String {
    let text = format!("{x:.6}");
    if text == "-0.000000" { "0.000000".to_owned() } else { text }
}
