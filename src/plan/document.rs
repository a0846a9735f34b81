//! A plan as JSON: `plan.json`.

use serde::Serialize;
use serde_json::{Value, json};

use crate::{
    candidates::{Budget, Candidate},
    effort::in_words as effort_in_words,
    needs::pair,
    plan::{Fitted, TablePlan},
    scene::{LobeKind, Scene, SceneLobe, SceneMaterial},
};
use ltcforge_files::recipe_document::{canonical_json, digest};
use ltcforge_fit::{PerAxis, Recipe, fit_seconds};

/// Version of the document.
const VERSION: u32 = 1;
/// Roughnesses of a lobe that are listed one by one.
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
            "materials": scene.materials.iter().map(material).collect::<Vec<_>>(),
        },
        "tables": plans.iter().map(table).collect::<Vec<_>>(),
    })
}

fn material(material: &SceneMaterial) -> Value {
    let SceneMaterial { name, area, lobes, uncovered } = material;
    json!({ "name": name, "area": area, "lobes": lobes.iter().map(lobe).collect::<Vec<_>>(), "not_covered": uncovered })
}

fn lobe(lobe: &SceneLobe) -> Value {
    let ends = |value: fn(&crate::Spot) -> f64| {
        let values = lobe.spots.iter().map(value);
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
    };
    let mut value = json!({
        "kind": lobe.kind, "weight": lobe.weight(), "alpha": ends(|spot| spot.alpha), "ratio": ends(|spot| spot.ratio),
        "values": lobe.spots.len(), "theta": lobe.views.theta(),
    });
    if lobe.spots.len() <= LISTED {
        value["spots"] = json!(lobe.spots);
    }
    value
}

/// A candidate in numbers.
#[derive(Debug, Serialize)]
struct Row {
    resolution: PerAxis<u32>,
    layout: &'static str,
    fresnel: Value,
    samples: u32,
    directions: u32,
    precision: &'static str,
    predicted_error: f64,
    bytes: u64,
    /// Of the compact form, where that is to ship.
    #[serde(skip_serializing_if = "Option::is_none")]
    predicted_shipped_bytes: Option<u64>,
    predicted_seconds: f64,
    /// What was measured, of those that were fitted.
    #[serde(skip_serializing_if = "Option::is_none")]
    measured: Option<Value>,
    chosen: bool,
}

fn row(candidate: &Candidate, plan: &TablePlan<'_>) -> Row {
    let recipe = &candidate.recipe;
    let fitted = plan.fitted.iter().find(|fitted| fitted.candidate.recipe == *recipe);
    Row {
        resolution: recipe.resolution(),
        layout: recipe.layout().name(),
        fresnel: json!(recipe.model().fresnel()),
        samples: recipe.fit().samples(),
        directions: recipe.fit().directions(),
        precision: recipe.precision().name(),
        predicted_error: candidate.error,
        bytes: candidate.bytes,
        predicted_shipped_bytes: candidate.shipped,
        predicted_seconds: candidate.seconds,
        measured: fitted.map(fitted_value),
        chosen: *recipe == plan.chosen.recipe,
    }
}

/// What was measured of a table.
fn fitted_value(fitted: &Fitted) -> Value {
    let mut value = json!({ "error": fitted.error, "bytes": fitted.bytes, "seconds": fitted.seconds });
    if let Some(bytes) = fitted.shipped {
        value["shipped_bytes"] = json!(bytes);
    }
    value
}

/// What was measured of the choice's table; null where it was not fitted.
fn measured_value(plan: &TablePlan<'_>) -> Value {
    let Some((measured, fitted)) = plan.measured.zip(plan.fitted.last()) else { return Value::Null };
    let mut value = fitted_value(fitted);
    value["off_by"] = json!(measured.off_by);
    value["first_off_by"] = json!(measured.first_off_by);
    value["seconds_off_by"] = json!(plan.seconds_off_by(fitted));
    value
}

/// The front of error against bytes, and what was fitted beside it.
fn rows(plan: &TablePlan<'_>) -> Vec<Row> {
    let is_on_front = |recipe: &Recipe| plan.front().any(|candidate| candidate.recipe == *recipe);
    let beside = plan.fitted.iter().map(|fitted| &fitted.candidate).filter(|of| !is_on_front(&of.recipe));
    plan.front().chain(beside).map(|candidate| row(candidate, plan)).collect()
}

