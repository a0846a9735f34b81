//! A plan in words, one fact per line.

use crate::{
    candidates::Budget,
    effort::in_words as effort_in_words,
    plan::TablePlan,
    scene::{Scene, SceneMaterial},
};
use ltcforge_fit::BrdfKind;

/// The summary of a scene's plans.
#[must_use]
pub fn words(scene: &Scene, plans: &[TablePlan<'_>]) -> Vec<String> {
    let is_anisotropic = |material: &&SceneMaterial| material.lobes.iter().any(|lobe| !lobe.is_isotropic());
    let anisotropic = scene.materials.iter().filter(is_anisotropic).count();
    let views = match scene.cameras {
        0 => "every view".to_owned(),
        n => format!("the views of {}", plural(n, "camera")),
    };
    let mut lines = vec![format!("{}, {anisotropic} anisotropic; {views}", plural(scene.materials.len(), "material"))];
    lines.extend(plans.iter().flat_map(words_of));
    lines.extend(left_out(scene));
    lines
}

/// The parts of a scene's light that no table covers, and notes about parts of the scene that were not read.
#[must_use]
pub fn left_out(scene: &Scene) -> Vec<String> {
    let mut lines = Vec::new();
    for material in &scene.materials {
        lines.extend(material.uncovered.iter().map(|what| format!("not covered, {}: {what}", material.name)));
        if material.lobes.is_empty() && material.uncovered.is_empty() {
            lines.push(format!("not covered, {}: no part of it is visible", material.name));
        }
    }
    lines.extend(scene.notes.iter().map(|note| format!("note: {note}")));
    lines
}

fn words_of(plan: &TablePlan<'_>) -> Vec<String> {
    let TablePlan { chosen, limit, whole, .. } = plan;
    let recipe = &chosen.recipe;
    let prefix = if plan.needs.brdf == BrdfKind::Ggx { "" } else { "sheen: " };
    let [alpha, ratio, theta, phi] = recipe.resolution.named().map(|(_, n)| *n);
    let surfaces = if recipe.layout.is_of_materials() {
        format!("layout materials, {}", plural(alpha as usize, "material"))
    } else {
        format!("{alpha} x {ratio}")
    };
    let shipped = chosen.shipped.map_or_else(String::new, |predicted| {
        let encoded = plan.fitted.last().and_then(|fitted| fitted.shipped);
        let about = if encoded.is_some() { "" } else { "about " };
        format!(" ({about}{} in its compact form)", in_bytes(encoded.unwrap_or(predicted)))
    });
    let measured = plan.measured().map_or_else(String::new, |fitted| {
        let time = |seconds: f64| format!(", fitted in {seconds:.1} processor seconds");
        format!("; measured {:.4}{}", fitted.error, fitted.seconds.map_or_else(String::new, time))
    });
    let mut lines = vec![format!(
        "{prefix}{surfaces} x {theta} x {phi} nodes, {}{shipped} as {}, {}, {:.1} s on one core: expected error {:.4}, of \
         which {limit:.4} remains with {}{measured}",
        in_bytes(chosen.bytes),
        recipe.precision,
        effort_in_words(&recipe.fit),
        chosen.seconds,
        chosen.error,
        plan.limit_remains_with()
    )];
    lines.extend(lobes_in_words(plan));
    let error = whole.known_error();
    let error = error.map_or_else(String::new, |error| format!(", with an error of {error:.4} on this scene"));
    lines.push(format!("{prefix}the table of the whole domain has {}{error}", in_bytes(whole.bytes)));
    lines.extend(plan.shading.words());
    if plan.form.ship && chosen.shipped.is_none() {
        lines.push(format!("{prefix}the table has no compact form; the budget counts its bytes on a GPU"));
    }
    if !recipe.terms.any() {
        lines.push("the table has no terms; the energy of its lobes must come from elsewhere".to_owned());
    }
    if recipe.layout.only_ranges().is_some() && !plan.needs.is_isotropic() {
        let layout = recipe.layout;
        lines.push(format!(
            "tables of layout {layout} are isotropic; they light anisotropic materials as isotropic ones"
        ));
    }
    if !plan.is_met && plan.shading.is_table_readable {
        lines.push(format!("{prefix}{}", unmet(plan)));
    }
    lines
}

/// The choice of lobes, for a scene with both metal and dielectrics.
fn lobes_in_words(plan: &TablePlan<'_>) -> Option<String> {
    let error = |is_two| plan.lobes().find(|(lobes, _)| lobes.second().is_some() == is_two).map(|(_, error)| error);
    let one = error(false)?;
    let two = error(true).map_or_else(String::new, |two| format!(", of two lobes {two:.4}"));
    let chosen = plan.chosen.recipe.brdf.fresnel();
    let choice = if chosen.second().is_some() {
        "metal and dielectrics have two lobes per entry, blended; use shader --two-lobes".to_owned()
    } else {
        format!("one lobe serves metal and dielectrics: {chosen}")
    };
    Some(format!("{choice}; without a table, the error of one lobe is {one:.4}{two}"))
}

/// The reason that a budget is not met.
fn unmet(plan: &TablePlan<'_>) -> String {
    let chosen = &plan.chosen;
    match plan.budget {
        Budget::Error(most) => {
            let error = plan.measured().map_or(chosen.error, |fitted| fitted.error);
            format!("no table has an error of {most} or less: the nearest table has {error:.4}")
        }
        Budget::Bytes(most) => {
            let least = plan.fitted.iter().filter_map(|fitted| fitted.shipped).min().unwrap_or(chosen.spent());
            format!("{most} bytes are too few: the smallest table has {least}")
        }
        Budget::Seconds(most) => format!("{most} s are too few: the fastest fit takes {:.3} s", chosen.seconds),
        Budget::Knee => "no table is within the limits".to_owned(),
    }
}

fn plural(n: usize, one: &str) -> String {
    if n == 1 { format!("1 {one}") } else { format!("{n} {one}s") }
}

fn in_bytes(bytes: u64) -> String {
    if bytes < 1000 { format!("{bytes} bytes") } else { format!("{:.1} KB", bytes as f64 / 1000.0) }
}
