//! `plan.json` as a picture, `plan.svg`: the scene's roughnesses with the nodes of its table, and the front of error
//! against bytes with the chosen table.

use std::f64::consts::LN_10;

use serde_json::Value;

use ltcforge_files::recipe_document::{DEFAULT_ENTRY_LIMIT, parse};
use ltcforge_fit::math::{ln, pow};

const WIDTH: f64 = 1144.0;
/// Height of a table's part of the picture.
const PART: f64 = 520.0;
const TOP: f64 = 56.0;
const PANEL: [f64; 2] = [480.0, 400.0];
const LEFT: [f64; 2] = [76.0, 636.0];
/// Numbers of named materials and of letters in a name.
const MOST_NAMES: usize = 8;
const LONGEST: usize = 28;
/// Pixels that a name takes.
const WIDEST: f64 = 150.0;
const LINE: f64 = 16.0;
/// Radius of the mark for a roughness that covers the whole surface. The axes keep this distance from the frame.
const LARGEST: f64 = 22.0;
const LEAST: f64 = 1.5;

/// Light and dark colours in one file. The viewer's preference selects one of them.
const STYLE: &str = include_str!("plan.css");

/// The tables of a plan as SVG, one below the other. Domain: a document as `ltcforge plan` writes it; parts that it does
/// not have are not drawn.
#[must_use]
pub fn plan_picture(plan: &Value) -> String {
    let tables = list(&plan["tables"]);
    let height = PART * tables.len() as f64;
    let title = "The materials of a scene with the nodes of its table, and the error of tables against their bytes";
    let mut out = vec![
        format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" width="{WIDTH}" height="{height}" role="img" aria-label="{title}">"#
        ),
        format!("<style>\n{STYLE}</style>"),
        format!(r#"<rect class="paper" width="{WIDTH}" height="{height}"/>"#),
    ];
    for (index, table) in tables.iter().enumerate() {
        out.push(format!(r#"<g transform="translate(0 {:.0})">"#, PART * index as f64));
        draw_spots(&mut out, table, &plan["scene"]);
        draw_front(&mut out, table);
        out.push("</g>".to_owned());
    }
    out.push("</svg>\n".to_owned());
    out.join("\n")
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_default()
}

fn text(class: &str, x: f64, y: f64, text: &str) -> String {
    format!(r#"<text class="{class}" x="{x:.1}" y="{y:.1}">{text}</text>"#)
}

/// The name of a material, without letters that XML reserves.
fn name_of(material: &Value) -> String {
    let is_shown = |letter: &char| !letter.is_control() && !matches!(letter, '<' | '>' | '&');
    material["name"].as_str().unwrap_or_default().chars().filter(is_shown).take(LONGEST).collect()
}

/// The frame of a panel, its title, and the names of its axes.
fn frame(left: f64, title: &str, across: &str, up: &str) -> [String; 4] {
    let [width, height] = PANEL;
    let (at, middle) = (left - 62.0, TOP + 0.5 * height);
    [
        format!(r#"<text class="middle" transform="translate({at} {middle}) rotate(-90)">{up}</text>"#),
        text("title", left, 32.0, title),
        format!(r#"<rect class="frame" x="{left}" y="{TOP}" width="{width}" height="{height}"/>"#),
        text("middle", left + 0.5 * width, TOP + height + 40.0, across),
    ]
}

/// Draws roughnesses by perceptual roughness and ratio, with the nodes.
fn draw_spots(out: &mut Vec<String>, table: &Value, scene: &Value) {
    let (left, [width, height]) = (LEFT[0], PANEL);
    let x = |alpha: f64| left + LARGEST + (width - 2.0 * LARGEST) * alpha.sqrt();
    let y = |ratio: f64| TOP + LARGEST + (height - 2.0 * LARGEST) * (1.0 - ratio);
    out.extend(frame(
        left,
        "Materials (area: share of the surface) and nodes of the table (lines)",
        "perceptual roughness",
        "ratio of roughnesses",
    ));
    if let Ok(recipe) = parse(table["recipe"].to_string().as_bytes(), DEFAULT_ENTRY_LIMIT) {
        let nodes = recipe.nodes();
        if recipe.layout().is_of_materials() {
            for [alpha, ratio] in recipe.given().materials() {
                let (at, up) = (x(alpha), y(ratio));
                let (from, above) = (at - 12.0, up - 12.0);
                out.push(format!(r#"<path class="node" d="M{from:.1} {up:.1}h24M{at:.1} {above:.1}v24"/>"#));
            }
        } else {
            let alphas = nodes.alpha.iter().map(|alpha| format!("M{:.1} {TOP}v{height}", x(*alpha)));
            let ratios = nodes.ratio.iter().map(|ratio| format!("M{left} {:.1}h{width}", y(*ratio)));
            out.extend(alphas.chain(ratios).map(|line| format!(r#"<path class="node" d="{line}"/>"#)));
        }
    }
    let lobes_of = |served: &Value| {
        let material = &scene["materials"][served["material"].as_u64().unwrap_or(u64::MAX) as usize];
        let lobe = list(&material["lobes"]).iter().find(|lobe| lobe["kind"] == served["kind"])?;
        Some((name_of(material), lobe))
    };
    let mut lobes: Vec<(String, &Value)> = list(&table["serves"]).iter().filter_map(lobes_of).collect();
    lobes.sort_by(|(_, a), (_, b)| number(&b["weight"]).total_cmp(&number(&a["weight"])));
    let total: f64 = lobes.iter().map(|(_, lobe)| number(&lobe["weight"])).sum();
    let mut named: Vec<[f64; 2]> = Vec::new();
    for (index, (name, lobe)) in lobes.into_iter().enumerate() {
        let [alpha, ratio] = ["alpha", "ratio"].map(|axis| [0, 1].map(|end| number(&lobe[axis][end])));
        let spots = list(&lobe["spots"]);
        if spots.is_empty() {
            // A lobe of many roughnesses covers a rectangle.
            let (at, up) = (x(alpha[0]), y(ratio[1]));
            let (across, down) = ((x(alpha[1]) - at).max(LEAST), (y(ratio[0]) - up).max(LEAST));
            out.push(format!(r#"<rect class="spot" x="{at:.1}" y="{up:.1}" width="{across:.1}" height="{down:.1}"/>"#));
        }
        if index < MOST_NAMES {
            let spot = |axis: &str, range: [f64; 2]| spots.first().map_or(range[0], |spot| number(&spot[axis]));
            let (at, up) = (x(spot("alpha", alpha)), y(spot("ratio", ratio)));
            // A name is below its mark, and below the names that it would cover.
            let covers = |[x, y]: &[f64; 2], up: f64| (x - at).abs() < WIDEST && (y - up).abs() < LINE;
            let mut up = up + LARGEST + 12.0;
            while named.iter().any(|other| covers(other, up)) {
                up += LINE;
            }
            named.push([at, up]);
            let anchor = if at > left + 0.6 * width { "end" } else { "start" };
            out.push(text(anchor, at, up, &name));
        }
        for spot in spots {
            let (at, up) = (x(number(&spot["alpha"])), y(number(&spot["ratio"])));
            let radius = (LARGEST * (number(&spot["weight"]) / total).sqrt()).max(LEAST);
            out.push(format!(r#"<circle class="spot" cx="{at:.1}" cy="{up:.1}" r="{radius:.1}"/>"#));
        }
    }
    for tick in [0.0, 0.25, 0.5, 0.75, 1.0] {
        out.push(text("middle", x(tick * tick), TOP + height + 20.0, &tick.to_string()));
        out.push(text("end", left - 8.0, y(tick) + 4.0, &tick.to_string()));
    }
}

/// Draws errors by bytes: the front, the choice and the table of the whole domain.
fn draw_front(out: &mut Vec<String>, table: &Value) {
    let (left, [width, height]) = (LEFT[1], PANEL);
    let unit = if table["error_of"] == "light" { "mean error of the light" } else { "mean error, lobe widths" };
    out.extend(frame(left, "Tables for this scene: error against size", "bytes of matrices and terms", unit));
    let point = |of: &Value, error: &str| Some([of["bytes"].as_f64()?, of[error].as_f64()?]);
    let whole = point(&table["whole"], "error");
    let chosen = point(&table["predicted"], "error").unwrap_or([1.0; 2]);
    let mut front: Vec<[f64; 2]> =
        list(&table["candidates"]).iter().filter_map(|row| point(row, "predicted_error")).collect();
    front.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let bytes = || front.iter().chain(&whole).chain([&chosen]).map(|[bytes, _]| log10(*bytes));
    let (least, most) = (bytes().fold(f64::INFINITY, f64::min), bytes().fold(0.0, f64::max));
    let first = least.floor();
    let last = most.ceil().max(first + 1.0);
    // Tables with larger errors are left out, because they would compress the rest of the plot.
    let reach = (2.0 * chosen[1].max(whole.map_or(0.0, |[_, error]| error))).max(f64::MIN_POSITIVE);
    let across = |decade: f64| left + width * (decade - first) / (last - first);
    let x = |bytes: f64| across(log10(bytes));
    let y = |error: f64| TOP + height * (1.0 - error / reach);
    for decade in first as usize..=last as usize {
        let at = across(decade as f64);
        out.push(format!(r#"<path class="grid" d="M{at:.1} {TOP}v{height}"/>"#));
        let names = ["1", "10", "100", "1 K", "10 K", "100 K", "1 M", "10 M", "100 M"];
        out.push(text("middle", at, TOP + height + 20.0, names.get(decade).unwrap_or(&"")));
    }
    let (step, digits) = (tick_step(reach), if reach < 0.01 { 4 } else { 3 });
    for error in (0..).map(|tick| step * f64::from(tick)).take_while(|error| *error <= reach) {
        out.push(text("end", left - 8.0, y(error) + 4.0, &format!("{error:.digits$}")));
    }
    out.push(format!(r#"<path class="limit" d="M{left} {:.1}h{width}"/>"#, y(number(&table["limit"]))));
    let shown = front.iter().filter(|[_, error]| *error <= reach);
    let points: Vec<_> = shown.map(|[bytes, error]| format!("{:.1} {:.1}", x(*bytes), y(*error))).collect();
    if !points.is_empty() {
        out.push(format!(r#"<path class="front" d="M{}"/>"#, points.join("L")));
    }
    let mut mark = |class: &str, [bytes, error]: [f64; 2], name: &str| {
        let (at, up) = (x(bytes), y(error));
        let (anchor, offset) = if at > left + 0.6 * width { ("end", -12.0) } else { ("", 12.0) };
        out.push(format!(r#"<circle class="{class}" cx="{at:.1}" cy="{up:.1}" r="6"/>"#));
        out.push(text(anchor, at + offset, up - 10.0, name));
    };
    mark("chosen", chosen, "this table");
    if let Some(error) = table["measured"]["error"].as_f64() {
        mark("measured", [chosen[0], error], "");
    }
    if let Some(whole) = whole {
        mark("whole", whole, "default table");
    }
    out.push(text("end", left + width - 8.0, y(number(&table["limit"])) + 16.0, "more nodes cannot remove this error"));
}

/// The step that gives a range three to eight ticks: 1, 2 or 5 times a power of ten.
fn tick_step(range: f64) -> f64 {
    let power = pow(10.0, log10(range / 3.0).floor());
    [5.0, 2.0, 1.0].map(|part| part * power).into_iter().find(|step| *step <= range / 3.0).unwrap_or(power)
}

fn log10(x: f64) -> f64 {
    ln(x) / LN_10
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_document_is_drawn_and_one_without_parts_draws_less() {
        let document = serde_json::json!({
            "scene": { "materials": [{ "name": "<glass & b>", "lobes": [
                { "kind": "base", "weight": 1, "alpha": [0.1, 0.1], "ratio": [1, 1],
                  "spots": [{ "alpha": 0.1, "ratio": 1, "weight": 1 }] },
                { "kind": "clearcoat", "weight": 1, "alpha": [0.1, 0.5], "ratio": [1, 1] },
            ] }] },
            "tables": [{
                "recipe": { "range": { "alpha": [0.1, 0.5], "ratio": [1, 1], "phi": [0, 0] } },
                "serves": [{ "material": 0, "kind": "base" }, { "material": 0, "kind": "clearcoat" }],
                "predicted": { "bytes": 400, "error": 0.04 }, "measured": null, "limit": 0.03,
                "whole": { "bytes": 166_320, "error": 0.05 },
                "candidates": [{ "bytes": 400, "predicted_error": 0.04 }, { "bytes": 90, "predicted_error": 0.06 }],
            }],
        });
        let svg = plan_picture(&document);
        for part in [
            r#"<circle class="spot""#,
            r#"<rect class="spot""#,
            r#"class="chosen""#,
            "default table",
            "glass  b",
            r#"class="node""#,
        ] {
            assert!(svg.contains(part), "{part}: {svg}");
        }
        assert!(svg.contains("lobe widths"), "{svg}");
        assert!(!svg.contains(r#"class="measured""#) && !svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        let bare = plan_picture(&serde_json::json!({ "tables": [{}] }));
        assert!(bare.starts_with("<svg") && !bare.contains("NaN"), "{bare}");
    }
}
