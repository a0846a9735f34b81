//! Whether all indices of a document are those of things that it has: every fault at once.

use super::{
    document::Document,
    error::{Faults, SceneError},
};

/// Nodes, meshes, images and so on, of each list.
const MOST_ITEMS: u64 = 1 << 18;
/// Materials: each may gather 20 KB of views.
const MOST_MATERIALS: u64 = 1 << 12;

/// Checks the indices that graph and surface follow.
pub(super) fn check(document: &Document) -> Result<(), SceneError> {
    let lists = [
        ("nodes", document.nodes.len()),
        ("meshes", document.meshes.len()),
        ("materials", document.materials.len()),
        ("accessors", document.accessors.len()),
        ("bufferViews", document.buffer_views.len()),
        ("buffers", document.buffers.len()),
        ("textures", document.textures.len()),
        ("images", document.images.len()),
        ("cameras", document.cameras.len()),
    ];
    for (name, length) in lists {
        let most = if name == "materials" { MOST_MATERIALS } else { MOST_ITEMS };
        SceneError::above(format!("/{name}"), length as u64, most)?;
    }
    let mut faults = Faults::default();
    let version = &document.asset.version;
    if !version.is_empty() && version.split('.').next() != Some("2") {
        let shown: String = version.chars().take(40).collect();
        faults.note("/asset/version".to_owned(), format!("«{shown}» is no version 2 of glTF"));
    }
    let nodes = document.nodes.len();
    for (i, scene) in document.scenes.iter().enumerate() {
        for (j, node) in scene.nodes.iter().enumerate() {
            faults.index(format!("/scenes/{i}/nodes/{j}"), Some(*node), "nodes", nodes);
        }
    }
    for (i, node) in document.nodes.iter().enumerate() {
        for (j, child) in node.children.iter().enumerate() {
            faults.index(format!("/nodes/{i}/children/{j}"), Some(*child), "nodes", nodes);
        }
        faults.index(format!("/nodes/{i}/mesh"), node.mesh, "meshes", document.meshes.len());
        faults.index(format!("/nodes/{i}/camera"), node.camera, "cameras", document.cameras.len());
    }
    for (i, mesh) in document.meshes.iter().enumerate() {
        for (j, primitive) in mesh.primitives.iter().enumerate() {
            let place = format!("/meshes/{i}/primitives/{j}");
            let accessors = document.accessors.len();
            faults.index(format!("{place}/material"), primitive.material, "materials", document.materials.len());
            faults.index(format!("{place}/indices"), primitive.indices, "accessors", accessors);
            for (name, accessor) in &primitive.attributes {
                let name: String = name.chars().take(40).collect();
                faults.index(format!("{place}/attributes/{name}"), Some(*accessor), "accessors", accessors);
            }
        }
    }
    for (i, texture) in document.textures.iter().enumerate() {
        faults.index(format!("/textures/{i}/source"), texture.source, "images", document.images.len());
    }
    faults.none()
}
