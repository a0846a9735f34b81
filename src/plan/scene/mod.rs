//! Scenes in glTF 2.0: the lobes of their materials, weighted by the area of surface with these lobes, and the views of
//! it.
//!
//! Invariant: hostile bytes give an error within bounded time and memory, never a panic; no file outside of the
//! scene's folder is read; equal files give equal scenes.

mod accessor;
mod camera;
mod check;
mod container;
mod document;
mod error;
mod extensions;
mod gathered;
mod geometry;
mod graph;
mod image;
mod lights;
mod list;
mod material;
mod model;
mod specification;
mod surface;
mod texture;
mod textures;

use std::path::Path;

use self::{
    accessor::Buffers, check::check, container::Container, document::Document, error::shown, extensions::unknown,
    graph::Graph, material::Shaded, textures::Textures,
};

use ltcforge_fit::GoOn;

pub use error::SceneError;
pub use lights::SceneLight;
pub use material::LobeKind;
pub(crate) use model::Place;
pub use model::{Scene, SceneLobe, SceneMaterial};

impl Scene {
    /// Reads a scene's file, `.glb` or `.gltf`, and the files that it names in its folder. `lights` replace
    /// the scene's own lights, unless they are empty. `go_on` may stop it. Runs on
    /// the current rayon pool. The size of the pool does not change the result.
    ///
    /// # Errors
    /// [`SceneError`] if the file is not glTF 2.0, is too large or has no surface, and if `go_on` returns `false`.
    pub fn open(path: &Path, lights: Vec<SceneLight>, go_on: &GoOn<'_>) -> Result<Self, SceneError> {
        Self::of_container(Container::open(path)?, lights, go_on)
    }

    /// Reads a scene that has all its bytes in one file.
    ///
    /// # Errors
    /// See [`Scene::open`].
    pub fn from_bytes(bytes: Vec<u8>, go_on: &GoOn<'_>) -> Result<Self, SceneError> {
        Self::of_container(Container::of_bytes(bytes, None)?, Vec::new(), go_on)
    }

    /// Reads a list of materials: `{"materials": [{"alpha_x": 0.1, "alpha_y": 0.3, "weight": 2}, {"gltf": {...}}]}`.
    ///
    /// # Errors
    /// [`SceneError`] with every fault of the list.
    pub fn from_list(json: &[u8]) -> Result<Self, SceneError> {
        list::read(json)
    }

    fn of_container(mut container: Container, lights: Vec<SceneLight>, go_on: &GoOn<'_>) -> Result<Self, SceneError> {
        let document = Document::parse(&container.json)?;
        check(&document)?;
        let buffers = Buffers::read(&document, &mut container)?;
        let graph = Graph::of(&document, &buffers)?;
        let materials = materials(&document, &graph, &buffers, &mut container, go_on)?;
        let (own, notes) = lights::read(&document, &buffers, &graph, go_on)?;
        let lights = if lights.is_empty() { own } else { lights };
        let mut scene = surface::gather(&document, &buffers, &graph, &materials, lights, go_on)?;
        scene.notes.extend(ignored(&document).into_iter().chain(notes));
        scene.notes.extend(graph.notes);
        if let Some(material) = scene.materials.iter().find(|material| !material.area.is_finite()) {
            return Err(SceneError::fault("", format!("the surface of {} is not finite", material.name)));
        }
        scene.served()
    }
}

/// Notes about parts of a document that change surfaces but are not read.
fn ignored(document: &Document) -> Vec<String> {
    let required = unknown(document.extensions_required.iter());
    let required = required.map(|name| format!("the scene requires {}, which is ignored", shown(name)));
    let has_variants = document.extensions_used.iter().any(|name| name == "KHR_materials_variants");
    let variants = "variants of materials are ignored: each surface has its default material";
    let animations = "animations are ignored: meshes, cameras and materials are used in their rest pose";
    let others = [(has_variants, variants), (!document.animations.is_empty(), animations)];
    required.chain(others.into_iter().filter(|(is_ignored, _)| *is_ignored).map(|(_, note)| note.to_owned())).collect()
}

/// The document's materials, and the default material last. A material that no primitive in the scene uses is `None`.
fn materials(
    document: &Document,
    graph: &Graph,
    buffers: &Buffers<'_>,
    container: &mut Container,
    go_on: &GoOn<'_>,
) -> Result<Vec<Option<Shaded>>, SceneError> {
    let mut used = vec![false; document.materials.len() + 1];
    for primitive in graph.worlds.keys().flat_map(|posed| &document.meshes[posed.mesh].primitives) {
        used[primitive.material.unwrap_or(document.materials.len())] = true;
    }
    let mut textures = Textures::new(document, buffers, container, go_on);
    let default = document::Material::default();
    let mut shaded = Vec::new();
    for ((index, material), is_used) in document.materials.iter().chain([&default]).enumerate().zip(used) {
        let index = Some(index).filter(|index| *index < document.materials.len());
        shaded.push(is_used.then(|| Shaded::read(material, index, Some(&mut textures))).transpose()?);
    }
    Ok(shaded)
}

#[cfg(test)]
pub(crate) mod tests;
