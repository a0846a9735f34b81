//! Checks the indices of a document and reports all faults at once.

use super::{
    document::Document,
    error::{Faults, SceneError, shown},
};

/// Maximum number of items in each list: nodes, meshes, images and so on.
const MOST_ITEMS: u64 = 1 << 18;
/// Maximum number of materials. Each may gather 20 KB of views.
const MOST_MATERIALS: u64 = 1 << 12;

/// Checks the indices that `graph`, `geometry` and `surface` follow.
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
        ("skins", document.skins.len()),
    ];
    for (name, length) in lists {
        let most = if name == "materials" { MOST_MATERIALS } else { MOST_ITEMS };
        SceneError::above(format!("/{name}"), length as u64, most)?;
    }
    let joints: usize = document.skins.iter().map(|skin| skin.joints.len()).sum();
    SceneError::above("joints of all skins", joints as u64, MOST_ITEMS)?;
    let mut faults = Faults::default();
    let version = &document.asset.version;
    if !version.is_empty() && version.split('.').next() != Some("2") {
        faults.add("/asset/version", format!("\"{}\" is not glTF 2", shown(version)));
    }
    for (i, scene) in document.scenes.iter().enumerate() {
        for (j, node) in scene.nodes.iter().enumerate() {
            faults.index(format!("/scenes/{i}/nodes/{j}"), Some(*node), "nodes", &document.nodes);
        }
    }
    for (i, node) in document.nodes.iter().enumerate() {
        for (j, child) in node.children.iter().enumerate() {
            faults.index(format!("/nodes/{i}/children/{j}"), Some(*child), "nodes", &document.nodes);
        }
        faults.index(format!("/nodes/{i}/mesh"), node.mesh, "meshes", &document.meshes);
        faults.index(format!("/nodes/{i}/camera"), node.camera, "cameras", &document.cameras);
        faults.index(format!("/nodes/{i}/skin"), node.skin, "skins", &document.skins);
    }
    for (i, skin) in document.skins.iter().enumerate() {
        let matrices = skin.inverse_bind_matrices;
        faults.index(format!("/skins/{i}/inverseBindMatrices"), matrices, "accessors", &document.accessors);
        for (j, joint) in skin.joints.iter().enumerate() {
            faults.index(format!("/skins/{i}/joints/{j}"), Some(*joint), "nodes", &document.nodes);
        }
    }
    for (i, mesh) in document.meshes.iter().enumerate() {
        for (j, primitive) in mesh.primitives.iter().enumerate() {
            let place = format!("/meshes/{i}/primitives/{j}");
            faults.index(format!("{place}/material"), primitive.material, "materials", &document.materials);
            faults.index(format!("{place}/indices"), primitive.indices, "accessors", &document.accessors);
            for (name, accessor) in primitive.attributes.iter().chain(primitive.targets.iter().flatten()) {
                let pointer = format!("{place}/attributes/{}", shown(name));
                faults.index(pointer, Some(*accessor), "accessors", &document.accessors);
            }
        }
    }
    for (i, texture) in document.textures.iter().enumerate() {
        faults.index(format!("/textures/{i}/source"), texture.source, "images", &document.images);
    }
    faults.none()
}
