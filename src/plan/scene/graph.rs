//! The nodes of a scene: the transforms of its meshes and cameras.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DMat4, DQuat, DVec3};

use super::{
    accessor::Buffers,
    camera::Placed,
    document::{Document, Instancing, Node, Primitive},
    error::{SceneError, out_of_range},
    extensions::{EXT_LIGHTS_AREA, extension},
};

/// Maximum number of instances by `EXT_mesh_gpu_instancing`.
const MOST_INSTANCES: u64 = 1 << 18;

/// A mesh in a pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Posed {
    pub(super) mesh: usize,
    pub(super) skin: Option<usize>,
    /// The node that has its own weights of morph targets.
    pub(super) node: Option<usize>,
}

/// The meshes and cameras of a scene.
#[derive(Debug, Default)]
pub(super) struct Graph {
    /// The transforms of the instances of each mesh in each pose.
    pub(super) worlds: BTreeMap<Posed, Vec<DMat4>>,
    /// The matrices of the joints of each skin that is used.
    pub(super) skins: BTreeMap<usize, Vec<DMat4>>,
    pub(super) cameras: Vec<Placed>,
    /// The nodes that have area lights, with their transforms.
    pub(super) lights: Vec<(usize, DMat4)>,
    pub(super) notes: Vec<String>,
}

impl Graph {
    /// Follows the nodes of the document's scene, or of all roots if the document has no scene. Domain: a checked
    /// document.
    pub(super) fn of(document: &Document, buffers: &Buffers<'_>) -> Result<Self, SceneError> {
        let (mut graph, mut instances) = (Self::default(), 0);
        let mut placed = vec![DMat4::IDENTITY; document.nodes.len()];
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
            placed[index] = world;
            if let Some(mesh) = node.mesh {
                let skin = node.skin.filter(|skin| !document.skins[*skin].joints.is_empty());
                let posed = Posed { mesh, skin, node: (!node.weights.is_empty()).then_some(index) };
                let all = match SceneError::split(instanced(buffers, document, index, &mut instances))? {
                    Ok(all) => all,
                    Err(why) => {
                        graph.notes.push(format!("node {index}: {why}; its mesh counts as one instance"));
                        vec![DMat4::IDENTITY]
                    }
                };
                // A skin places its mesh; the node does not.
                let world = if skin.is_some() { DMat4::IDENTITY } else { world };
                graph.worlds.entry(posed).or_default().extend(all.into_iter().map(|instance| world * instance));
            }
            graph.cameras.extend(node.camera.and_then(|camera| Placed::new(&document.cameras[camera], world)));
            if node.extensions.contains_key(EXT_LIGHTS_AREA) {
                graph.lights.push((index, world));
            }
            open.extend(node.children.iter().rev().map(|child| (*child, world)));
        }
        let used: BTreeSet<usize> = graph.worlds.keys().filter_map(|posed| posed.skin).collect();
        for skin in used {
            graph.skins.insert(skin, joints(buffers, document, skin, &placed, &mut graph.notes)?);
        }
        Ok(graph)
    }
}

/// A primitive of a mesh in a pose, with the transforms of its instances.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part<'a> {
    pub(super) mesh: usize,
    number: usize,
    pub(super) primitive: &'a Primitive,
    /// The weights of the morph targets, and the matrices of the skin's joints at rest; empty without a skin.
    pub(super) weights: &'a [f64],
    pub(super) joints: &'a [DMat4],
    pub(super) worlds: &'a [DMat4],
}

impl Part<'_> {
    /// The JSON pointer of the primitive.
    pub(super) fn place(&self) -> String {
        format!("/meshes/{}/primitives/{}", self.mesh, self.number)
    }

    /// The accessors of the primitive's own attributes and of its indices.
    pub(super) fn accessors(&self) -> impl Iterator<Item = usize> {
        self.primitive.attributes.values().copied().chain(self.primitive.indices)
    }
}

