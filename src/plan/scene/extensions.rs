//! The glTF extensions that a plan reads, and those that it reports as not covered.

use serde::de::DeserializeOwned;

use super::{
    document::Extensions,
    error::{SceneError, shown},
};

pub(super) const EXT_LIGHTS_AREA: &str = "EXT_lights_area";
/// Extensions that a plan reads, that do not affect it, or that a note describes.
const READ: [&str; 17] = [
    EXT_LIGHTS_AREA,
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
    "KHR_meshopt_compression",
    "KHR_mesh_quantization",
    "KHR_texture_basisu",
    "KHR_texture_transform",
];
const UNLIT: &str = "KHR_materials_unlit";
const SPECULAR_GLOSSINESS: &str = "KHR_materials_pbrSpecularGlossiness";
/// Extensions that add light which no table of one lobe covers.
const NOT_COVERED: [(&str, &str); 8] = [
    (UNLIT, "it is unlit"),
    (SPECULAR_GLOSSINESS, "its reflection, which uses the retired specular-glossiness model"),
    ("KHR_materials_transmission", "transmitted light; the plan covers its reflection"),
    ("KHR_materials_volume", "light in its volume"),
    ("KHR_materials_diffuse_transmission", "light that passes through it"),
    ("KHR_materials_iridescence", "the colours of its thin film; the plan covers its lobe"),
    ("KHR_materials_dispersion", "its dispersion"),
    ("KHR_materials_subsurface", "light below its surface"),
];

/// Maximum number of unknown extensions in a note.
const MOST_UNKNOWN: usize = 32;

/// The extensions that a plan does not know, up to [`MOST_UNKNOWN`].
pub(super) fn unknown<'a>(names: impl Iterator<Item = &'a String>) -> impl Iterator<Item = &'a String> {
    let known = |name: &&String| READ.iter().chain(NOT_COVERED.iter().map(|(name, _)| name)).any(|known| known == name);
    names.filter(move |name| !known(name)).take(MOST_UNKNOWN)
}

/// Whether the base lobe of a material is GGX.
pub(super) fn is_ggx(extensions: &Extensions) -> bool {
    !extensions.contains_key(UNLIT) && !extensions.contains_key(SPECULAR_GLOSSINESS)
}

/// The parts of a material's light that no table of one lobe covers.
pub(super) fn uncovered(extensions: &Extensions) -> Vec<String> {
    let listed = NOT_COVERED.iter().filter(|(name, _)| extensions.contains_key(*name));
    let listed = listed.map(|(name, what)| format!("{what} ({name})"));
    listed.chain(unknown(extensions.keys()).map(|name| format!("unknown extension {}", shown(name)))).collect()
}

/// An extension of the object at `place`; its default if the object does not have it.
pub(super) fn extension<T: DeserializeOwned + Default>(
    place: &str,
    extensions: &Extensions,
    name: &str,
) -> Result<T, SceneError> {
    let Some(value) = extensions.get(name) else { return Ok(T::default()) };
    let parsed = serde_json::from_str(value.get());
    parsed.map_err(|error| SceneError::fault(format!("{place}/extensions/{name}"), error.to_string()))
}
