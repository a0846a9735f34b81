//! A plan as a picture, `plan.svg`: the scene's roughnesses with the nodes of its table, and the front of error against
//! bytes with the choice.

use std::{collections::BTreeMap, fmt::Write as _};

use crate::{
    Spot,
    plan::{TablePlan, WholeAt},
};

const WIDTH: f64 = 1120.0;
/// Height of a table's part of the picture: panels, and around them.
const PART: f64 = 520.0;
const TOP: f64 = 56.0;
const PANEL: [f64; 2] = [480.0, 400.0];
const LEFT: [f64; 2] = [64.0, 612.0];
/// The radius of the mark of a roughness that all of a surface has.
const LARGEST: f64 = 22.0;
const LEAST: f64 = 1.5;
/// Roughnesses that are marked one by one, those of the most surface.
const MOST_MARKS: usize = 200;
/// Cells of each axis over which the others are told.
const CELLS: usize = 32;

/// Light and dark colours in one file; the viewer's preference picks.
const STYLE: &str = include_str!("picture.css");

/// The plans of a scene's tables as SVG, one below the other.
#[must_use]
pub fn picture(plans: &[TablePlan<'_>]) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = write_all(&mut out, plans);
    out
}

fn write_all(out: &mut String, plans: &[TablePlan<'_>]) -> std::fmt::Result {
    let height = PART * plans.len() as f64;
    writeln!(
        out,
        r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" width="{WIDTH}" height="{height}" role="img" aria-label="The roughnesses of a scene with the nodes of its table, and the error of tables against their bytes">"#
    )?;
    writeln!(out, "<style>\n{STYLE}</style>")?;
    writeln!(out, r#"<rect class="paper" width="{WIDTH}" height="{height}"/>"#)?;
    for (index, plan) in plans.iter().enumerate() {
        writeln!(out, r#"<g transform="translate(0 {:.0})">"#, PART * index as f64)?;
        write_spots(out, plan)?;
        write_front(out, plan)?;
        writeln!(out, "</g>")?;
    }
    writeln!(out, "</svg>")
}

/// A panel's frame and title.
fn write_frame(out: &mut String, left: f64, title: &str, across: &str) -> std::fmt::Result {
    let ([width, height], bottom) = (PANEL, TOP + PANEL[1]);
    writeln!(out, r#"<text class="title" x="{left}" y="32">{title}</text>"#)?;
    writeln!(out, r#"<rect class="frame" x="{left}" y="{TOP}" width="{width}" height="{height}"/>"#)?;
    writeln!(out, r#"<text class="middle" x="{:.0}" y="{:.0}">{across}</text>"#, left + 0.5 * width, bottom + 40.0)
}

/// Roughnesses by perceptual roughness and ratio, with the nodes.
fn write_spots(out: &mut String, plan: &TablePlan<'_>) -> std::fmt::Result {
    let left = LEFT[0];
    let x = |alpha: f64| left + PANEL[0] * alpha.sqrt();
    let y = |ratio: f64| TOP + PANEL[1] * (1.0 - ratio);
    write_frame(out, left, "Smaller over larger roughness, and the nodes", "perceptual roughness")?;
    let nodes = plan.chosen.recipe.nodes();
    let materials = plan.chosen.recipe.given().materials();
    for [alpha, ratio] in &materials {
        let (at, up) = (x(*alpha), y(*ratio));
        writeln!(out, r#"<path class="node" d="M{:.1} {up:.1}h24M{at:.1} {:.1}v24"/>"#, at - 12.0, up - 12.0)?;
    }
    let is_grid = materials.is_empty();
    for alpha in nodes.alpha.iter().filter(|_| is_grid) {
        writeln!(out, r#"<path class="node" d="M{:.1} {TOP}v{}"/>"#, x(*alpha), PANEL[1])?;
    }
    for ratio in nodes.ratio.iter().filter(|_| is_grid) {
        writeln!(out, r#"<path class="node" d="M{left} {:.1}h{}"/>"#, y(*ratio), PANEL[0])?;
    }
    let mut spots: Vec<&Spot> = plan.needs.lobes().iter().flat_map(|(_, lobe)| &lobe.spots).collect();
    spots.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    let total: f64 = spots.iter().map(|spot| spot.weight).sum();
    let (marked, rest) = spots.split_at(spots.len().min(MOST_MARKS));
    write_cells(out, rest, total)?;
    for spot in marked {
        let radius = (LARGEST * (spot.weight / total).sqrt()).max(LEAST);
        writeln!(out, r#"<circle class="spot" cx="{:.1}" cy="{:.1}" r="{radius:.1}"/>"#, x(spot.alpha), y(spot.ratio))?;
    }
    for tick in [0.0, 0.25, 0.5, 0.75, 1.0] {
        let (at, up) = (left + PANEL[0] * tick, y(tick));
        writeln!(out, r#"<text class="middle" x="{at:.0}" y="{:.0}">{tick}</text>"#, TOP + PANEL[1] + 20.0)?;
        writeln!(out, r#"<text class="end" x="{:.0}" y="{:.0}">{tick}</text>"#, left - 8.0, up + 4.0)?;
    }
    Ok(())
}

/// Roughnesses that are too many to mark one by one: squares, each as large as a mark of all of its cell, and how many they are.
fn write_cells(out: &mut String, spots: &[&Spot], total: f64) -> std::fmt::Result {
    let mut cells = BTreeMap::new();
    let cell = |x: f64| ((x * CELLS as f64) as usize).min(CELLS - 1);
    for spot in spots {
        *cells.entry([cell(spot.alpha.sqrt()), cell(spot.ratio)]).or_insert(0.0) += spot.weight;
    }
    for ([across, up], weight) in &cells {
        let half = (LARGEST * (weight / total).sqrt()).max(LEAST);
        let at = |cell: usize| (cell as f64 + 0.5) / CELLS as f64;
        let (x, y) = (LEFT[0] + PANEL[0] * at(*across), TOP + PANEL[1] * (1.0 - at(*up)));
        let side = 2.0 * half;
        writeln!(
            out,
            r#"<rect class="spot" x="{:.1}" y="{:.1}" width="{side:.1}" height="{side:.1}"/>"#,
            x - half,
            y - half
        )?;
    }
    if spots.is_empty() {
        return Ok(());
    }
    let part = 100.0 * spots.iter().map(|spot| spot.weight).sum::<f64>() / total;
    let (right, count) = (LEFT[0] + PANEL[0], spots.len());
    writeln!(
        out,
        r#"<text class="end" x="{right:.0}" y="{:.0}">squares: {count} roughnesses more, {part:.1} % of the surface</text>"#,
        TOP - 8.0
    )
}

/// Errors by bytes: the front, the choice and the table of the whole domain.
fn write_front(out: &mut String, plan: &TablePlan<'_>) -> std::fmt::Result {
    let left = LEFT[1];
    write_frame(out, left, "Error on the scene against bytes", "bytes of matrices and terms")?;
    let whole = plan.whole.error.or(plan.whole.predicted).map(|error| (plan.whole.bytes, error));
    let bytes = || plan.front().map(|candidate| candidate.bytes).chain(whole.map(|(bytes, _)| bytes));
    let decades = [bytes().min().unwrap_or(1), bytes().max().unwrap_or(1)].map(|bytes| log10(bytes as f64));
    let [first, last] = [decades[0].floor(), decades[1].ceil().max(decades[0].floor() + 1.0)];
    // Coarser tables than this are not of interest, and would press the rest together.
    let reach = 2.0 * plan.chosen.error.max(whole.map_or(0.0, |(_, error)| error));
    let x = |bytes: u64| left + PANEL[0] * (log10(bytes as f64) - first) / (last - first);
    let y = |error: f64| TOP + PANEL[1] * (1.0 - error / reach);
    for decade in first as i32..=last as i32 {
        let at = left + PANEL[0] * (f64::from(decade) - first) / (last - first);
        writeln!(out, r#"<path class="grid" d="M{at:.1} {TOP}v{}"/>"#, PANEL[1])?;
        let text = ["1", "10", "100", "1 K", "10 K", "100 K", "1 M", "10 M", "100 M"];
        let text = text.get(decade.unsigned_abs() as usize).unwrap_or(&"");
        writeln!(out, r#"<text class="middle" x="{at:.0}" y="{:.0}">{text}</text>"#, TOP + PANEL[1] + 20.0)?;
    }
    let step = tick_step(reach);
    for error in (0..).map(|tick| step * f64::from(tick)).take_while(|error| *error <= reach) {
        writeln!(out, r#"<text class="end" x="{:.0}" y="{:.0}">{error:.3}</text>"#, left - 8.0, y(error) + 4.0)?;
    }
    writeln!(out, r#"<path class="limit" d="M{left} {:.1}h{}"/>"#, y(plan.limit), PANEL[0])?;
    let points: Vec<String> = plan
        .front()
        .filter(|candidate| candidate.error <= reach)
        .map(|candidate| format!("{:.1} {:.1}", x(candidate.bytes), y(candidate.error)))
        .collect();
    if !points.is_empty() {
        writeln!(out, r#"<path class="front" d="M{}"/>"#, points.join("L"))?;
    }
    let mut mark = |class: &str, bytes: u64, error: f64, name: &str| {
        let (at, up) = (x(bytes), y(error));
        let (anchor, beside) = if at > left + 0.6 * PANEL[0] { ("end", -12.0) } else { ("", 12.0) };
        writeln!(out, r#"<circle class="{class}" cx="{at:.1}" cy="{up:.1}" r="6"/>"#)?;
        if name.is_empty() {
            return Ok(());
        }
        writeln!(out, r#"<text class="{anchor}" x="{:.1}" y="{:.1}">{name}</text>"#, at + beside, up - 10.0)
    };
    mark("chosen", plan.chosen.bytes, plan.chosen.error, "expected")?;
    if let Some(measured) = plan.measured {
        mark("measured", plan.chosen.bytes, measured.error, "")?;
    }
    if let Some((bytes, error)) = whole {
        mark("whole", bytes, error, "whole domain, presets draft to best")?;
        for WholeAt { preset, error, seconds } in plan.whole.presets().iter().filter(|at| at.error <= reach) {
            let (at, up) = (x(bytes), y(*error));
            writeln!(
                out,
                r#"<circle class="whole" cx="{at:.1}" cy="{up:.1}" r="3"><title>whole domain, preset {preset}: error {error:.4}, {seconds:.1} s</title></circle>"#
            )?;
        }
    }
    writeln!(
        out,
        r#"<text class="end" x="{:.1}" y="{:.1}">stays with {}</text>"#,
        left + PANEL[0] - 8.0,
        y(plan.limit) + 16.0,
        plan.limit_stays_with()
    )
}

/// A step of one, two or five parts of a power of ten, by which a range has three to eight ticks.
fn tick_step(range: f64) -> f64 {
    let power = ltcforge_fit::math::pow(10.0, log10(range / 3.0).floor());
    [5.0, 2.0, 1.0].map(|part| part * power).into_iter().find(|step| *step <= range / 3.0).unwrap_or(power)
}

fn log10(x: f64) -> f64 {
    ltcforge_fit::math::ln(x) / std::f64::consts::LN_10
}
