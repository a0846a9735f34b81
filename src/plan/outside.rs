//! The materials of a scene that a table does not cover.

use std::f64::consts::FRAC_PI_2;

use serde::Serialize;

use crate::{
    histogram::{Spot, span},
    scene::{LobeKind, Scene, SceneLobe},
};
use ltcforge_fit::{BrdfKind, LobeFresnel, THETA_CEILING, Table};

/// Numbers of tables and recipes are decimals, so that equal ones may differ by rounding.
const TOLERANCE: f64 = 1e-6;

/// Reflectances that differ by at most this have similar lobes.
const REFLECTANCE: f64 = 0.02;

/// A lobe of a material that a table does not cover.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Outside {
    /// The material's name.
    pub material: String,
    /// The kind of the lobe.
    pub kind: LobeKind,
    /// The axes that the lobe goes beyond.
    pub axes: Vec<OutsideAxis>,
}

/// An axis whose range in the scene goes beyond that of a table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OutsideAxis {
    /// Its name.
    pub axis: &'static str,
    /// The range in the scene.
    pub scene: [f64; 2],
    /// The range of the table.
    pub table: [f64; 2],
}

/// The lobes of other scattering models than the table's, by the names of their materials.
#[must_use]
pub fn of_other_models(scene: &Scene, table: &Table) -> Vec<(String, LobeKind)> {
    let other = scene.lobes().filter(|(_, lobe)| !is_for(table, lobe.kind));
    other.map(|(index, lobe)| (scene.materials[index].name.clone(), lobe.kind)).collect()
}

/// The range of the scene's reflectances at normal incidence, and of those that the table's lobes are fitted to, if the
/// scene goes beyond the table. `None` for a table of two lobes, which serve all reflectances.
#[must_use]
pub fn other_reflectances(scene: &Scene, table: &Table) -> Option<[[f64; 2]; 2]> {
    let fitted = match table.model().fresnel() {
        LobeFresnel::One => [1.0; 2],
        LobeFresnel::Mix(parts) => span(parts.iter().map(|part| part.f0)),
        LobeFresnel::Two(_) => return None,
    };
    let of_ggx = scene.lobes().filter(|(_, lobe)| lobe.kind != LobeKind::Sheen);
    let weighted = of_ggx.flat_map(|(_, lobe)| &lobe.f0).filter(|[_, weight]| *weight > 0.0);
    let found = span(weighted.map(|[f0, _]| *f0));
    (is_beyond(found, fitted, REFLECTANCE) && table.brdf().has_fresnel()).then_some([found, fitted])
}

/// Whether a table's scattering model is that of a kind of lobe.
fn is_for(table: &Table, kind: LobeKind) -> bool {
    match table.brdf() {
        BrdfKind::Ggx => kind != LobeKind::Sheen,
        BrdfKind::Charlie | BrdfKind::CharlieNeubelt => kind == LobeKind::Sheen,
        _ => false,
    }
}

/// The lobes of the table's scattering model that go beyond its nodes, in the scene's order.
#[must_use]
pub fn outside(scene: &Scene, table: &Table) -> Vec<Outside> {
    let of_model = scene.lobes().filter(|(_, lobe)| is_for(table, lobe.kind));
    let outside = of_model.map(|(index, lobe)| Outside {
        material: scene.materials[index].name.clone(),
        kind: lobe.kind,
        axes: axes_beyond(lobe, table),
    });
    outside.filter(|outside| !outside.axes.is_empty()).collect()
}

fn axes_beyond(lobe: &SceneLobe, table: &Table) -> Vec<OutsideAxis> {
    let [alpha, ratio] = [0, 1].map(|axis| span(lobe.spots.iter().map(|spot| spot.pair()[axis])));
    let phi = if lobe.is_isotropic() { [0.0, FRAC_PI_2] } else { lobe.views.phi };
    let ranges = [alpha, ratio, lobe.views.theta.map(|theta| theta.min(THETA_CEILING)), phi];
    let axis = |((axis, nodes), scene): ((_, &Vec<f64>), _)| {
        let table = [nodes.first(), nodes.last()].map(|end| end.copied().unwrap_or_default());
        OutsideAxis { axis, scene, table }
    };
    let mut axes: Vec<OutsideAxis> = table.axes().named().into_iter().zip(ranges).map(axis).collect();
    for (axis, [scene, table]) in axes.iter_mut().zip(farthest(lobe, table).into_iter().flatten()) {
        (axis.scene, axis.table) = ([scene; 2], [table; 2]);
    }
    // A table of isotropic surfaces serves every phi.
    axes.retain(|axis| {
        is_beyond(axis.scene, axis.table, TOLERANCE) && (axis.axis != "phi" || !table.serves_every_phi())
    });
    axes
}

fn is_beyond(scene: [f64; 2], table: [f64; 2], tolerance: f64) -> bool {
    scene[0] < table[0] - tolerance || scene[1] > table[1] + tolerance
}

/// In a table of materials: alpha and ratio of the roughness that is farthest from all materials, each with that of the
/// nearest material.
fn farthest(lobe: &SceneLobe, table: &Table) -> Option<[[f64; 2]; 2]> {
    let nearest = |spot: &Spot| {
        let [alpha, ratio] = spot.pair();
        let material = table.materials().nth(table.material_near(alpha, ratio)?)?;
        Some([[alpha, material[0]], [ratio, material[1]]])
    };
    let distance = |pairs: &[[f64; 2]; 2]| pairs.iter().map(|[a, b]| (a - b).abs()).sum::<f64>();
    lobe.spots.iter().filter_map(nearest).max_by(|a, b| distance(a).total_cmp(&distance(b)))
}
