//! A plan as JSON: `plan.json`.

use glam::DVec3;
use serde_json::{Value, json};

use crate::{
    candidates::{Budget, Candidate},
    histogram::span,
    plan::{Fitted, TablePlan},
    scene::{Scene, SceneLight, SceneLobe, SceneMaterial},
    without::text_cost_of,
};
use ltcforge_files::recipe_document::{canonical_json, digest};
use ltcforge_fit::{Recipe, Sides, fit_seconds};

/// Version of the document.
const VERSION: u32 = 1;
/// Maximum number of listed roughnesses of a lobe. For a lobe with more, the document has only their ranges.
const LISTED: usize = 64;

/// A recipe as JSON.
#[must_use]
pub fn recipe_value(recipe: &Recipe) -> Value {
    // The canonical form is JSON.
    serde_json::from_str(&canonical_json(recipe)).unwrap_or_default()
}

/// The plans of a scene's tables as JSON.
#[must_use]
pub fn document(scene: &Scene, plans: &[TablePlan<'_>]) -> Value {
    json!({
        "version": VERSION,
        "scene": {
            "triangles": scene.triangles,
            "cameras": scene.cameras,
            "notes": scene.notes,
            "lights": scene.lights.iter().flat_map(light).collect::<Vec<_>>(),
            "materials": scene.materials.iter().map(material).collect::<Vec<_>>(),
        },
        "tables": plans.iter().map(table).collect::<Vec<_>>(),
    })
}

/// The shapes of a light: one, or the triangles of a mesh.
fn light(SceneLight { name, shapes, rgb, .. }: &SceneLight) -> impl Iterator<Item = Value> {
    shapes.iter().map(move |shape| {
        let points: Vec<[f64; 3]> = shape.points.iter().map(DVec3::to_array).collect();
        json!({
            "name": name, "shape": shape.shape.name(), "two_sided": shape.sides == Sides::Two, "points": points,
            "length": shape.length, "radiance": rgb,
        })
    })
}

fn material(material: &SceneMaterial) -> Value {
    let SceneMaterial { name, area, lobes, uncovered } = material;
    json!({ "name": name, "area": area, "lobes": lobes.iter().map(lobe).collect::<Vec<_>>(), "not_covered": uncovered })
}

fn lobe(lobe: &SceneLobe) -> Value {
    let [alpha, ratio] = [0, 1].map(|axis| span(lobe.spots.iter().map(|spot| [spot.alpha, spot.ratio][axis])));
    let mut value = json!({
        "kind": lobe.kind, "weight": lobe.weight(), "alpha": alpha, "ratio": ratio, "values": lobe.spots.len(),
        "theta": lobe.views.theta,
    });
    if lobe.spots.len() <= LISTED {
        value["spots"] = json!(lobe.spots);
    }
    value
}

fn candidate(candidate: &Candidate, plan: &TablePlan<'_>) -> Value {
    let Candidate { recipe, error, bytes, shipped, seconds, .. } = candidate;
    let mut value = json!({
        "resolution": recipe.resolution, "layout": recipe.layout.name(), "fresnel": recipe.brdf.fresnel(),
        "samples": recipe.fit.samples, "directions": recipe.fit.directions, "precision": recipe.precision.name(),
        "predicted_error": error, "bytes": bytes, "predicted_seconds": seconds, "chosen": *recipe == plan.chosen.recipe,
    });
    if let Some(shipped) = shipped {
        value["predicted_shipped_bytes"] = json!(shipped);
    }
    if let Some(of_table) = plan.fitted.iter().find(|fitted| fitted.candidate.recipe == *recipe) {
        value["measured"] = fitted(of_table);
    }
    value
}

/// The measured figures of a table.
fn fitted(fitted: &Fitted) -> Value {
    let Fitted { candidate, error, shipped } = fitted;
    json!({ "error": error, "bytes": candidate.bytes, "shipped_bytes": shipped, "off_by": fitted.off_by() })
}

fn table(plan: &TablePlan<'_>) -> Value {
    let TablePlan { needs, budget, is_met, chosen, whole, figures, .. } = plan;
    let serves: Vec<Value> = needs.lobes.iter().map(|(index, lobe)| served(*index, lobe, &chosen.recipe)).collect();
    let (kind, most) = match budget {
        Budget::Error(most) => ("error", json!(most)),
        Budget::Bytes(most) => ("bytes", json!(most)),
        Budget::Seconds(most) => ("seconds", json!(most)),
        Budget::Knee => ("knee", Value::Null),
    };
    let is_on_front = |recipe: &Recipe| plan.front().any(|candidate| candidate.recipe == *recipe);
    let others = plan.fitted.iter().map(|fitted| &fitted.candidate).filter(|other| !is_on_front(&other.recipe));
    json!({
        "recipe": recipe_value(&chosen.recipe),
        "recipe_digest": digest(&chosen.recipe),
        "serves": serves,
        "budget": { "of": kind, "most": most, "met": is_met },
        "predicted": { "error": chosen.error, "bytes": chosen.bytes, "seconds": chosen.seconds },
        "limit": chosen.limit.unwrap_or(chosen.error),
        "error_of": if plan.probes.are_lit() { "light" } else { "lobe" },
        "measured": plan.measured().map(fitted),
        "gpu_limit": plan.form.gpu,
        "gpu_cost": text_cost_of(&chosen.recipe),
        "light_error": plan.light[0],
        "materials": figures,
        "worst": figures.iter().map(|figure| figure.error).fold(0.0, f64::max),
        "worst_material": plan.worst().map(|worst| worst.name(plan.needs.scene)),
        "worst_light": plan.worst_light.map(|(name, error)| json!({ "name": name, "error": error })),
        "model": plan.without().map(|without| without.model),
        "rule": plan.without().and_then(|without| without.rule),
        "use_closed_form": plan.form_first().is_some(),
        "without_table": plan.without_table,
        "whole": {
            "recipe_digest": digest(&whole.recipe), "bytes": whole.recipe.bytes(), "error": whole.error,
            "predicted_seconds": fit_seconds(&whole.recipe),
        },
        "candidates": plan.front().chain(others).map(|row| candidate(row, plan)).collect::<Vec<_>>(),
    })
}

/// A lobe that a table covers, with the index of its material in the scene. For a table of materials, also with the
/// indices of the table's materials.
fn served(index: usize, lobe: &SceneLobe, recipe: &Recipe) -> Value {
    let mut value = json!({ "material": index, "kind": lobe.kind });
    let materials = recipe.given.materials();
    if !materials.is_empty() {
        let indices = lobe.spots.iter().filter_map(|spot| materials.iter().position(|pair| *pair == spot.pair()));
        value["table_materials"] = json!(indices.collect::<Vec<_>>());
    }
    value
}
