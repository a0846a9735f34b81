//! The lobes of one material, weighted by the area of the surface with these lobes.

use glam::DVec3;

use super::{
    material::{LobeAt, LobeKind},
    model::{SceneLobe, SceneMaterial},
};
use crate::histogram::{Histogram, Views};
use ltcforge_fit::math::{atan2, sin_cos};

/// The lobes of a material while its surface is read.
#[derive(Debug, Default)]
pub(super) struct Gathered {
    /// One for each [`LobeKind`].
    lobes: [(Histogram, Views); 3],
    area: f64,
    /// Whether the position of some surface is unknown. Every view counts then.
    pub(super) is_placeless: bool,
}

impl Gathered {
    /// Adds a piece of surface with its lobes. `views` are the directions to the cameras that see it, as tangent,
    /// bitangent and normal components.
    pub(super) fn add(&mut self, lobes: &[LobeAt], area: f64, views: &[DVec3]) {
        if area <= 0.0 {
            return;
        }
        self.area += area;
        for at in lobes.iter().filter(|at| at.weight > 0.0) {
            let weight = area * at.weight;
            let (histogram, all_views) = &mut self.lobes[at.kind as usize];
            histogram.add([at.alpha, at.ratio], at.f0, weight);
            histogram.add_formula(at.formula, if at.kind == LobeKind::Base { area } else { weight });
            for view in views {
                let theta = atan2(view.truncate().length(), view.z);
                // Tables cover one quadrant, starting at the axis of the larger roughness.
                let (sin, cos) = sin_cos(at.turn);
                let phi = atan2((cos * view.y - sin * view.x).abs(), (cos * view.x + sin * view.y).abs());
                all_views.add(theta, phi, weight / views.len() as f64);
            }
        }
    }

    /// Makes the scene's material from the gathered lobes.
    pub(super) fn finish(self, name: String, uncovered: Vec<String>, is_every_view: bool) -> SceneMaterial {
        let lobe = |((histogram, views), kind): ((Histogram, Views), LobeKind)| SceneLobe {
            kind,
            spots: histogram.spots(),
            views: if is_every_view { Views::default() } else { views },
            f0: histogram.f0(),
            formula: histogram.formula(),
        };
        let kinds = [LobeKind::Base, LobeKind::Clearcoat, LobeKind::Sheen];
        let lobes = self.lobes.into_iter().zip(kinds).map(lobe).filter(|lobe| !lobe.spots.is_empty());
        SceneMaterial { name, area: self.area, lobes: lobes.collect(), uncovered }
    }
}
