//! A plan as a picture, `plan.svg`: the scene's roughnesses with the nodes of its table, and the front of error against
//! bytes with the chosen table.

use std::f64::consts::LN_10;

use crate::{histogram::Spot, plan::TablePlan};
use ltcforge_fit::math::{ln, pow};

const WIDTH: f64 = 1120.0;
/// Height of a table's part of the picture.
const PART: f64 = 520.0;
const TOP: f64 = 56.0;
const PANEL: [f64; 2] = [480.0, 400.0];
const LEFT: [f64; 2] = [64.0, 612.0];
/// Radius of the mark for a roughness that covers the whole surface.
const LARGEST: f64 = 22.0;
const LEAST: f64 = 1.5;
/// Maximum number of roughnesses with their own marks. These are the roughnesses with the most surface.
const MOST_MARKS: usize = 200;

/// Light and dark colours in one file. The viewer's preference selects one of them.
const STYLE: &str = include_str!("picture.css");

/// The plans of a scene's tables as SVG, one below the other.
#[must_use]
pub fn picture(plans: &[TablePlan<'_>]) -> String {
    let height = PART * plans.len() as f64;
    let title = "The roughnesses of a scene with the nodes of its table, and the error of tables against their bytes";
    let mut out = vec![
        format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" width="{WIDTH}" height="{height}" role="img" aria-label="{title}">"#
        ),
        format!("<style>\n{STYLE}</style>"),
        format!(r#"<rect class="paper" width="{WIDTH}" height="{height}"/>"#),
    ];
    for (index, plan) in plans.iter().enumerate() {
        out.push(format!(r#"<g transform="translate(0 {:.0})">"#, PART * index as f64));
        draw_spots(&mut out, plan);
        draw_front(&mut out, plan);
        out.push("</g>".to_owned());
    }
    out.push("</svg>\n".to_owned());
    out.join("\n")
}

fn text(class: &str, x: f64, y: f64, text: &str) -> String {
    format!(r#"<text class="{class}" x="{x:.1}" y="{y:.1}">{text}</text>"#)
}

/// The frame and the titles of a panel.
fn frame(left: f64, title: &str, across: &str) -> [String; 3] {
    let [width, height] = PANEL;
    [
        text("title", left, 32.0, title),
        format!(r#"<rect class="frame" x="{left}" y="{TOP}" width="{width}" height="{height}"/>"#),
        text("middle", left + 0.5 * width, TOP + height + 40.0, across),
    ]
}

/// Draws roughnesses by perceptual roughness and ratio, with the nodes.
fn draw_spots(out: &mut Vec<String>, plan: &TablePlan<'_>) {
    let (left, [width, height]) = (LEFT[0], PANEL);
    let x = |alpha: f64| left + width * alpha.sqrt();
    let y = |ratio: f64| TOP + height * (1.0 - ratio);
    out.extend(frame(left, "Smaller over larger roughness, and the nodes", "perceptual roughness"));
    let recipe = &plan.chosen.recipe;
    let nodes = recipe.nodes();
    if recipe.layout.is_of_materials() {
        for [alpha, ratio] in recipe.given.materials() {
            let (at, up) = (x(alpha), y(ratio));
            let (from, above) = (at - 12.0, up - 12.0);
            out.push(format!(r#"<path class="node" d="M{from:.1} {up:.1}h24M{at:.1} {above:.1}v24"/>"#));
        }
    } else {
        let alphas = nodes.alpha.iter().map(|alpha| format!("M{:.1} {TOP}v{height}", x(*alpha)));
        let ratios = nodes.ratio.iter().map(|ratio| format!("M{left} {:.1}h{width}", y(*ratio)));
        out.extend(alphas.chain(ratios).map(|line| format!(r#"<path class="node" d="{line}"/>"#)));
    }
    let mut spots: Vec<&Spot> = plan.needs.spots().map(|(spot, _)| spot).collect();
    spots.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    let total: f64 = spots.iter().map(|spot| spot.weight).sum();
    let radius = |weight: f64| (LARGEST * (weight / total).sqrt()).max(LEAST);
    let (marked, rest) = spots.split_at(spots.len().min(MOST_MARKS));
    if !rest.is_empty() {
        let (part, count) = (100.0 * rest.iter().map(|spot| spot.weight).sum::<f64>() / total, rest.len());
        let words = format!("{count} more roughnesses, {part:.1} % of the surface");
        out.push(text("end", left + width, TOP - 8.0, &words));
    }
    for spot in marked {
        let (at, up, radius) = (x(spot.alpha), y(spot.ratio), radius(spot.weight));
        out.push(format!(r#"<circle class="spot" cx="{at:.1}" cy="{up:.1}" r="{radius:.1}"/>"#));
    }
    for tick in [0.0, 0.25, 0.5, 0.75, 1.0] {
        out.push(text("middle", left + width * tick, TOP + height + 20.0, &tick.to_string()));
        out.push(text("end", left - 8.0, y(tick) + 4.0, &tick.to_string()));
    }
}

/// Draws errors by bytes: the front, the choice and the table of the whole domain.
fn draw_front(out: &mut Vec<String>, plan: &TablePlan<'_>) {
    let (left, [width, height]) = (LEFT[1], PANEL);
    out.extend(frame(left, "Error on the scene against bytes", "bytes of matrices and terms"));
    let whole = plan.whole.known_error().map(|error| (plan.whole.bytes, error));
    let bytes = || plan.front().map(|candidate| candidate.bytes).chain(whole.map(|(bytes, _)| bytes));
    let [least, most] = [bytes().min(), bytes().max()].map(|bytes| log10(bytes.unwrap_or(1) as f64));
    let first = least.floor();
    let last = most.ceil().max(first + 1.0);
    // Tables with larger errors are left out, because they would compress the rest of the plot.
    let reach = 2.0 * plan.chosen.error.max(whole.map_or(0.0, |(_, error)| error));
    let across = |decade: f64| left + width * (decade - first) / (last - first);
    let x = |bytes: u64| across(log10(bytes as f64));
    let y = |error: f64| TOP + height * (1.0 - error / reach);
    for decade in first as usize..=last as usize {
        let at = across(decade as f64);
        out.push(format!(r#"<path class="grid" d="M{at:.1} {TOP}v{height}"/>"#));
        let names = ["1", "10", "100", "1 K", "10 K", "100 K", "1 M", "10 M", "100 M"];
        out.push(text("middle", at, TOP + height + 20.0, names.get(decade).unwrap_or(&"")));
    }
    let step = tick_step(reach);
    for error in (0..).map(|tick| step * f64::from(tick)).take_while(|error| *error <= reach) {
        out.push(text("end", left - 8.0, y(error) + 4.0, &format!("{error:.3}")));
    }
    out.push(format!(r#"<path class="limit" d="M{left} {:.1}h{width}"/>"#, y(plan.chosen.limit)));
    let shown = plan.front().filter(|candidate| candidate.error <= reach);
    let points: Vec<_> =
        shown.map(|candidate| format!("{:.1} {:.1}", x(candidate.bytes), y(candidate.error))).collect();
    if !points.is_empty() {
        out.push(format!(r#"<path class="front" d="M{}"/>"#, points.join("L")));
    }
    let mut mark = |class: &str, bytes: u64, error: f64, name: &str| {
        let (at, up) = (x(bytes), y(error));
        let (anchor, offset) = if at > left + 0.6 * width { ("end", -12.0) } else { ("", 12.0) };
        out.push(format!(r#"<circle class="{class}" cx="{at:.1}" cy="{up:.1}" r="6"/>"#));
        out.push(text(anchor, at + offset, up - 10.0, name));
    };
    mark("chosen", plan.chosen.bytes, plan.chosen.error, "expected");
    if let Some(measured) = plan.measured() {
        mark("measured", plan.chosen.bytes, measured.error, "");
    }
    if let Some((bytes, error)) = whole {
        mark("whole", bytes, error, "whole domain");
    }
    out.push(text("end", left + width - 8.0, y(plan.chosen.limit) + 16.0, "remains with any table of these lobes"));
}

/// The step that gives a range three to eight ticks: 1, 2 or 5 times a power of ten.
fn tick_step(range: f64) -> f64 {
    let power = pow(10.0, log10(range / 3.0).floor());
    [5.0, 2.0, 1.0].map(|part| part * power).into_iter().find(|step| *step <= range / 3.0).unwrap_or(power)
}

fn log10(x: f64) -> f64 {
    ln(x) / LN_10
}
