//! The parts of a glTF 2.0 document that a plan needs. Other parts are not read.

#![expect(clippy::struct_field_names, reason = "the names are those of the format")]

use std::collections::BTreeMap;

use serde::{Deserialize, de::IgnoredAny};
use serde_json::value::RawValue;

use super::error::SceneError;
use ltcforge_files::json_size::JsonLimits;

/// Limits of a document. An object takes up to 0.4 KB and a named value up to 0.11 KB, so a document full of objects or
/// of named values takes up to 230 MB.
const LIMITS: JsonLimits = JsonLimits { items: 1 << 19, values: 1 << 21 };

/// Extensions by name, as text: parsed JSON would take more memory than the document.
pub(super) type Extensions = BTreeMap<String, Box<RawValue>>;

/// Declares objects of the format. Their members have names in camel case, and a default if the document lacks them.
macro_rules! objects {
    ($($(#[$doc:meta])* $name:ident { $($(#[$text:meta])* $member:ident: $type:ty $(= $default:expr)?,)* })*) => {$(
        $(#[$doc])*
        #[derive(Debug, Deserialize)]
        #[serde(default, rename_all = "camelCase")]
        pub(super) struct $name {
            $($(#[$text])* pub(super) $member: $type,)*
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $($member: objects!(@default $($default)?),)* }
            }
        }
    )*};
    (@default $default:expr) => { $default };
    (@default) => { Default::default() };
}

objects! {
    Document {
        asset: Asset,
        extensions_used: Vec<String>,
        extensions_required: Vec<String>,
        scene: Option<usize>,
        scenes: Vec<SceneItem>,
        nodes: Vec<Node>,
        meshes: Vec<Mesh>,
        skins: Vec<Skin>,
        animations: Vec<IgnoredAny>,
        accessors: Vec<Accessor>,
        buffer_views: Vec<BufferView>,
        buffers: Vec<Buffer>,
        materials: Vec<Material>,
        textures: Vec<Texture>,
        images: Vec<Image>,
        samplers: Vec<Sampler>,
        cameras: Vec<Camera>,
        extensions: Extensions,
    }

    Asset {
        /// Empty if the document has no version.
        version: String,
    }

    SceneItem {
        nodes: Vec<usize>,
    }

    Node {
        children: Vec<usize>,
        mesh: Option<usize>,
        camera: Option<usize>,
        skin: Option<usize>,
        // Boxes, because a document may have many nodes without transforms.
        matrix: Option<Box<[f64; 16]>>,
        translation: Option<Box<[f64; 3]>>,
        rotation: Option<Box<[f64; 4]>>,
        scale: Option<Box<[f64; 3]>>,
        /// Weights of the morph targets of its mesh.
        weights: Vec<f64>,
        extensions: Extensions,
    }

    Mesh {
        name: Option<String>,
        primitives: Vec<Primitive>,
        /// Weights of its morph targets.
        weights: Vec<f64>,
    }

    Primitive {
        attributes: BTreeMap<String, usize>,
        indices: Option<usize>,
        material: Option<usize>,
        mode: u32 = 4,
        /// Morph targets: attributes that are added to those of the primitive.
        targets: Vec<BTreeMap<String, usize>>,
        extensions: Extensions,
    }

    /// `EXT_meshopt_compression`.
    Meshopt {
        buffer: usize,
        byte_offset: u64,
        byte_length: u64,
        byte_stride: usize,
        count: usize,
        mode: String,
        filter: Option<String>,
    }

    /// A skin: the nodes that move the vertices of a mesh.
    Skin {
        inverse_bind_matrices: Option<usize>,
        joints: Vec<usize>,
    }

    /// `EXT_mesh_gpu_instancing`.
    Instancing {
        attributes: BTreeMap<String, usize>,
    }

    Material {
        name: Option<String>,
        pbr_metallic_roughness: MetallicRoughness,
        normal_texture: Option<TextureInfo>,
        double_sided: bool,
        alpha_mode: AlphaMode,
        alpha_cutoff: f64 = 0.5,
        emissive_factor: [f64; 3],
        emissive_texture: Option<IgnoredAny>,
        extensions: Extensions,
    }

    MetallicRoughness {
        base_color_factor: [f64; 4] = [1.0; 4],
        base_color_texture: Option<TextureInfo>,
        metallic_factor: f64 = 1.0,
        roughness_factor: f64 = 1.0,
        metallic_roughness_texture: Option<TextureInfo>,
    }

    TextureInfo {
        index: usize,
        tex_coord: u32,
        extensions: Extensions,
    }

    Texture {
        source: Option<usize>,
        sampler: Option<usize>,
        extensions: Extensions,
    }

    Image {
        uri: Option<String>,
        buffer_view: Option<usize>,
    }

    Sampler {
        wrap_s: Option<u32>,
        wrap_t: Option<u32>,
    }

    Camera {
        perspective: Option<Perspective>,
        orthographic: Option<Orthographic>,
    }

    /// `EXT_texture_webp`.
    WebpTexture {
        source: Option<usize>,
    }

    /// `KHR_materials_anisotropy`.
    Anisotropy {
        anisotropy_strength: f64,
        anisotropy_rotation: f64,
        anisotropy_texture: Option<TextureInfo>,
    }

    /// `KHR_materials_clearcoat`.
    Clearcoat {
        clearcoat_factor: f64,
        clearcoat_texture: Option<TextureInfo>,
        clearcoat_roughness_factor: f64,
        clearcoat_roughness_texture: Option<TextureInfo>,
        clearcoat_normal_texture: Option<IgnoredAny>,
    }

    /// `KHR_materials_sheen`.
    Sheen {
        sheen_color_factor: [f64; 3],
        sheen_color_texture: Option<TextureInfo>,
        sheen_roughness_factor: f64,
        sheen_roughness_texture: Option<TextureInfo>,
    }

    /// `KHR_materials_specular`.
    Specular {
        specular_factor: f64 = 1.0,
        specular_texture: Option<TextureInfo>,
        specular_color_factor: [f64; 3] = [1.0; 3],
        specular_color_texture: Option<TextureInfo>,
    }

    /// `KHR_materials_ior`.
    Ior {
        ior: f64 = 1.5,
    }

    /// `KHR_materials_emissive_strength`.
    Emission {
        emissive_strength: f64 = 1.0,
    }

    /// `EXT_lights_area` of the document, and of a node.
    AreaLights {
        lights: Vec<AreaLight>,
        light: Option<usize>,
    }

    AreaLight {
        name: Option<String>,
        #[serde(rename = "type")]
        kind: String,
        color: [f64; 3] = [1.0; 3],
        intensity: f64 = 1.0,
        size: f64 = 1.0,
        rect: Rect,
    }

    Rect {
        aspect: f64 = 1.0,
    }

    /// `KHR_texture_transform`.
    TextureTransform {
        offset: [f64; 2],
        rotation: f64,
        scale: [f64; 2] = [1.0; 2],
        tex_coord: Option<u32>,
    }
}

impl Document {
    /// Parses a document within [`LIMITS`].
    pub(super) fn parse(json: &[u8]) -> Result<Self, SceneError> {
        parsed(json, LIMITS, "a glTF 2.0 document")
    }
}

/// Parses JSON within `limits`; `what` names the document in errors.
pub(super) fn parsed<'de, T: Deserialize<'de>>(
    json: &'de [u8],
    limits: JsonLimits,
    what: &str,
) -> Result<T, SceneError> {
    limits.check(json).map_err(|error| SceneError::fault("", error.to_string()))?;
    serde_json::from_slice(json).map_err(|error| SceneError::fault("", format!("not {what}: {error}")))
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    pub(super) buffer_view: Option<usize>,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) component_type: u32,
    #[serde(default)]
    pub(super) normalized: bool,
    pub(super) count: u64,
    #[serde(rename = "type")]
    pub(super) shape: String,
    pub(super) min: Option<Vec<f64>>,
    pub(super) max: Option<Vec<f64>>,
    // In a box, because most accessors are not sparse.
    pub(super) sparse: Option<Box<Sparse>>,
}

/// The elements that a sparse accessor replaces.
#[derive(Debug, Deserialize)]
pub(super) struct Sparse {
    pub(super) count: u64,
    pub(super) indices: SparsePart,
    pub(super) values: SparsePart,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparsePart {
    pub(super) buffer_view: usize,
    #[serde(default)]
    pub(super) byte_offset: u64,
    /// The type of indices; values have that of the accessor.
    pub(super) component_type: Option<u32>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct BufferView {
    pub(super) buffer: usize,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) byte_length: u64,
    pub(super) byte_stride: Option<u64>,
    #[serde(default)]
    pub(super) extensions: Extensions,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Buffer {
    pub(super) uri: Option<String>,
    pub(super) byte_length: u64,
}

/// The meaning of the base colour's alpha.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
pub(super) enum AlphaMode {
    #[default]
    Opaque,
    Mask,
    Blend,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Perspective {
    pub(super) aspect_ratio: Option<f64>,
    pub(super) yfov: f64,
    pub(super) znear: f64,
    pub(super) zfar: Option<f64>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Orthographic {
    pub(super) xmag: f64,
    pub(super) ymag: f64,
    pub(super) znear: f64,
    pub(super) zfar: f64,
}
