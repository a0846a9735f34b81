//! A plan in words, one fact per line.

use std::collections::BTreeMap;

use crate::{
    candidates::Budget,
    effort::in_words as effort_in_words,
    figures::Figure,
    histogram::span,
    plan::TablePlan,
    scene::{LobeKind, Scene},
    without::FAR_NEARER,
};
use ltcforge_fit::BrdfKind;

/// Maximum number of lines about materials.
const MOST_LINES: usize = 12;
/// A table is worse than another if its error is above this factor of the other's.
const WORSE: f64 = 1.02;
/// More nodes help if they can remove this part of the error.
const NODES_HELP: f64 = 0.2;

/// The summary of a scene's plans: first the advice, then a line for each material, then what is left out. `is_verbose`
/// adds nodes, samples and registers.
#[must_use]
pub fn words(scene: &Scene, plans: &[TablePlan<'_>], is_verbose: bool) -> Vec<String> {
    let lights = match scene.lights.len() {
        0 => String::new(),
        n => format!(", {}", plural(n, "light")),
    };
    let views = match scene.cameras {
        0 => "every view".to_owned(),
        n => format!("the views of {}", plural(n, "camera")),
    };
    let mut lines = Vec::new();
    for plan in plans {
        let prefix = if plan.needs.brdf == BrdfKind::Ggx { "" } else { "Sheen: " };
        lines.push(format!(
            "{prefix}{}, {views}{lights}. {}",
            plural(scene.materials.len(), "material"),
            advice(scene, plan)
        ));
        lines.extend(engine_lines(scene, plan));
        let mut figures: Vec<&Figure> = plan.figures.iter().collect();
        figures.sort_by(|a, b| b.share.total_cmp(&a.share));
        lines.extend(figures.iter().take(MOST_LINES).map(|figure| material_line(scene, plan, figure)));
        if figures.len() > MOST_LINES {
            lines.push(format!("  and {} more: `materials` in plan.json", figures.len() - MOST_LINES));
        }
        if !plan.is_met && plan.shading.is_table_readable {
            lines.push(unmet(plan));
        }
        lines.extend(plan.shading.beyond());
        lines.extend(conditions(plan));
        if is_verbose {
            lines.extend(words_of(plan));
        }
    }
    lines.extend(left_out(scene));
    lines
}

/// How many times an error is nearer or farther than another.
fn compared(error: f64, than: f64) -> String {
    let ratio = error.max(1e-6) / than.max(1e-6);
    match ratio {
        0.95..1.05 => "as near as".to_owned(),
        0.0..0.95 => format!("{:.1} times nearer than", 1.0 / ratio),
        _ => format!("{ratio:.1} times farther than"),
    }
}

/// What the table is compared with.
fn stock(plan: &TablePlan<'_>) -> String {
    plan.engine_table().map_or("the default table".to_owned(), |engine| format!("the table that {engine} ships"))
}

/// The choice that serves a scene best.
fn advice(scene: &Scene, plan: &TablePlan<'_>) -> String {
    let size = in_bytes(plan.fitted.last().and_then(|fitted| fitted.shipped).unwrap_or(plan.chosen.spent()));
    let [Some(table), other, form] = plan.light_errors() else {
        return format!("The table of {size} has an error of {:.4} lobe widths.", plan.chosen.error);
    };
    let part = |figure: &&Figure| figure.share * figure.light[0].unwrap_or(0.0);
    let worst = plan.figures.iter().max_by(|a, b| part(a).total_cmp(&part(b)));
    let worst = worst.map_or_else(String::new, |worst| {
        let light = plan.worst_light.map_or_else(String::new, |(light, _)| format!(", its worst light {light}"));
        format!("; its worst material is {} ({:.0} % of the surface){light}", name(scene, worst), 100.0 * worst.share)
    });
    let against = match other {
        Some(other) => format!("{} {}{worst}", compared(table, other), stock(plan)),
        None => format!("off by {table:.5} of the light{worst}"),
    };
    match plan.shading.without().zip(form) {
        Some((without, error)) if error <= FAR_NEARER * table => format!(
            "Use the closed form ({}): no table, {} this plan's table. A table of {size} would be {against}.",
            without.in_words(),
            compared(error, table)
        ),
        _ => format!("Use this table of {size}: it is {against}."),
    }
}

/// The errors of the light with an engine's own table, this table and the closed form, and a warning if this table is
/// worse than the engine's.
fn engine_lines(scene: &Scene, plan: &TablePlan<'_>) -> Vec<String> {
    let Some(engine) = plan.form.engine else { return Vec::new() };
    let form =
        plan.shading.without().map_or("no closed form".to_owned(), |form| format!("closed form, {}", form.in_words()));
    let names = [stock(plan), "this table".to_owned(), form];
    let [table, other, form] = plan.light_errors();
    let line = |(name, error): (String, Option<f64>)| Some(format!("  {name}: error {:.5}", error?));
    let mut lines: Vec<String> = names.into_iter().zip([other, table, form]).filter_map(line).collect();
    let worse = |figure: &Figure| {
        let [table, other, _] = figure.light;
        let (table, other) = table.zip(other).filter(|(table, other)| *table > WORSE * other)?;
        Some(format!("{} ({table:.5} against {other:.5})", name(scene, figure)))
    };
    let worse: Vec<String> = plan.figures.iter().filter_map(worse).take(MOST_LINES).collect();
    if !worse.is_empty() && plan.engine_table().is_some() {
        lines.push(format!("warning: farther than the table that {engine} ships on {}", worse.join(", ")));
    }
    lines
}

fn name(scene: &Scene, figure: &Figure) -> String {
    let kind = match figure.kind {
        LobeKind::Base => "",
        LobeKind::Clearcoat => " (clear coat)",
        LobeKind::Sheen => " (sheen)",
    };
    format!("{}{kind}", scene.materials[figure.material].name)
}

/// A material: its roughness, its share, its error, and the way to a smaller error.
fn material_line(scene: &Scene, plan: &TablePlan<'_>, figure: &Figure) -> String {
    let spots = scene.materials[figure.material].lobes.iter().filter(|lobe| lobe.kind == figure.kind);
    let [low, high] = span(spots.flat_map(|lobe| &lobe.spots).map(|spot| spot.alpha.sqrt()));
    let roughness = if high - low < 0.005 { format!("{low:.2}") } else { format!("{low:.2} to {high:.2}") };
    let [table, _, form] = figure.light;
    let error = table.unwrap_or(figure.error);
    let nodes = plan.chosen.error - plan.chosen.limit;
    let help = match (plan.shading.without(), form) {
        (Some(without), Some(form)) if form <= FAR_NEARER * error => {
            format!("closed form ({}): {form:.5}", without.in_words())
        }
        _ if nodes > NODES_HELP * plan.chosen.error => "more bytes help".to_owned(),
        _ => "as near as these lobes can be".to_owned(),
    };
    let (name, share) = (name(scene, figure), 100.0 * figure.share);
    format!("  {name}: roughness {roughness}, {share:.0} % of the surface, error {error:.5}; {help}")
}

/// The parts of a scene's light that no table covers, grouped, and notes about parts of the scene that were not read.
#[must_use]
pub fn left_out(scene: &Scene) -> Vec<String> {
    let mut groups: BTreeMap<(bool, String), Vec<&str>> = BTreeMap::new();
    for material in &scene.materials {
        for what in &material.uncovered {
            groups.entry((false, what.clone())).or_default().push(&material.name);
        }
        if material.lobes.is_empty() && material.uncovered.is_empty() {
            groups.entry((false, "no part of it is visible".to_owned())).or_default().push(&material.name);
        }
    }
    for note in &scene.notes {
        // Notes that start with different names but say the same are one note.
        let (of, what) = note.split_once(": ").unwrap_or(("", note));
        groups.entry((true, what.to_owned())).or_default().push(of);
    }
    let line = |((is_note, what), names): ((bool, String), Vec<&str>)| match (is_note, &names[..]) {
        (false, [name]) => format!("not covered on {name}: {what}"),
        (false, _) => format!("not covered on {} materials: {what}", names.len()),
        (true, [""]) => format!("note: {what}"),
        (true, [name]) => format!("note: {name}: {what}"),
        (true, [name, ..]) => format!("note: {name} and {} more: {what}", names.len() - 1),
        (true, []) => what,
    };
    groups.into_iter().map(line).collect()
}

/// The numbers of the table: nodes, samples, expected and measured errors, registers.
fn words_of(plan: &TablePlan<'_>) -> Vec<String> {
    let TablePlan { chosen, whole, .. } = plan;
    let recipe = &chosen.recipe;
    let [alpha, ratio, theta, phi] = recipe.resolution.named().map(|(_, n)| *n);
    let surfaces = if recipe.layout.is_of_materials() {
        format!("layout materials, {}", plural(alpha as usize, "material"))
    } else {
        format!("{alpha} x {ratio}")
    };
    let measured = plan.measured().map_or_else(String::new, |fitted| format!("; measured {:.4}", fitted.error));
    let whole_error = whole.known_error().map_or_else(String::new, |error| format!(", error {error:.4}"));
    let mut lines = vec![
        format!(
            "{surfaces} x {theta} x {phi} nodes, {} as {}, {}, {:.1} s on one core: expected error {:.4} lobe widths, \
             of which {:.4} remains with any number of nodes{measured}",
            in_bytes(chosen.bytes),
            recipe.precision,
            effort_in_words(&recipe.fit),
            chosen.seconds,
            chosen.error,
            chosen.limit
        ),
        format!("lobes fitted to {}", recipe.brdf.fresnel()),
        format!("the table of the whole domain: {}{whole_error}", in_bytes(whole.bytes)),
    ];
    lines.push(plan.shading.words());
    lines
}

/// Facts about the table that its user must know.
fn conditions(plan: &TablePlan<'_>) -> Vec<String> {
    let recipe = &plan.chosen.recipe;
    let layout = recipe.layout;
    let isotropic =
        format!("tables of layout {layout} are isotropic; they light anisotropic materials as isotropic ones");
    let facts = [
        (
            recipe.brdf.fresnel().second().is_some(),
            "metal and dielectrics have two lobes per entry: use shader --two-lobes",
        ),
        (
            plan.form.ship && plan.chosen.shipped.is_none(),
            "the table has no compact form; the budget counts its bytes on a GPU",
        ),
        (!recipe.terms.any(), "the table has no terms; the energy of its lobes must come from elsewhere"),
        (layout.only_ranges().is_some() && !plan.needs.is_isotropic(), &isotropic),
    ];
    facts.into_iter().filter(|(holds, _)| *holds).map(|(_, fact)| fact.to_owned()).collect()
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
