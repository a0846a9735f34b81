//! The shader as text to include: functions and what they bind, no program.

use super::{
    PortError,
    translation::{Included, translate_functions},
};
use ltcforge_shaders::{
    Language, Lights, LitBy, Place, Reading, functions, gaussians_include_header, gaussians_table_include_header,
    normals_include_header, table_include_header,
};

/// The fragment shader that reaches every function of a table's light.
const TABLE_ENTRY: &str = "
@fragment
fn ltc_included() -> @location(0) vec4<f32> {
    let lobe = ltc_lookup(0.5, 0.5, vec3(0.0, 0.0, 1.0));
    let inverse = ltc_inverse(lobe.m);
    var vertices: array<vec3<f32>, 8>;
    let corners = array<vec3<f32>, 4>(vertices[0], vertices[1], vertices[2], vertices[3]);
    let disk = ltc_disk(inverse, vertices[0], vertices[1], vertices[2], true);
    let sphere = ltc_sphere(inverse, vertices[0], 1.0);
    let long = ltc_tube(inverse, vertices[0], vertices[1], 1.0) + ltc_line(inverse, vertices[0], vertices[1], 1.0);
    let polygon = ltc_rectangle(inverse, corners, true) + ltc_polygon(inverse, vertices, 4u, true);
    return vec4(polygon, disk + sphere, long, lobe.fresnel);
}
";
/// The same for polygons alone.
const POLYGONS_ENTRY: &str = "
@fragment
fn ltc_included() -> @location(0) vec4<f32> {
    let lobe = ltc_lookup(0.5, 0.5, vec3(0.0, 0.0, 1.0));
    let inverse = ltc_inverse(lobe.m);
    var vertices: array<vec3<f32>, 8>;
    let corners = array<vec3<f32>, 4>(vertices[0], vertices[1], vertices[2], vertices[3]);
    let polygon = ltc_rectangle(inverse, corners, true) + ltc_polygon(inverse, vertices, 4u, true);
    return vec4(polygon, 0.0, 0.0, lobe.fresnel);
}
";
/// The same for the light in the space of normals.
const NORMALS_ENTRY: &str = "
@fragment
fn ltc_included() -> @location(0) vec4<f32> {
    let view = normals_view(0.5, 0.5, vec3(0.0, 0.0, 1.0));
    var vertices: array<vec3<f32>, 8>;
    let corners = array<vec3<f32>, 4>(vertices[0], vertices[1], vertices[2], vertices[3]);
    let disk = normals_disk(view, vertices[0], vertices[1], vertices[2], true, 0u);
    return vec4(normals_rectangle(view, corners, true, 0u) + normals_polygon(view, &vertices, 4u, true, 0u), disk);
}
";
/// The same for the light by a Gaussian.
const GAUSSIANS_ENTRY: &str = "
@fragment
fn ltc_included() -> @location(0) vec4<f32> {
    let view = gaussians_view(1u, 0.5, 0.5, vec3(0.0, 0.0, 1.0));
    var vertices: array<vec3<f32>, 8>;
    let corners = array<vec3<f32>, 4>(vertices[0], vertices[1], vertices[2], vertices[3]);
    let disk = gaussians_disk(view, vertices[0], vertices[1], vertices[2], true);
    let polygon = gaussians_polygon(view, vertices, 4u, true) + gaussians_sg(view, vertices[0], 1.0, 1.0);
    return vec4(gaussians_rectangle(view, corners, true) + polygon, disk);
}
";

pub(super) fn table_entry(lights: Lights) -> &'static str {
    match lights {
        Lights::All => TABLE_ENTRY,
        Lights::Polygons => POLYGONS_ENTRY,
    }
}

/// The functions in `language`, under a comment that explains how to call them, what to bind where, and which values a port
/// has to reproduce.
///
/// `reading` says how a table's entries are read; models without a table have none. Who interpolates is the constant
/// `ltc_hardware_filter` in WGSL, and the text is the same for both. `place` keeps several texts apart that are to stand in one
/// shader; a table's, that of model normals and that of the Gaussians need none. `lights` says which lights a table of LTCs has
/// functions for; of other models it says nothing.
///
/// # Errors
/// SPIR-V, which has no text, or a defect of the shaders or of naga.
pub fn include(
    language: Language,
    lit_by: impl Into<LitBy>,
    reading: Reading,
    lights: Lights,
    place: &Place,
) -> Result<String, PortError> {
    let lit_by = lit_by.into();
    let has_storage = !matches!(language, Language::Glsl330 | Language::GlslEs);
    let (entry, reading, header) = match lit_by {
        LitBy::Table(layout) => {
            (table_entry(lights), Some(reading), table_include_header(language, layout, reading, lights, place))
        }
        LitBy::Normals => (NORMALS_ENTRY, None, normals_include_header()),
        LitBy::Gaussian(_) => (GAUSSIANS_ENTRY, None, gaussians_include_header()),
        LitBy::GaussianTable(_, layout) => {
            (GAUSSIANS_ENTRY, Some(reading), gaussians_table_include_header(language, layout, reading, place))
        }
    };
    let is_table = matches!(lit_by, LitBy::GaussianTable(..));
    let entry = if is_table { entry.replace("gaussians_view(", "gaussians_lookup(") } else { entry.to_owned() };
    let source = format!("{}{entry}", functions(lit_by, reading.unwrap_or_default().bound, lights, has_storage));
    let included = Included { source: &source, entry: "ltc_included", reading };
    let text = translate_functions(language, &included).map_err(|reason| PortError { language, reason })?;
    Ok(place.named(&format!("{header}\n{}", place.bound(&text, language)), language, lit_by))
}

#[cfg(test)]
mod tests;
