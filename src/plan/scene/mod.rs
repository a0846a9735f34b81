//! Scenes in glTF 2.0: their materials as lobes, weighed by the surface that has them, and the views of it.
//!
//! Invariant: hostile bytes give an error within bounded time and memory, never a panic; no file outside of the
//! scene's folder is read; equal files give equal scenes.

mod accessor;
mod camera;
mod check;
mod container;
mod coverage;
mod decoding;
mod document;
mod error;
mod geometry;
mod graph;
mod image;
mod list;
mod material;
mod model;
mod reflectance;
mod surface;
mod texture;

use std::path::Path;

use self::{
    accessor::Buffers,
    check::check,
    container::Container,
    document::Document,
    graph::Graph,
    material::{Shaded, is_known},
    surface::Surface,
    texture::Textures,
};

use ltcforge_fit::GoOn;

pub use error::{SceneError, SceneFault};
pub use material::LobeKind;
pub use model::{Scene, SceneLobe, SceneMaterial};

impl Scene {
    /// Reads a scene's file, `.glb` or `.gltf`, and the files that it names in its folder; `go_on` may stop it. Runs on the current
    /// rayon pool, whose size changes nothing.
    ///
    /// # Errors
    /// [`SceneError`] where it is no glTF 2.0, too large, or without a surface, and where `go_on` says no.
    pub fn open(path: &Path, go_on: &GoOn<'_>) -> Result<Self, SceneError> {
        Self::of_container(Container::open(path)?, go_on)
    }

    /// Reads a scene that has all its bytes in one file.
    ///
    /// # Errors
    /// As [`Scene::open`].
    pub fn from_bytes(bytes: Vec<u8>, go_on: &GoOn<'_>) -> Result<Self, SceneError> {
        Self::of_container(Container::of_bytes(bytes, None)?, go_on)
    }

    /// Reads a list of materials: `{"materials": [{"alpha_x": 0.1, "alpha_y": 0.3, "weight": 2}, {"gltf": {...}}]}`.
    ///
    /// # Errors
    /// [`SceneError`] with every fault of the list.
    pub fn from_list(json: &[u8]) -> Result<Self, SceneError> {
        list::read(json)
    }

    fn of_container(mut container: Container, go_on: &GoOn<'_>) -> Result<Self, SceneError> {
        let document = Document::parse(&container.json)?;
        check(&document)?;
        let graph = Graph::of(&document)?;
        let buffers = Buffers::read(&document, &mut container)?;
        let materials = materials(&document, &graph, &buffers, &mut container, go_on)?;
        let mut surface = Surface::new(&document, &buffers, &materials);
        surface.gather(&graph, go_on)?;
        let (triangles, (materials, of_surface)) = (surface.triangles, surface.finish());
        let mut notes = graph.notes;
        notes.extend(of_surface);
        notes.extend(unread(&document));
        if !document.skins.is_empty() || !document.animations.is_empty() {
            notes.push("nothing is animated: meshes, cameras and materials are as they stand in the file".to_owned());
        }
        if let Some(material) = materials.iter().find(|material| !material.area.is_finite()) {
            return Err(SceneError::fault("", format!("the surface of {} is not finite", material.name)));
        }
        if materials.iter().all(|material| material.lobes.is_empty()) {
            return Err(SceneError::Empty);
        }
        Ok(Self { materials, triangles, cameras: graph.cameras.len(), notes })
    }
}

/// What of a document changes surfaces and is not read.
fn unread(document: &Document) -> Vec<String> {
    let unknown = document.extensions_required.iter().filter(|name| !is_known(name));
    let mut notes: Vec<String> = unknown
        .map(|name| {
            let name: String = name.chars().take(80).collect();
            format!("the scene requires {name}, which is not read: surfaces and materials are as without it")
        })
        .collect();
    if document.extensions_used.iter().any(|name| name == "KHR_materials_variants") {
        notes.push("materials of variants: each surface has the one that it has without a variant".to_owned());
    }
    let mut weights =
        document.nodes.iter().map(|node| &node.weights).chain(document.meshes.iter().map(|mesh| &mesh.weights));
    if weights.any(|weights| weights.iter().any(|weight| *weight != 0.0)) {
        notes.push("morph targets: meshes are as without them".to_owned());
    }
    notes
}

/// The materials of the primitives that are in the scene, and the default one last.
fn materials(
    document: &Document,
    graph: &Graph,
    buffers: &Buffers,
    container: &mut Container,
    go_on: &GoOn<'_>,
) -> Result<Vec<Option<Shaded>>, SceneError> {
    let mut used = vec![false; document.materials.len() + 1];
    let meshes = graph.instances.iter().map(|instance| &document.meshes[instance.mesh]);
    for primitive in meshes.flat_map(|mesh| &mesh.primitives) {
        used[primitive.material.unwrap_or(document.materials.len())] = true;
    }
    let mut textures = Textures::new(document, buffers, container, go_on);
    let default = document::Material::default();
    let all = document.materials.iter().enumerate().map(|(index, material)| (Some(index), material));
    let read = all
        .chain([(None, &default)])
        .zip(used)
        .map(|((index, material), is_used)| {
            is_used.then(|| Shaded::read(material, index, Some(&mut textures))).transpose()
        })
        .collect::<Result<_, _>>()?;
    textures.finish()?;
    Ok(read)
}

#[cfg(test)]
pub(crate) mod tests;