impl Graph {
    /// The primitives of all meshes in their rest poses.
    pub(super) fn parts<'a>(&'a self, document: &'a Document) -> impl Iterator<Item = Part<'a>> {
        self.worlds.iter().flat_map(|(posed, worlds)| {
            let mesh = &document.meshes[posed.mesh];
            let joints = posed.skin.and_then(|skin| self.skins.get(&skin)).map_or(&[][..], Vec::as_slice);
            let weights = posed.node.map_or(&mesh.weights, |node| &document.nodes[node].weights);
            let part = move |(number, primitive)| Part { mesh: posed.mesh, number, primitive, weights, joints, worlds };
            mesh.primitives.iter().enumerate().map(part)
        })
    }
}

/// The matrices of a skin's joints: the joint's transform at rest times its inverse bind matrix.
fn joints(
    buffers: &Buffers<'_>,
    document: &Document,
    index: usize,
    placed: &[DMat4],
    notes: &mut Vec<String>,
) -> Result<Vec<DMat4>, SceneError> {
    let skin = &document.skins[index];
    let bound = skin.inverse_bind_matrices.map(|accessor| buffers.numbers::<16>(accessor));
    let bound = SceneError::split(bound.transpose())?.unwrap_or_else(|why| {
        notes.push(format!("skin {index}: {why}; its joints are at their bind pose"));
        None
    });
    let matrix = |(number, joint): (usize, &usize)| {
        let bind = bound.as_ref().and_then(|all| all.get(number));
        let bind = bind.map(|bind| DMat4::from_cols_array(&bind.map(f64::from)));
        placed[*joint] * bind.unwrap_or(DMat4::IDENTITY)
    };
    Ok(skin.joints.iter().enumerate().map(matrix).collect())
}

/// The transforms of a node's instances within the node: one identity without `EXT_mesh_gpu_instancing`. `instances`
/// counts those of all nodes.
fn instanced(
    buffers: &Buffers<'_>,
    document: &Document,
    index: usize,
    instances: &mut u64,
) -> Result<Vec<DMat4>, SceneError> {
    const NAME: &str = "EXT_mesh_gpu_instancing";
    let place = format!("/nodes/{index}");
    let Instancing { attributes } = extension(&place, &document.nodes[index].extensions, NAME)?;
    let of = |name: &str| attributes.get(name).copied();
    let Some(first) = of("TRANSLATION").or(of("ROTATION")).or(of("SCALE")) else { return Ok(vec![DMat4::IDENTITY]) };
    if let Some(accessor) = attributes.values().find(|accessor| **accessor >= document.accessors.len()) {
        let detail = out_of_range(*accessor, "accessors", &document.accessors);
        return Err(SceneError::fault(format!("{place}/extensions/{NAME}/attributes"), detail));
    }
    let count = document.accessors[first].count;
    *instances = instances.saturating_add(count);
    SceneError::above(format!("instances by {NAME}"), *instances, MOST_INSTANCES)?;
    let vectors = |name: &str| of(name).map(|accessor| buffers.numbers::<3>(accessor)).transpose();
    let (translations, scales) = (vectors("TRANSLATION")?, vectors("SCALE")?);
    let rotations = of("ROTATION").map(|accessor| buffers.numbers::<4>(accessor)).transpose()?;
    let one = |i: usize| {
        let vector = |of: &Option<Vec<[f32; 3]>>| Some(of.as_ref()?.get(i)?.map(f64::from));
        let rotation = rotations.as_ref().and_then(|of| of.get(i)).map(|of| of.map(f64::from));
        transform(vector(&translations), rotation, vector(&scales))
    };
    let all: Vec<DMat4> = (0..count as usize).map(one).collect();
    let is_finite = all.iter().all(DMat4::is_finite);
    if is_finite { Ok(all) } else { Err(SceneError::fault(place, "an instance's transform is not finite")) }
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
    let [translation, scale] = [&node.translation, &node.scale].map(|given| given.as_deref().copied());
    transform(translation, node.rotation.as_deref().copied(), scale)
}

fn transform(translation: Option<[f64; 3]>, rotation: Option<[f64; 4]>, scale: Option<[f64; 3]>) -> DMat4 {
    let rotation = DQuat::from_array(rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]));
    let rotation = if rotation.length_squared() > 0.0 { rotation.normalize() } else { DQuat::IDENTITY };
    let [scale, translation] =
        [(scale, 1.0), (translation, 0.0)].map(|(given, default)| given.map_or(DVec3::splat(default), DVec3::from));
    DMat4::from_scale_rotation_translation(scale, rotation, translation)
}