fn table(plan: &TablePlan<'_>) -> Value {
    let TablePlan { needs, budget, is_met, chosen, limit, whole, .. } = plan;
    let serves: Vec<Value> = needs.lobes().iter().map(|(index, lobe)| served(*index, lobe, &chosen.recipe)).collect();
    let (budget, of) = match budget {
        Budget::Error(most) => (json!(most), "error"),
        Budget::Bytes(most) => (json!(most), "bytes"),
        Budget::Seconds(most) => (json!(most), "seconds"),
        Budget::Knee => (Value::Null, "knee"),
    };
    json!({
        "recipe": recipe_value(&chosen.recipe),
        "recipe_digest": digest(&chosen.recipe),
        "serves": serves,
        "budget": { "of": of, "most": budget, "met": is_met },
        "predicted": { "error": chosen.error, "bytes": chosen.bytes, "seconds": chosen.seconds },
        "limit": limit,
        "measured": measured_value(plan),
        "lobes": plan.lobes().map(|(fresnel, error)| json!({ "fresnel": fresnel, "error": error })).collect::<Vec<_>>(),
        "gpu_limit": plan.gpu(),
        "gpu_cost": plan.beside.gpu_cost,
        "light_error": plan.beside.light_error,
        "rule": plan.beside.rule,
        "without_table": plan.beside.without_table,
        "whole": {
            "recipe_digest": digest(&whole.recipe), "bytes": whole.bytes, "predicted_error": whole.predicted,
            "predicted_seconds": fit_seconds(&whole.recipe), "error": whole.error, "seconds": whole.seconds,
            "presets": whole.presets(),
        },
        "candidates": rows(plan),
    })
}

/// A lobe that a table serves: the number of the scene's material, and those of the table's where it has some.
fn served(index: usize, lobe: &SceneLobe, recipe: &Recipe) -> Value {
    let mut value = json!({ "material": index, "kind": lobe.kind });
    let materials = recipe.given().materials();
    if !materials.is_empty() {
        let number = |spot| materials.iter().position(|known| *known == pair(spot));
        value["table_materials"] = json!(lobe.spots.iter().filter_map(number).collect::<Vec<_>>());
    }
    value
}

