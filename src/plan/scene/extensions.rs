//! The extensions of glTF that a plan reads, and those that it names as not covered.

use super::{document::Extensions, error::shown};

/// Extensions that a plan reads, that change nothing for it, or that a note describes.
const READ: [&str; 15] = [
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_variants",
    "KHR_mesh_quantization",
    "KHR_texture_basisu",
    "KHR_texture_transform",
];
const UNLIT: &str = "KHR_materials_unlit";
const SPECULAR_GLOSSINESS: &str = "KHR_materials_pbrSpecularGlossiness";
/// Extensions whose light is not the lobe of one table.
const NOT_COVERED: [(&str, &str); 8] = [
    (UNLIT, "it is unlit"),
    (SPECULAR_GLOSSINESS, "its reflection, of the retired model of specular and glossiness"),
    ("KHR_materials_transmission", "transmitted light; the plan serves its reflection"),
    ("KHR_materials_volume", "light in its volume"),
    ("KHR_materials_diffuse_transmission", "light that comes through it"),
    ("KHR_materials_iridescence", "the colours of its thin film; the plan serves its lobe"),
    ("KHR_materials_dispersion", "its dispersion"),
    ("KHR_materials_subsurface", "light below its surface"),
];

/// Unknown extensions that are named.
const MOST_UNKNOWN: usize = 32;

/// Whether a plan knows an extension.
fn is_known(name: &str) -> bool {
    READ.iter().chain(NOT_COVERED.iter().map(|(name, _)| name)).any(|known| *known == name)
}

/// The first of some extensions that a plan does not know.
pub(super) fn unknown<'a>(names: impl Iterator<Item = &'a String>) -> impl Iterator<Item = &'a String> {
    names.filter(|name| !is_known(name)).take(MOST_UNKNOWN)
}

/// Whether the base lobe of a material is GGX.
pub(super) fn is_ggx(extensions: &Extensions) -> bool {
    !extensions.contains_key(UNLIT) && !extensions.contains_key(SPECULAR_GLOSSINESS)
}

/// The light of a material that no table of one lobe covers.
pub(super) fn uncovered(extensions: &Extensions) -> Vec<String> {
    let listed = NOT_COVERED.iter().filter(|(name, _)| extensions.contains_key(*name));
    let listed = listed.map(|(name, what)| format!("{what} ({name})"));
    listed.chain(unknown(extensions.keys()).map(|name| format!("changes by {}", shown(name)))).collect()
}
