//! Scenes made in tests.

use serde_json::{Value, json};

/// A glTF document with its binary chunk.
#[derive(Debug, Clone)]
pub(crate) struct Glb {
    pub(crate) json: Value,
    binary: Vec<u8>,
}

impl Default for Glb {
    fn default() -> Self {
        let json = json!({
            "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [] }], "nodes": [], "meshes": [],
            "materials": [], "accessors": [], "bufferViews": [], "cameras": [], "images": [], "textures": [], "samplers": [],
        });
        Self { json, binary: Vec::new() }
    }
}

impl Glb {
    fn push(&mut self, list: &str, item: Value) -> usize {
        let list = self.json[list].as_array_mut().expect("a list");
        list.push(item);
        list.len() - 1
    }

    pub(crate) fn material(&mut self, material: Value) -> usize {
        self.push("materials", material)
    }

    pub(crate) fn camera(&mut self, camera: Value) -> usize {
        self.push("cameras", camera)
    }

    /// A root of the scene.
    pub(crate) fn node(&mut self, node: Value) -> usize {
        let index = self.child(node);
        self.json["scenes"][0]["nodes"].as_array_mut().expect("a list").push(json!(index));
        index
    }

    pub(crate) fn child(&mut self, node: Value) -> usize {
        self.push("nodes", node)
    }

    pub(crate) fn view(&mut self, bytes: &[u8]) -> usize {
        let offset = self.binary.len();
        self.binary.extend(bytes);
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        self.push("bufferViews", json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() }))
    }

    pub(crate) fn floats(&mut self, numbers: &[f32], shape: &str, per_element: usize) -> usize {
        let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
        let view = self.view(&bytes);
        let count = numbers.len() / per_element;
        self.push("accessors", json!({ "bufferView": view, "componentType": 5126, "count": count, "type": shape }))
    }

    /// The unit square in the plane z = 0, its texture coordinates up to `end`.
    pub(crate) fn quad_to(&mut self, material: Option<usize>, [u, v]: [f32; 2]) -> usize {
        let positions = self.floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0], "VEC3", 3);
        self.json["accessors"][positions]["min"] = json!([0.0, 0.0, 0.0]);
        self.json["accessors"][positions]["max"] = json!([1.0, 1.0, 0.0]);
        let uv = self.floats(&[0.0, 0.0, u, 0.0, u, v, 0.0, v], "VEC2", 2);
        let order: Vec<u8> = [0_u16, 1, 2, 0, 2, 3].iter().flat_map(|index| index.to_le_bytes()).collect();
        let view = self.view(&order);
        let indices = json!({ "bufferView": view, "componentType": 5123, "count": 6, "type": "SCALAR" });
        let indices = self.push("accessors", indices);
        let mut primitive = json!({ "attributes": { "POSITION": positions, "TEXCOORD_0": uv }, "indices": indices });
        if let Some(material) = material {
            primitive["material"] = json!(material);
        }
        self.push("meshes", json!({ "primitives": [primitive] }))
    }

    pub(crate) fn quad(&mut self, material: Option<usize>) -> usize {
        self.quad_to(material, [1.0; 2])
    }

    pub(crate) fn texture(&mut self, image: &[u8], [s, t]: [u32; 2]) -> usize {
        let view = self.view(image);
        let image = self.push("images", json!({ "bufferView": view, "mimeType": "image/png" }));
        let sampler = self.push("samplers", json!({ "wrapS": s, "wrapT": t }));
        self.push("textures", json!({ "source": image, "sampler": sampler }))
    }

    pub(crate) fn bytes(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        if json.get("buffers").is_none() {
            json["buffers"] = json!([{ "byteLength": self.binary.len() }]);
        }
        let mut text = json.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut out = b"glTF".to_vec();
        let words = |out: &mut Vec<u8>, word: usize| out.extend((word as u32).to_le_bytes());
        words(&mut out, 2);
        words(&mut out, 12 + 8 + text.len() + 8 + self.binary.len());
        words(&mut out, text.len());
        out.extend(b"JSON");
        out.extend(text);
        words(&mut out, self.binary.len());
        out.extend(b"BIN\0");
        out.extend(&self.binary);
        out
    }
}

/// A PNG with a level of roughness in each texel, and no metal.
pub(crate) fn checker(side: u32, level: impl Fn(u32, u32) -> u8) -> Vec<u8> {
    let texels: Vec<u8> = (0..side * side).flat_map(|i| [0, level(i % side, i / side), 0]).collect();
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, side, side);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(&texels).expect("texels");
    writer.finish().expect("an image");
    out
}

/// A unit square with roughness from an image.
pub(crate) fn quad_scene(image: &[u8], end: [f32; 2], wrap: [u32; 2], extensions: &Value) -> Glb {
    let mut glb = Glb::default();
    let texture = glb.texture(image, wrap);
    let info = json!({ "index": texture, "extensions": extensions });
    let material = glb.material(json!({ "pbrMetallicRoughness": { "metallicRoughnessTexture": info } }));
    let mesh = glb.quad_to(Some(material), end);
    glb.node(json!({ "mesh": mesh }));
    glb
}
