//! Whether a table serves a scene: which materials lie outside of it.

use serde::Serialize;

use crate::scene::{LobeKind, Scene, SceneLobe};
use ltcforge_fit::{ALPHA_FLOOR, BrdfKind, LobeFresnel, RATIO_FLOOR, THETA_CEILING, Table};

/// Numbers that differ by no more are the same: those of tables and recipes are decimals.
const TOLERANCE: f64 = 1e-6;

/// Reflectances that differ by no more have lobes that are alike.
const REFLECTANCE: f64 = 0.02;

/// What of a material lies outside of a table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Outside {
    /// The material's name.
    pub material: String,
    /// Its lobe.
    pub kind: LobeKind,
    /// Each axis with what the scene has of it and what the table has.
    pub axes: Vec<OutsideAxis>,
}

/// An axis of a table that does not reach as far as a scene does.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OutsideAxis {
    /// Its name.
    pub axis: &'static str,
    /// The range in the scene.
    pub scene: [f64; 2],
    /// The range of the table.
    pub table: [f64; 2],
}

/// The materials with lobes of other scattering models than the table's: that table is not for these.
#[must_use]
pub fn of_other_models(scene: &Scene, table: &Table) -> Vec<(String, LobeKind)> {
    let lobes = scene.materials.iter().flat_map(|material| material.lobes.iter().map(move |lobe| (material, lobe)));
    let other = lobes.filter(|(_, lobe)| !is_for(table, lobe.kind));
    other.map(|(material, lobe)| (material.name.clone(), lobe.kind)).collect()
}

/// The reflectances seen from above that a scene has and those that the lobes of a table are fitted to, each from the least
/// to the greatest, where the scene's go beyond: such a table has their roughnesses, and a lobe of other materials. `None` for a
/// table of two lobes, which serve all.
#[must_use]
pub fn other_reflectances(scene: &Scene, table: &Table) -> Option<[[f64; 2]; 2]> {
    let range = |values: &mut dyn Iterator<Item = f64>| {
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
    };
    let fitted = match table.model().fresnel() {
        LobeFresnel::One => [1.0; 2],
        LobeFresnel::Mix(parts) => range(&mut parts.iter().map(|part| part.f0)),
        LobeFresnel::Two(_) => return None,
    };
    let lobes = scene.materials.iter().flat_map(|material| &material.lobes).filter(|lobe| lobe.kind != LobeKind::Sheen);
    let weighed = lobes.flat_map(|lobe| &lobe.f0).filter(|[_, weight]| *weight > 0.0);
    let found = range(&mut weighed.map(|[f0, _]| *f0));
    let is_beyond = found[0] < fitted[0] - REFLECTANCE || found[1] > fitted[1] + REFLECTANCE;
    (is_beyond && table.brdf().has_fresnel()).then_some([found, fitted])
}

/// Whether a table's scattering model is that of a kind of lobe.
fn is_for(table: &Table, kind: LobeKind) -> bool {
    match table.brdf() {
        BrdfKind::Ggx => kind != LobeKind::Sheen,
        BrdfKind::Charlie | BrdfKind::CharlieNeubelt => kind == LobeKind::Sheen,
        _ => false,
    }
}

/// The lobes of a scene, of those that the table's scattering model is for, that go beyond the table's nodes; in the
/// scene's order.
#[must_use]
pub fn outside(scene: &Scene, table: &Table) -> Vec<Outside> {
    let lobes = scene.materials.iter().flat_map(|material| material.lobes.iter().map(move |lobe| (material, lobe)));
    let of_model = lobes.filter(|(_, lobe)| is_for(table, lobe.kind));
    of_model
        .filter_map(|(material, lobe)| {
            let axes = beyond(lobe, table);
            (!axes.is_empty()).then(|| Outside { material: material.name.clone(), kind: lobe.kind, axes })
        })
        .collect()
}

fn beyond(lobe: &SceneLobe, table: &Table) -> Vec<OutsideAxis> {
    let around = |value: fn(&crate::Spot) -> f64| {
        let values = lobe.spots.iter().map(value);
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
    };
    let axes = table.axes();
    let ends = |nodes: &[f64]| [nodes.first(), nodes.last()].map(|end| end.copied().unwrap_or_default());
    let theta = lobe.views.theta().map(|theta| theta.min(THETA_CEILING));
    let surface = [
        (around(|spot| spot.alpha.max(ALPHA_FLOOR)), ends(&axes.alpha)),
        (around(|spot| spot.ratio.max(RATIO_FLOOR)), ends(&axes.ratio)),
    ];
    let [alpha, ratio] = farthest(lobe, table).unwrap_or(surface);
    let all = [
        ("alpha", alpha.0, alpha.1),
        ("ratio", ratio.0, ratio.1),
        ("theta", theta, ends(&axes.theta)),
        (
            "phi",
            if lobe.is_isotropic() { [0.0, std::f64::consts::FRAC_PI_2] } else { lobe.views.phi() },
            ends(&axes.phi),
        ),
    ];
    let is_beyond =
        |scene: [f64; 2], table: [f64; 2]| scene[0] < table[0] - TOLERANCE || scene[1] > table[1] + TOLERANCE;
    // A table of isotropic surfaces turns with the view.
    let counts = |axis: &str| axis != "phi" || !table.serves_every_phi();
    all.into_iter()
        .filter(|(axis, scene, table)| counts(axis) && is_beyond(*scene, *table))
        .map(|(axis, scene, table)| OutsideAxis { axis, scene, table })
        .collect()
}

/// The ranges of alpha, and of ratio, of the roughness that is farthest from the materials of a table, and of the material
/// nearest to it; `None` for a table without materials.
fn farthest(lobe: &SceneLobe, table: &Table) -> Option<[([f64; 2], [f64; 2]); 2]> {
    let of = |spot: &crate::Spot| {
        let (alpha, ratio) = (spot.alpha.max(ALPHA_FLOOR), spot.ratio.max(RATIO_FLOOR));
        let nearest = table.materials().nth(table.material_near(alpha, ratio)?)?;
        Some([([alpha; 2], [nearest[0]; 2]), ([ratio; 2], [nearest[1]; 2])])
    };
    let away = |pairs: &[([f64; 2], [f64; 2]); 2]| pairs.iter().map(|(a, b)| (a[0] - b[0]).abs()).sum::<f64>();
    lobe.spots.iter().filter_map(of).max_by(|a, b| away(a).total_cmp(&away(b)))
}
