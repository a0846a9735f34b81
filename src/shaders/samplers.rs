//! The shader text that samples lights, for any light model.

use super::{
    golden::{CASES, CORNERS, listed},
    header::commented,
    namespace::prefixed,
    sources::joined,
    stamp::{LICENCE, head},
};
use glam::DVec3;
use ltcforge_fit::{Configuration, Sides, math::atan2};
use ltcforge_light::{PolygonLight, sample::LightSampler};

/// The revision. It is raised when the values of the check change.
const REVISION: u32 = 1;

/// The first part of the comment: description, functions and use.
const ABOUT: &str = "\
Draws directions to polygon lights where a surface reflects them, for shadow rays and path tracers. Works with any
model; no bindings.

FUNCTIONS
  sampler_normals(alpha_x, alpha_y, wo, corners, two_sided)  once for a point and a rectangle on GGX. wo is the view in
      the tangent frame, normal +z. Corners are relative to the point in this frame and run clockwise as seen from the
      side that emits. The third corner is not read.
  sampler_normals_about(alpha_x, alpha_y, wo, flux, corners, two_sided)  the same, cheaper, with the flux that
      normals_rectangle_lit of model normals returns.
  sampler_ltc(m, corners, two_sided)  the same for the matrix of a table. Pass the unit matrix for diffuse surfaces.
  sampler_draw(sampler, u)  a direction wi, and its density pdf per steradian. u: two numbers in [0, 1). pdf is 0 if the
      light is not visible.
  sampler_pdf(sampler, wi)  the density of a direction that hits the light.
  sampler_draw_either, sampler_pdf_either(specular, diffuse, share, ...)  choose one of two samplers by its energy.
  sampler_normals_polygon, sampler_normals_about_polygon, sampler_ltc_polygon, sampler_draw_polygon,
      sampler_pdf_polygon  the same for convex polygons with 3 to 8 vertices.
  sampler_minus_hidden(light, hidden, count), sampler_by_ratio(light, seen, all)  combine draws with the analytic light.

USE
  let rectangle = sampler_normals(alpha.x, alpha.y, wo, corners, false);
  for each of count draws:
    let drawn = sampler_draw(rectangle, u);
    if (drawn.pdf > 0.0) {
        let weighted = brdf(wo, drawn.wi) * drawn.wi.z / drawn.pdf;
        all += weighted;
        if (ray to the light hits nothing) { seen += weighted; } else { hidden += weighted; }
    }
  colour = sampler_minus_hidden(analytic, radiance * hidden, count); // no bias
  colour = sampler_by_ratio(analytic, seen, all); // less noise, a little bias

";

/// The density of the direction to the middle of the rectangle, for each case.
fn check() -> String {
    let corners = CORNERS.map(DVec3::from_array);
    let towards = (corners[0] + corners[2]).normalize_or_zero();
    let density = |alpha_x: f64, alpha_y: f64, wo: [f64; 3]| {
        let at = Configuration { alpha_x, alpha_y, theta: atan2(wo[0].hypot(wo[1]), wo[2]), phi: atan2(wo[1], wo[0]) };
        let light = PolygonLight::new(corners.to_vec(), Sides::One);
        light.and_then(|light| LightSampler::normals(&at, &light)).map_or(0.0, |sampler| sampler.pdf(towards))
    };
    let line = |case: &super::Case| {
        let found = density(case.alpha_x, case.alpha_y, case.wo);
        format!("  {} {} ({}): {found:.6}\n", case.alpha_x, case.alpha_y, listed(&case.wo))
    };
    let lines: String = CASES.iter().map(line).collect();
    let rectangle = CORNERS.map(|corner| format!("({})", listed(&corner))).join(" ");
    format!(
        "CHECK of the rectangle {rectangle}, alpha_x alpha_y (wo): sampler_pdf of the direction ({}), within 0.1 %\n{lines}",
        towards.to_array().map(|x| format!("{x:.6}")).join(", ")
    )
}

/// The comment at the top of the text.
#[must_use]
pub fn samplers_comment() -> String {
    commented(&format!("{}{ABOUT}{}", head(LICENCE, REVISION), check()))
}

/// The functions, without an entry point.
#[must_use]
pub fn samplers() -> String {
    prefixed(&joined(&["ltc_math", "sampler", "sampler_polygon"]), "ltc", "sampler")
}

/// The functions, and a fragment shader named `ltc_included` that calls each of them.
#[must_use]
pub fn samplers_source() -> String {
    let caller = "
@fragment
fn ltc_included() -> @location(0) vec4<f32> {
    let wo = vec3(0.0, 0.0, 1.0);
    let u = vec2(0.5, 0.5);
    let m = mat3x3(wo.zxx, wo.xzx, wo.xxz);
    var vertices: array<vec3<f32>, 8>;
    let corners = array<vec3<f32>, 4>(vertices[0], vertices[1], vertices[2], vertices[3]);
    let specular = sampler_normals(0.5, 0.5, wo, corners, true);
    let diffuse = sampler_ltc(m, corners, true);
    let drawn = sampler_draw_either(specular, diffuse, 0.5, u);
    let polygon = sampler_normals_polygon(0.5, 0.5, wo, &vertices, 5u, true);
    let by_matrix = sampler_draw_polygon(sampler_ltc_polygon(m, &vertices, 5u, true), u);
    let other = sampler_draw_polygon(sampler_normals_about_polygon(0.5, 0.5, wo, wo, &vertices, 5u, true), u);
    let about = sampler_draw(sampler_normals_about(0.5, 0.5, wo, wo, corners, true), u);
    let pdf = drawn.pdf + by_matrix.pdf + about.pdf + sampler_pdf_polygon(polygon, other.wi);
    return vec4(sampler_minus_hidden(drawn.wi, by_matrix.wi, 1.0) + sampler_by_ratio(wo, drawn.wi, other.wi), pdf);
}
";
    format!("{}{caller}", samplers())
}
