//! A plan in words, one fact per line.

use std::collections::BTreeMap;

use crate::{
    candidates::Budget,
    figures::{Figure, Help},
    histogram::{LEAST_METAL, span},
    plan::TablePlan,
    scene::{Scene, SceneMaterial},
    without::text_cost_of,
};
use ltcforge_files::recipe_document::Preset;
use ltcforge_fit::{BrdfKind, WeightedF0};
use ltcforge_shaders::GpuCost;

/// Maximum number of lines about materials.
const MOST_LINES: usize = 12;
/// A table is worse than another if its error is above this factor of the other's.
const WORSE: f64 = 1.02;
/// Maximum number of names in a line.
const MOST_NAMES: usize = 4;

/// The summary of a scene's plans: first the advice, then a line for each material, then what is left out. `is_verbose`
/// adds nodes, samples and registers.
#[must_use]
pub fn words(scene: &Scene, plans: &[TablePlan<'_>], is_verbose: bool) -> Vec<String> {
    let lights = match scene.lights.len() {
        0 => String::new(),
        n => format!(", {}", plural(n, "light")),
    };
    let views = match scene.cameras {
        0 => "seen from all directions".to_owned(),
        n => format!("seen from {}", plural(n, "camera")),
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
        let (mut figures, dark): (Vec<&Figure>, Vec<&Figure>) = plan.figures.iter().partition(|figure| figure.is_lit);
        figures.sort_by(|a, b| b.share.total_cmp(&a.share));
        lines.extend(figures.iter().take(MOST_LINES).map(|figure| material_line(scene, figure)));
        if figures.len() > MOST_LINES {
            lines.push(format!("  and {} more: `materials` in plan.json", figures.len() - MOST_LINES));
        }
        lines.extend(two_sets(plan));
        if !dark.is_empty() {
            lines.push(format!("no light reaches {}", names(dark.iter().map(|figure| figure.name(scene)).collect())));
        }
        lines.extend(unmet(plan));
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

/// The table that the plan's table is compared with.
fn stock(plan: &TablePlan<'_>) -> String {
    plan.engine_table().map_or("the default table".to_owned(), |engine| format!("the table that {engine} ships"))
}

/// The unit of the errors by which tables are chosen.
fn unit(plan: &TablePlan<'_>) -> &'static str {
    if plan.probes.are_lit() { "of the light" } else { "lobe widths" }
}

/// The choice that serves a scene best.
fn advice(scene: &Scene, plan: &TablePlan<'_>) -> String {
    if plan.figures.iter().all(|figure| !figure.is_lit) {
        return "No light of the scene reaches these materials, so errors are not known.".to_owned();
    }
    let size = in_bytes(plan.fitted.last().and_then(|fitted| fitted.shipped).unwrap_or(plan.chosen.spent()));
    let [Some(table), other, _] = plan.light else {
        return format!("Use this table of {size}: its error is {:.4} {}.", plan.chosen.error, unit(plan));
    };
    let worst = plan.worst().filter(|_| plan.figures.len() > 1).map_or_else(String::new, |worst| {
        format!("; its worst material is {} ({:.0} % of the surface)", worst.name(scene), 100.0 * worst.share)
    });
    let light = plan.worst_light.filter(|_| scene.lights.len() > 1);
    let light = light.map_or_else(String::new, |(light, _)| format!("; its worst light is {light}"));
    let against = match other {
        Some(other) => format!("{} {}", compared(table, other), stock(plan)),
        None => format!("off by {table:.5} of the light"),
    };
    match plan.form_first() {
        Some((without, error)) => format!(
            "Use the closed form ({}): no table, {} this plan's table. A table of {size} would be {against}{worst}{light}.",
            without.in_words(),
            compared(error, table)
        ),
        None => match other.filter(|other| plan.engine_table().is_some() && table > WORSE * other) {
            Some(_) => format!("Keep {}: a table of {size} would be {against}{worst}{light}.", stock(plan)),
            None => format!("Use this table of {size}: it is {against}{worst}{light}."),
        },
    }
}

/// The errors of the light with an engine's own table, this table and the closed form, and a warning if this table is
/// worse than the engine's.
fn engine_lines(scene: &Scene, plan: &TablePlan<'_>) -> Vec<String> {
    let Some(engine) = plan.form.engine else { return Vec::new() };
    let form = plan.without().map_or("no closed form".to_owned(), |form| format!("closed form, {}", form.in_words()));
    let called = [stock(plan), "this table".to_owned(), form];
    let [table, other, form] = plan.light;
    let line = |(name, error): (String, Option<f64>)| Some(format!("  {name}: error {:.5}", error?));
    let mut lines: Vec<String> = called.into_iter().zip([other, table, form]).filter_map(line).collect();
    let worse = |figure: &Figure| {
        let [table, other, _] = figure.light;
        let (table, other) = table.zip(other).filter(|(table, other)| *table > WORSE * other)?;
        Some(format!("{} ({table:.5} against {other:.5})", figure.name(scene)))
    };
    let worse: Vec<String> = plan.figures.iter().filter_map(worse).collect();
    if !worse.is_empty() && plan.engine_table().is_some() {
        lines.push(format!("warning: farther from the truth than the table that {engine} ships on {}", names(worse)));
    }
    lines
}

/// The first names, and the number of the others.
fn names(mut all: Vec<String>) -> String {
    let more = all.len().saturating_sub(MOST_NAMES);
    all.truncate(MOST_NAMES);
    all.join(", ") + &if more > 0 { format!(" and {more} more") } else { String::new() }
}

/// A material: its roughness, its share, its error, and the ways to a smaller error.
fn material_line(scene: &Scene, figure: &Figure) -> String {
    let spots = scene.materials[figure.material].lobes.iter().filter(|lobe| lobe.kind == figure.kind);
    let [low, high] = span(spots.flat_map(|lobe| &lobe.spots).map(|spot| spot.alpha.sqrt()));
    let roughness = if high - low < 0.005 { format!("{low:.2}") } else { format!("{low:.2} to {high:.2}") };
    let help = |help: &Help| match help {
        Help::ClosedForm => format!("the closed form ({:.5})", figure.light[2].unwrap_or_default()),
        other => other.in_words().to_owned(),
    };
    let helps: Vec<String> = figure.helps.iter().map(help).collect();
    let helps =
        if helps.is_empty() { "no table does better".to_owned() } else { format!("better: {}", helps.join(", ")) };
    let (name, share, error) = (figure.name(scene), 100.0 * figure.share, figure.shown());
    let unit = if figure.light[0].is_none() { " lobe widths" } else { "" };
    format!("  {name}: roughness {roughness}, {share:.0} % of the surface, error {error:.5}{unit}; {helps}")
}

/// The commands that fit a table for metal and a table for plastic, if both together help.
fn two_sets(plan: &TablePlan<'_>) -> Vec<String> {
    let is_wanted = plan.figures.iter().any(|figure| figure.helps.contains(&Help::SecondSet));
    let layout = plan.whole.recipe.layout;
    let line = |WeightedF0 { f0, .. }: WeightedF0| {
        let kind = if f0 < LEAST_METAL { "plastic" } else { "metal" };
        let recipe = format!(r#"{{"layout": "{layout}", "fresnel": [{{"f0": {f0}}}]}}"#);
        format!("  a set for {kind}: echo '{recipe}' | ltcforge fit - -o {kind}")
    };
    plan.needs.reflectances().into_iter().filter(|_| is_wanted).map(line).collect()
}

const NOTE: &str = "note: ";

/// The parts of a scene's light that no table covers, grouped, and notes about parts of the scene that were not read.
#[must_use]
pub fn left_out(scene: &Scene) -> Vec<String> {
    let mut groups: BTreeMap<(&str, &str), Vec<&str>> = BTreeMap::new();
    for SceneMaterial { name, lobes, uncovered, .. } in &scene.materials {
        let hidden = (lobes.is_empty() && uncovered.is_empty()).then_some("no part of it is visible");
        for what in uncovered.iter().map(String::as_str).chain(hidden) {
            groups.entry(("not covered on ", what)).or_default().push(name);
        }
    }
    // Notes that differ only in the name at their start and in numbers are one note.
    let mut notes: BTreeMap<String, (&str, Vec<&str>)> = BTreeMap::new();
    for note in &scene.notes {
        let (of, what) = note.split_once(": ").unwrap_or(("", note));
        notes.entry(what.replace(|c: char| c.is_ascii_digit(), "")).or_insert((what, Vec::new())).1.push(of);
    }
    groups.extend(notes.into_values().map(|(what, names)| ((NOTE, what), names)));
    let line = |((kind, what), names): ((&str, &str), Vec<&str>)| match names[..] {
        [""] => format!("{kind}{what}"),
        [name] => format!("{kind}{name}: {what}"),
        [name, ..] if kind == NOTE => format!("{kind}{name} and {} more: {what}", names.len() - 1),
        _ => format!("{kind}{} materials: {what}", names.len()),
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
    let preset = Preset::ALL.into_iter().find(|preset| preset.fit() == recipe.fit).map_or("custom", Preset::name);
    let measured = plan.measured().map_or_else(String::new, |fitted| format!("; measured {:.4}", fitted.error));
    let whole_error = whole.error.map_or_else(String::new, |error| format!(", error {error:.4}"));
    let remains = chosen.limit.map_or_else(String::new, |limit| format!("; more nodes cannot remove {limit:.4} of it"));
    let cost = |cost: Option<GpuCost>| match cost {
        Some(cost) => format!("{} registers, {} instructions", cost.registers, cost.instructions),
        None => "not counted".to_owned(),
    };
    let without = plan.without().map_or_else(String::new, |without| {
        format!("; without a table: model {}, {}", without.name(", rule "), cost(without.gpu_cost))
    });
    vec![
        format!(
            "{surfaces} x {theta} x {phi} nodes, {} as {}, preset {}, {:.1} s on one core: expected error {:.4} {}{remains}{measured}",
            in_bytes(chosen.bytes),
            recipe.precision,
            preset,
            chosen.seconds,
            chosen.error,
            unit(plan)
        ),
        format!("lobes fitted to {}", recipe.brdf.fresnel()),
        format!("the table of the whole domain: {}{whole_error}", in_bytes(whole.recipe.bytes())),
        format!("shader of the table: {}{without}", cost(text_cost_of(recipe))),
    ]
}

/// Facts about the table that its user must know.
fn conditions(plan: &TablePlan<'_>) -> Vec<String> {
    let recipe = &plan.chosen.recipe;
    let layout = recipe.layout;
    let isotropic = format!("tables of layout {layout} are isotropic; anisotropic materials look isotropic");
    let facts = [
        (
            recipe.brdf.fresnel().second().is_some(),
            "metal and dielectrics have two lobes per entry: use shader --two-lobes",
        ),
        (
            plan.form.ship && plan.chosen.shipped.is_none(),
            "the table has no compact form; the budget counts its bytes on a GPU",
        ),
        (!recipe.terms.any(), "the table has no terms: your renderer must supply the energy of each lobe"),
        (layout.only_ranges().is_some() && !plan.needs.is_isotropic(), &isotropic),
    ];
    facts.into_iter().filter(|(holds, _)| *holds).map(|(_, fact)| fact.to_owned()).collect()
}

/// The reasons that a budget or the GPU limits are not met.
fn unmet(plan: &TablePlan<'_>) -> Vec<String> {
    let chosen = &plan.chosen;
    let budget = match plan.budget {
        Budget::Error(most) => {
            let error = plan.measured().map_or(chosen.error, |fitted| fitted.error);
            let unit = unit(plan);
            format!("no table has an error of {most} {unit} or less: the nearest table has {error:.4}")
        }
        Budget::Bytes(most) => {
            let least = plan.fitted.iter().filter_map(|fitted| fitted.shipped).min().unwrap_or(chosen.spent());
            format!("no table fits in {most} bytes: the smallest needs {least}")
        }
        Budget::Seconds(most) => {
            format!("no table can be fitted in {most} s: the fastest takes {:.3} s", chosen.seconds)
        }
        Budget::Knee => "no table is within the limits".to_owned(),
    };
    let is_readable = plan.is_readable(chosen);
    let cheapest = plan.without_table.iter().min_by_key(|model| model.gpu_cost.map(|cost| cost.instructions));
    let cheapest = cheapest.filter(|_| plan.without().is_none()).map(|model| {
        let (name, needs) = (model.name(" "), model.gpu_cost.map_or(0, |cost| cost.instructions));
        format!("no model without a table is within the GPU limits: {name} needs {needs} instructions")
    });
    let mut lines = Vec::new();
    lines.extend((!plan.is_met && is_readable).then_some(budget));
    lines.extend((!is_readable).then(|| "the table's shader exceeds the GPU limits".to_owned()));
    lines.extend(cheapest);
    lines
}

fn plural(n: usize, one: &str) -> String {
    if n == 1 { format!("1 {one}") } else { format!("{n} {one}s") }
}

fn in_bytes(bytes: u64) -> String {
    if bytes < 1000 { format!("{bytes} bytes") } else { format!("{:.1} KB", bytes as f64 / 1000.0) }
}
