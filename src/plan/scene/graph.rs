//! The nodes of a scene: where each mesh and camera stands in the world.

use glam::{DMat4, DQuat, DVec3};

use super::{camera::Placed, document::Document, document::Node, error::SceneError};

/// A mesh in the world.
#[derive(Debug, Clone, Copy)]
pub(super) struct Instance {
    pub(super) mesh: usize,
    pub(super) world: DMat4,
}

/// What stands in a scene.
#[derive(Debug, Default)]
pub(super) struct Graph {
    pub(super) instances: Vec<Instance>,
    pub(super) cameras: Vec<Placed>,
    pub(super) notes: Vec<String>,
}

impl Graph {
    /// The nodes of the document's scene, or of all roots where it has none.
    pub(super) fn of(document: &Document) -> Result<Self, SceneError> {
        let roots = roots(document)?;
        let (mut graph, mut reached) = (Self::default(), vec![false; document.nodes.len()]);
        let mut open: Vec<(usize, DMat4)> = roots.into_iter().rev().map(|root| (root, DMat4::IDENTITY)).collect();
        let mut is_instanced = false;
        while let Some((index, parent)) = open.pop() {
            // The caller has checked all indices.
            if std::mem::replace(&mut reached[index], true) {
                let detail = "this node is reached twice: nodes have to be a tree".to_owned();
                return Err(SceneError::fault(format!("/nodes/{index}"), detail));
            }
            let node = &document.nodes[index];
            let world = parent * local(node);
            if !world.is_finite() {
                return Err(SceneError::fault(format!("/nodes/{index}"), "its place in the world is not finite"));
            }
            is_instanced |= node.extensions.contains_key("EXT_mesh_gpu_instancing");
            graph.instances.extend(node.mesh.map(|mesh| Instance { mesh, world }));
            let camera = node.camera.and_then(|camera| Placed::new(&document.cameras[camera], world));
            graph.cameras.extend(camera);
            open.extend(node.children.iter().rev().map(|child| (*child, world)));
        }
        if is_instanced {
            graph.notes.push("EXT_mesh_gpu_instancing: each mesh weighs as one instance of it".to_owned());
        }
        Ok(graph)
    }
}

fn roots(document: &Document) -> Result<Vec<usize>, SceneError> {
    if let Some(scene) = document.scene.or((!document.scenes.is_empty()).then_some(0)) {
        let Some(scene) = document.scenes.get(scene) else {
            return Err(SceneError::fault("/scene", format!("{scene} is no index of scenes")));
        };
        return Ok(scene.nodes.clone());
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
        .map(|(given, default)| given.as_deref().map_or(DVec3::splat(default), |of| DVec3::from(*of)));
    DMat4::from_scale_rotation_translation(scale, rotation, translation)
}
