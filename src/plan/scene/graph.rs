//! The nodes of a scene: the transforms of its meshes and cameras.

use glam::{DMat4, DQuat, DVec3};

use super::{camera::Placed, document::Document, document::Node, error::SceneError};

/// The meshes and cameras of a scene.
#[derive(Debug, Default)]
pub(super) struct Graph {
    /// The transforms of each mesh's instances.
    pub(super) worlds: Vec<Vec<DMat4>>,
    pub(super) cameras: Vec<Placed>,
    pub(super) is_instanced: bool,
}

impl Graph {
    /// Follows the nodes of the document's scene, or of all roots if the document has no scene. Domain: a checked
    /// document.
    pub(super) fn of(document: &Document) -> Result<Self, SceneError> {
        let mut graph = Self { worlds: vec![Vec::new(); document.meshes.len()], ..Self::default() };
        let mut reached = vec![false; document.nodes.len()];
        let mut open: Vec<(usize, DMat4)> =
            roots(document)?.into_iter().rev().map(|root| (root, DMat4::IDENTITY)).collect();
        while let Some((index, parent)) = open.pop() {
            let fault = |detail: &str| Err(SceneError::fault(format!("/nodes/{index}"), detail));
            if std::mem::replace(&mut reached[index], true) {
                return fault("this node is reached twice; nodes must be a tree");
            }
            let node = &document.nodes[index];
            let world = parent * local(node);
            if !world.is_finite() {
                return fault("its transform is not finite");
            }
            graph.is_instanced |= node.extensions.contains_key("EXT_mesh_gpu_instancing");
            node.mesh.into_iter().for_each(|mesh| graph.worlds[mesh].push(world));
            graph.cameras.extend(node.camera.and_then(|camera| Placed::new(&document.cameras[camera], world)));
            open.extend(node.children.iter().rev().map(|child| (*child, world)));
        }
        Ok(graph)
    }
}

fn roots(document: &Document) -> Result<Vec<usize>, SceneError> {
    let first = (!document.scenes.is_empty()).then_some(0);
    if let Some(scene) = document.scene.or(first) {
        let scene = document.scenes.get(scene);
        return Ok(scene.ok_or_else(|| SceneError::fault("/scene", "there is no such scene"))?.nodes.clone());
    }
    let mut is_child = vec![false; document.nodes.len()];
    document.nodes.iter().flat_map(|node| &node.children).for_each(|child| is_child[*child] = true);
    Ok((0..document.nodes.len()).filter(|index| !is_child[*index]).collect())
}

fn local(node: &Node) -> DMat4 {
    if let Some(matrix) = &node.matrix {
        return DMat4::from_cols_array(matrix);
    }
    let [x, y, z, w] = node.rotation.as_deref().copied().unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let rotation = DQuat::from_xyzw(x, y, z, w);
    let rotation = if rotation.length_squared() > 0.0 { rotation.normalize() } else { DQuat::IDENTITY };
    let [scale, translation] = [(&node.scale, 1.0), (&node.translation, 0.0)]
        .map(|(given, default)| given.as_deref().map_or(DVec3::splat(default), |given| DVec3::from(*given)));
    DMat4::from_scale_rotation_translation(scale, rotation, translation)
}
