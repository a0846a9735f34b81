//! The parts of a scene that decide which tables it needs.

use super::{error::SceneError, lights::SceneLight, material::LobeKind};
use crate::histogram::{Spot, Views};
use ltcforge_fit::Configuration;
use ltcforge_light::AnyLight;

/// A lobe of a material, over all of the surface that has this lobe.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneLobe {
    /// The kind of the lobe.
    pub kind: LobeKind,
    /// The roughnesses of the lobe with their weights.
    pub spots: Vec<Spot>,
    /// The directions from which the lobe is seen.
    pub views: Views,
    /// Reflectance at normal incidence and its weight: of dielectrics, then of metal.
    pub f0: Vec<[f64; 2]>,
    /// The lobe by the specification: mean reflectance at normal and at grazing incidence, and the area, of surface
    /// that reflects like a dielectric and of surface that reflects like metal.
    pub(crate) formula: Vec<[f64; 3]>,
}

impl SceneLobe {
    /// Whether all roughnesses are isotropic, so that the lobe has no direction along the surface.
    #[must_use]
    pub fn is_isotropic(&self) -> bool {
        self.spots.iter().all(|spot| spot.ratio == 1.0)
    }

    /// The area that has the lobe, times the lobe's strength.
    #[must_use]
    pub fn weight(&self) -> f64 {
        self.spots.iter().map(|spot| spot.weight).sum()
    }
}

/// A material of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneMaterial {
    /// The material's name, or its number.
    pub name: String,
    /// The area that has the material; with cameras, the area that at least one of them sees.
    pub area: f64,
    /// The lobes of the material.
    pub lobes: Vec<SceneLobe>,
    /// The parts of the material's light that no table of one lobe covers.
    pub uncovered: Vec<String>,
}

/// A configuration of a scene, and the material there.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Place {
    /// The index of the material, and the kind of the lobe.
    pub(crate) of: (usize, LobeKind),
    /// The area that the place represents, times the part of it that has the lobe. The unit of area has no effect.
    pub(crate) weight: f64,
    /// Roughnesses and view.
    pub(crate) at: Configuration,
    /// Reflectance at normal and at grazing incidence, by the specification.
    pub(crate) fresnel: [f64; 2],
    /// The shapes of lights that reach the place, each with the index of its light.
    pub(crate) lights: Vec<(usize, AnyLight)>,
}

/// The parts of a scene that a plan needs.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scene {
    /// The materials, in the order of the document.
    pub materials: Vec<SceneMaterial>,
    /// Triangles of all instances.
    pub triangles: u64,
    /// Cameras; without a camera, every view counts.
    pub cameras: usize,
    /// The parts of the scene that the weights ignore.
    pub notes: Vec<String>,
    /// The area lights; without a light, light comes from everywhere.
    pub lights: Vec<SceneLight>,
    /// Places on the surface with their lights; empty without lights, and for a list of materials.
    pub(crate) places: Vec<Place>,
}

impl Scene {
    /// The lobes of all materials, each with the index of its material.
    pub(crate) fn lobes(&self) -> impl Iterator<Item = (usize, &SceneLobe)> {
        let materials = self.materials.iter().enumerate();
        materials.flat_map(|(index, material)| material.lobes.iter().map(move |lobe| (index, lobe)))
    }

    /// Returns the scene if a material has a lobe.
    pub(super) fn served(self) -> Result<Self, SceneError> {
        let is_empty = self.materials.iter().all(|material| material.lobes.is_empty());
        if is_empty { Err(SceneError::Empty) } else { Ok(self) }
    }
}
