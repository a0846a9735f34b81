//! What a scene tells of the tables that it needs.

use super::material::LobeKind;
use crate::histogram::{Spot, Views};

/// A lobe of a material, over all of the surface that has it.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneLobe {
    /// Its kind.
    pub kind: LobeKind,
    /// The roughnesses that it has, and how much of each.
    pub spots: Vec<Spot>,
    /// From where it is seen.
    pub views: Views,
    /// Reflectance seen from above and its weight: of dielectrics, then of metal.
    pub f0: Vec<[f64; 2]>,
}

impl SceneLobe {
    /// Whether it is round everywhere, so that it has no direction along the surface.
    #[must_use]
    pub fn is_isotropic(&self) -> bool {
        self.spots.iter().all(|spot| spot.ratio == 1.0)
    }

    /// The surface that has it, weighed by its strength.
    #[must_use]
    pub fn weight(&self) -> f64 {
        self.spots.iter().map(|spot| spot.weight).sum()
    }
}

/// A material of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneMaterial {
    /// Its name, or its number.
    pub name: String,
    /// The surface that has it: with cameras, the part that one of them sees.
    pub area: f64,
    /// Its lobes.
    pub lobes: Vec<SceneLobe>,
    /// What no table of one lobe gives of it.
    pub uncovered: Vec<String>,
}

/// What a scene tells of the tables that it needs.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scene {
    /// Its materials, in the order of the document.
    pub materials: Vec<SceneMaterial>,
    /// Triangles of all instances.
    pub triangles: u64,
    /// Cameras; without one, every view counts.
    pub cameras: usize,
    /// What was left out of the weights.
    pub notes: Vec<String>,
}