/// The summary in words, a line for each thing to know.
#[must_use]
pub fn words(scene: &Scene, plans: &[TablePlan<'_>]) -> Vec<String> {
    let anisotropic =
        scene.materials.iter().filter(|material| material.lobes.iter().any(|lobe| !lobe.is_isotropic())).count();
    let views = match scene.cameras {
        0 => "every view".to_owned(),
        n => format!("the views of {}", plural(n, "camera")),
    };
    let mut lines = vec![format!("{}, {anisotropic} anisotropic; {views}", plural(scene.materials.len(), "material"))];
    for plan in plans {
        lines.extend(words_of(plan));
    }
    lines.extend(left_out(scene));
    lines
}

/// What of a scene no table serves, and what could not be read of it, a line each.
#[must_use]
pub fn left_out(scene: &Scene) -> Vec<String> {
    let mut lines = Vec::new();
    for material in &scene.materials {
        for what in &material.uncovered {
            lines.push(format!("not covered, {}: {what}", material.name));
        }
        if material.lobes.is_empty() && material.uncovered.is_empty() {
            lines.push(format!("not covered, {}: none of it is seen", material.name));
        }
    }
    lines.extend(scene.notes.iter().map(|note| format!("left out: {note}")));
    lines
}

fn words_of(plan: &TablePlan<'_>) -> Vec<String> {
    let TablePlan { chosen, measured, whole, limit, is_met, .. } = plan;
    let [alpha, ratio, theta, phi] = chosen.recipe.resolution().named().map(|(_, n)| *n);
    let surfaces = if chosen.recipe.layout().is_of_materials() {
        format!("layout materials, {} x", plural(alpha as usize, "material"))
    } else {
        format!("{alpha} x {ratio} x")
    };
    let nodes = format!("{surfaces} {theta} x {phi}");
    let is_sheen = plan.needs.lobes().iter().any(|(_, lobe)| lobe.kind == LobeKind::Sheen);
    let of = if is_sheen { "sheen: " } else { "" };
    let took = plan.fitted.last().and_then(|fitted| fitted.seconds);
    let took = took.map_or_else(String::new, |seconds| format!(", fitted in {seconds:.1} s of processor time"));
    let measured = measured.map_or_else(String::new, |measured| format!("; measured {:.4}{took}", measured.error));
    let shipped = chosen.shipped.map_or_else(String::new, |bytes| {
        let encoded = plan.fitted.last().and_then(|fitted| fitted.shipped);
        let told = encoded.map_or_else(|| format!("about {}", bytes_in_words(bytes)), bytes_in_words);
        format!(", {told} to ship in its compact form,")
    });
    let line = format!(
        "{of}{nodes} nodes, {}{shipped} as {}, {}, {:.1} s on one core: expected error {:.4}, of which {limit:.4} stays with {}{measured}",
        bytes_in_words(chosen.bytes),
        chosen.recipe.precision(),
        effort_in_words(&chosen.recipe.fit),
        chosen.seconds,
        chosen.error,
        plan.limit_stays_with()
    );
    let mut lines = vec![line];
    lines.extend(lobes_in_words(plan));
    let error = whole.error.or(whole.predicted);
    let of_whole = error.map_or_else(String::new, |error| format!(", with an error of {error:.4} on this scene"));
    lines.push(format!("{of}the table of the whole domain has {}{of_whole}", bytes_in_words(whole.bytes)));
    lines.extend(plan.beside.words());
    let layout = chosen.recipe.layout();
    if plan.ships() && chosen.shipped.is_none() {
        lines.push(format!("{of}it has no compact form: bytes are those on a GPU"));
    }
    if !chosen.recipe.terms().any() {
        lines.push("it has no terms: how much light a lobe holds comes from elsewhere".to_owned());
    }
    if layout.only_ranges().is_some() && !plan.needs.is_isotropic() {
        lines.push(format!(
            "tables of layout {layout} have no direction along the surface: materials that have one are lit as round"
        ));
    }
    if !is_met && plan.beside.is_table_readable {
        lines.push(format!("{of}{}", unmet(plan)));
    }
    lines
}

/// Why the lobes of a table are those that they are, where a scene has both metal and dielectrics.
fn lobes_in_words(plan: &TablePlan<'_>) -> Option<String> {
    let chosen = plan.chosen.recipe.model().fresnel();
    let error =
        |is_two: bool| plan.lobes().find(|(fresnel, _)| fresnel.second().is_some() == is_two).map(|(_, error)| error);
    let of_one = error(false)?;
    Some(match (chosen.second(), error(true)) {
        (Some(_), Some(of_two)) => format!(
            "metal and dielectrics have two lobes an entry, blended: by themselves they are off by {of_two:.4}, the best single \
             one by {of_one:.4}; shader --two-lobes reads them"
        ),
        (_, of_two) => {
            let two = of_two.map_or_else(String::new, |error| format!(", two lobes an entry by {error:.4}"));
            format!("one lobe serves metal and dielectrics, that of {chosen}: by itself it is off by {of_one:.4}{two}")
        }
    })
}

/// What a budget that cannot be met is told.
fn unmet(plan: &TablePlan<'_>) -> String {
    let chosen = &plan.chosen;
    match plan.budget {
        Budget::Error(most) => match plan.measured {
            Some(measured) => format!("an error of {most} is not reached: the nearest table has {:.4}", measured.error),
            None => format!("an error of {most} cannot be had: the least that is expected is {:.4}", chosen.error),
        },
        Budget::Bytes(most) => match plan.fitted.iter().filter_map(|fitted| fitted.shipped).min() {
            Some(least) => {
                format!("{most} bytes are not reached: of the tables that were fitted the smallest has {least}")
            }
            None => format!("{most} bytes are too few: the smallest table has {}", chosen.spent()),
        },
        Budget::Seconds(most) => format!("{most} s are too few: the fastest fit takes {:.3} s", chosen.seconds),
        Budget::Knee => "no table serves it".to_owned(),
    }
}

fn plural(n: usize, one: &str) -> String {
    if n == 1 { format!("1 {one}") } else { format!("{n} {one}s") }
}

fn bytes_in_words(bytes: u64) -> String {
    if bytes < 1000 { format!("{bytes} bytes") } else { format!("{:.1} KB", bytes as f64 / 1000.0) }
}
