//! The materials of a scene that a table does not cover.

use std::f64::consts::FRAC_PI_2;

use serde::Serialize;

use crate::{
    histogram::{Spot, span},
    scene::{LobeKind, Scene, SceneLobe},
};
use ltcforge_fit::{BrdfKind, LobeFresnel, THETA_CEILING, Table};

/// Numbers in tables and recipes are rounded, so numbers that should be equal may differ by this much.
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
    /// The axes on which the lobe exceeds the table.
    pub axes: Vec<OutsideAxis>,
}

/// An axis on which a scene exceeds the range of a table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OutsideAxis {
    /// The name of the axis.
    pub axis: &'static str,
    /// The range in the scene.
    pub scene: [f64; 2],
    /// The range of the table.
    pub table: [f64; 2],
}

/// The lobes whose scattering model differs from the table's, each with the name of its material.
#[must_use]
pub fn of_other_models(scene: &Scene, table: &Table) -> Vec<(String, LobeKind)> {
    let other = scene.lobes().filter(|(_, lobe)| !is_for(table, lobe.kind));
    other.map(|(index, lobe)| (scene.materials[index].name.clone(), lobe.kind)).collect()
}

/// The ranges of reflectance at normal incidence of the scene and of the table's lobes, if the scene exceeds the table.
/// `None` for a table with two lobes, which cover all reflectances.
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

/// Whether a table has the scattering model of this kind of lobe.
fn is_for(table: &Table, kind: LobeKind) -> bool {
    match table.brdf() {
        BrdfKind::Ggx => kind != LobeKind::Sheen,
        BrdfKind::Charlie | BrdfKind::CharlieNeubelt => kind == LobeKind::Sheen,
        _ => false,
    }
}

/// The lobes with the table's scattering model that exceed its nodes, in the scene's order.
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
    // An isotropic table covers every phi.
    axes.retain(|axis| {
        is_beyond(axis.scene, axis.table, TOLERANCE) && (axis.axis != "phi" || !table.serves_every_phi())
    });
    axes
}

fn is_beyond(scene: [f64; 2], table: [f64; 2], tolerance: f64) -> bool {
    scene[0] < table[0] - tolerance || scene[1] > table[1] + tolerance
}

/// For a table of materials: alpha and ratio of the lobe's roughness that is farthest from its nearest material, each
/// next to that material's value.
fn farthest(lobe: &SceneLobe, table: &Table) -> Option<[[f64; 2]; 2]> {
    let nearest = |spot: &Spot| {
        let [alpha, ratio] = spot.pair();
        let material = table.materials().nth(table.material_near(alpha, ratio)?)?;
        Some([[alpha, material[0]], [ratio, material[1]]])
    };
    let distance = |pairs: &[[f64; 2]; 2]| pairs.iter().map(|[a, b]| (a - b).abs()).sum::<f64>();
    lobe.spots.iter().filter_map(nearest).max_by(|a, b| distance(a).total_cmp(&distance(b)))
}
