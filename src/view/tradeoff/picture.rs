//! The trade-off as a picture: error against seconds, and against bytes; and the models below.

use std::fmt::Write as _;

use super::{
    FittedRecipe, ModelRows,
    axis::LogAxis,
    label::{Area, places},
    mark::{MARK, mark},
    model_panels,
    number::{bytes, rounded, two_digits},
};
use ltcforge_fit::{Layout, Precision};

const WIDTH: f64 = 1120.0;
const HEIGHT: f64 = 560.0 + model_panels::HEIGHT;
/// Top of both panels, and their height.
const TOP: f64 = 74.0;
const PANEL_HEIGHT: f64 = 420.0;
/// Left ends of the panels, and their width.
const LEFT: [f64; 2] = [64.0, 624.0];
const PANEL_WIDTH: f64 = 480.0;
/// The width of a letter at 13 pixels, and the height of a name.
const LETTER: f64 = 7.6;
const NAME_HEIGHT: f64 = 15.0;
/// The radius of the ring around a mark that has a name, or half the side of its square.
const RING: f64 = 7.5;

/// Light and dark colours in one file; the viewer's preference picks.
const STYLE: &str = include_str!("picture.css");

/// A chart, by its horizontal axis.
struct Chart {
    left: f64,
    title: &'static str,
    unit: &'static str,
    price: fn(&FittedRecipe) -> f64,
    /// A second price of the same table.
    shipped: fn(&FittedRecipe) -> Option<f64>,
    is_on_front: fn(&FittedRecipe) -> bool,
    write_tick: fn(f64) -> String,
}

/// The picture as SVG. A row on a front is drawn full, others faint; f16 hollow;
/// presets ringed and named; outliers in a square at the edge, with their values. Below, the models.
#[must_use]
pub fn picture(rows: &[FittedRecipe], models: &ModelRows) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = write_picture(&mut out, rows, models);
    out
}

fn write_picture(out: &mut String, rows: &[FittedRecipe], models: &ModelRows) -> std::fmt::Result {
    writeln!(
        out,
        r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}" role="img" aria-label="Error against seconds and against bytes, and the light of models against the time of a frame, bytes and seconds">"#
    )?;
    writeln!(out, "<style>\n{STYLE}</style>")?;
    writeln!(out, r#"<rect class="paper" width="{WIDTH}" height="{HEIGHT}"/>"#)?;
    write_legend(out, rows)?;
    let panels = [
        Chart {
            left: LEFT[0],
            title: "Error against seconds",
            unit: "seconds of the fit, every thread on a core of its own",
            price: |row| row.seconds,
            shipped: |_| None,
            is_on_front: |row| row.on_front.seconds,
            write_tick: |tick| format!("{}", rounded(tick)),
        },
        Chart {
            left: LEFT[1],
            title: "Error against bytes",
            unit: "bytes of the numbers on the GPU; diamonds: of the compact form, to ship",
            price: |row| row.bytes as f64,
            shipped: |row| row.compact_bytes.map(|bytes| bytes as f64),
            is_on_front: |row| row.on_front.bytes,
            write_tick: bytes,
        },
    ];
    for chart in &panels {
        write_chart(out, chart, rows)?;
    }
    model_panels::write(out, 560.0, rows, models)?;
    writeln!(out, "</svg>")
}

fn write_legend(out: &mut String, rows: &[FittedRecipe]) -> std::fmt::Result {
    let y = 22.0;
    let text = |out: &mut String, x: f64, text: &str| writeln!(out, r#"<text x="{x}" y="{}">{text}</text>"#, y + 4.5);
    for (layout, x) in Layout::ALL.iter().zip([70.0, 170.0]) {
        mark(out, [x, y], *layout, "")?;
        text(out, x + 10.0, layout.name())?;
    }
    // The others are shown to those who fit them.
    for (column, layout) in
        (0..).zip(&Layout::ALL[2..]).filter(|(_, layout)| rows.iter().any(|row| row.layout == **layout))
    {
        let (x, y) = (70.0 + 100.0 * f64::from(column), y + 20.0);
        mark(out, [x, y], *layout, "")?;
        writeln!(out, r#"<text x="{}" y="{}">{layout}</text>"#, x + 10.0, y + 4.5)?;
    }
    mark(out, [252.0, y], Layout::ALL[0], " f16")?;
    text(out, 262.0, "hollow: f16")?;
    mark(out, [360.0, y], Layout::ALL[0], " off")?;
    text(out, 370.0, "faint: on no front")?;
    writeln!(out, r#"<path class="front" d="M510 {y}h28"/>"#)?;
    text(out, 546.0, "Pareto front")?;
    writeln!(out, r#"<path class="front base" d="M652 {y}h28"/>"#)?;
    text(out, 688.0, "at the presets' layout, resolution and precision")?;
    writeln!(out, r#"<circle class="preset" cx="1020" cy="{y}" r="7.5"/>"#)?;
    text(out, 1034.0, "preset")
}

fn write_chart(out: &mut String, chart: &Chart, rows: &[FittedRecipe]) -> std::fmt::Result {
    let bottom = TOP + PANEL_HEIGHT;
    let prices = rows.iter().map(chart.price).chain(rows.iter().filter_map(chart.shipped));
    let x_axis = LogAxis::over(prices, [chart.left, chart.left + PANEL_WIDTH]);
    let y_axis = LogAxis::over(rows.iter().map(|row| row.error_mean), [bottom, TOP]);
    let middle = chart.left + 0.5 * PANEL_WIDTH;
    writeln!(out, r#"<text class="title middle" x="{middle}" y="58">{}</text>"#, chart.title)?;
    for tick in x_axis.ticks() {
        let x = x_axis.at(tick);
        writeln!(out, r#"<path class="grid" d="M{x:.1} {TOP}V{bottom}"/>"#)?;
        writeln!(out, r#"<text class="middle" x="{x:.1}" y="{}">{}</text>"#, bottom + 18.0, (chart.write_tick)(tick))?;
    }
    for tick in y_axis.ticks() {
        let y = y_axis.at(tick);
        writeln!(out, r#"<path class="grid" d="M{} {y:.1}h{PANEL_WIDTH}"/>"#, chart.left)?;
        writeln!(out, r#"<text class="end" x="{}" y="{:.1}">{}</text>"#, chart.left - 7.0, y + 4.5, rounded(tick))?;
    }
    writeln!(
        out,
        r#"<rect class="frame" x="{}" y="{TOP}" width="{PANEL_WIDTH}" height="{PANEL_HEIGHT}"/>"#,
        chart.left
    )?;
    writeln!(out, r#"<text class="middle" x="{middle}" y="{}">{}</text>"#, bottom + 42.0, chart.unit)?;
    let (x, y) = (chart.left - 48.0, TOP + 0.5 * PANEL_HEIGHT);
    writeln!(
        out,
        r#"<text class="middle" transform="translate({x} {y}) rotate(-90)">mean error between nodes, of the lobe's width</text>"#
    )?;

    let at = |row: &FittedRecipe| [x_axis.at((chart.price)(row)), y_axis.at(row.error_mean)];
    let mut fronts = vec![("front", staircase(rows.iter().filter(|row| (chart.is_on_front)(row)).map(at)))];
    if chart.left == LEFT[0] {
        fronts.push(("front base", staircase(rows.iter().filter(|row| row.on_front.base).map(at))));
    }
    for (class, corners) in &fronts {
        write_front(out, class, corners)?;
    }
    for row in rows {
        let precision = if row.precision == Precision::F16 { " f16" } else { "" };
        let faint = if (chart.is_on_front)(row) || row.on_front.base { "" } else { " off" };
        mark(out, at(row), row.layout, &format!("{precision}{faint}"))?;
        if let Some(price) = (chart.shipped)(row) {
            diamond(out, [x_axis.at(price), at(row)[1]], row.layout, faint)?;
        }
    }
    let presets =
        rows.iter().filter_map(|row| Some(Named { name: row.preset?.to_owned(), at: at(row), is_preset: true }));
    let outliers = rows.iter().filter_map(|row| {
        let price = (chart.price)(row);
        let price = x_axis.is_beyond(price).then(|| (chart.write_tick)(two_digits(price)));
        let error = y_axis.is_beyond(row.error_mean).then(|| two_digits(row.error_mean).to_string());
        let values: Vec<String> = price.into_iter().chain(error).collect();
        let name = format!("off: {}", values.join(", "));
        (!values.is_empty()).then(|| Named { name, at: at(row), is_preset: false })
    });
    let named: Vec<Named> = presets.chain(outliers).collect();
    let marks = rows.iter().map(|row| Area::around(at(row), MARK + 1.0));
    let lines =
        fronts.iter().flat_map(|(_, corners)| corners.windows(2)).map(|ends| Area::along(ends[0], ends[1], 1.0));
    let taken: Vec<Area> = marks.chain(lines).collect();
    write_names(out, &Area { left: chart.left, top: TOP, width: PANEL_WIDTH, height: PANEL_HEIGHT }, &named, &taken)
}

/// The corners of a staircase: from the price of one point on a front to that of the next, the best known error is that
/// of the first.
fn staircase(points: impl Iterator<Item = [f64; 2]>) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = points.collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut corners: Vec<[f64; 2]> = Vec::new();
    for [x, y] in points {
        corners.extend(corners.last().map(|[_, before]| [x, *before]));
        corners.push([x, y]);
    }
    corners
}

fn write_front(out: &mut String, class: &str, corners: &[[f64; 2]]) -> std::fmt::Result {
    let Some(([x, y], rest)) = corners.split_first() else { return Ok(()) };
    // Corners come in pairs: the first ends a horizontal line, the second a vertical one.
    let steps = rest.chunks_exact(2).map(|pair| format!("H{:.1}V{:.1}", pair[1][0], pair[1][1]));
    writeln!(out, r#"<path class="{class}" d="M{x:.1} {y:.1}{}"/>"#, steps.collect::<String>())
}

/// A mark that has a name: a preset, or an outlier with its values.
struct Named {
    name: String,
    at: [f64; 2],
    is_preset: bool,
}

/// Writes names where they hide neither each other, nor what is `taken`, nor a mark that is named.
fn write_names(out: &mut String, frame: &Area, named: &[Named], taken: &[Area]) -> std::fmt::Result {
    let rings = named.iter().map(|named| Area::around(named.at, RING + 1.0));
    let taken: Vec<Area> = taken.iter().copied().chain(rings).collect();
    let points: Vec<[f64; 2]> = named.iter().map(|named| named.at).collect();
    let sizes: Vec<[f64; 2]> = named.iter().map(|named| [LETTER * named.name.len() as f64, NAME_HEIGHT]).collect();
    for (Named { name, at: [x, y], is_preset }, place) in named.iter().zip(places(&points, &sizes, &taken, frame)) {
        if let Some(area) = place {
            let near = [x.clamp(area.left, area.left + area.width), y.clamp(area.top, area.top + area.height)];
            writeln!(out, r#"<path class="lead" d="M{x:.1} {y:.1}L{:.1} {:.1}"/>"#, near[0], near[1])?;
            writeln!(out, r#"<text class="title" x="{:.1}" y="{:.1}">{name}</text>"#, area.left, area.top + 12.0)?;
        }
        if *is_preset {
            writeln!(out, r#"<circle class="preset" cx="{x:.1}" cy="{y:.1}" r="{RING}"/>"#)?;
        } else {
            // A square around the mark: its place is the frame's edge, not its value.
            let side = 2.0 * RING;
            let [left, top] = [x - RING, y - RING];
            writeln!(out, r#"<rect class="preset" x="{left:.1}" y="{top:.1}" width="{side}" height="{side}"/>"#)?;
        }
    }
    Ok(())
}

/// The mark of the shipped size.
fn diamond(out: &mut String, [x, y]: [f64; 2], layout: Layout, classes: &str) -> std::fmt::Result {
    let number = Layout::ALL.iter().position(|known| *known == layout).unwrap_or(0);
    writeln!(out, r#"<path class="layout{number}{classes}" d="M{:.1} {y:.1}l4 -4l4 4l-4 4Z"/>"#, x - MARK)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::tradeoff::{Fronts, model::tests::rows as models};
    use ltcforge_files::digest::Digest;
    use ltcforge_fit::PerAxis;

    pub(crate) fn row(seconds: f64, error_mean: f64, preset: Option<&'static str>) -> FittedRecipe {
        FittedRecipe {
            recipe_digest: Digest::of(b""),
            preset,
            layout: Layout::Reflected,
            resolution: PerAxis { alpha: 4, ratio: 4, theta: 4, phi: 4 },
            samples: 128,
            directions: 8,
            steps: 30,
            precision: Precision::F32,
            entries: 256,
            bytes: 11_264,
            compact_bytes: Some(1_500),
            seconds,
            wall_seconds: seconds,
            error_mean,
            error_p95: error_mean,
            sw1_mean: error_mean,
            sw1_p95: error_mean,
            light_mean: 0.1 * error_mean,
            light_p95: 0.5 * error_mean,
            predicted_seconds: seconds,
            predicted_error: error_mean,
            on_front: Fronts { seconds: true, bytes: false, base: preset.is_some() },
        }
    }

    #[test]
    fn an_outlier_stands_at_the_edge_with_its_value() {
        let mut rows = vec![
            row(0.8, 0.055, Some("draft")),
            row(1.7, 0.052, Some("standard")),
            row(4.8, 0.051, Some("paper")),
            row(23.0, 0.049, Some("best")),
            row(0.5, 0.07, None),
        ];
        let svg = picture(&rows, &models());
        assert!(!svg.contains("off:"));
        // The shipped size has a mark of its own, in the chart of bytes alone.
        assert_eq!(svg.matches("l4 -4l4 4l-4 4Z").count(), rows.len());
        rows.push(row(2.0, 0.934, None));
        let svg = picture(&rows, &models());
        assert_eq!(svg.matches(">off: 0.93</text>").count(), 2, "{svg}");
        // The others still have most of the axis.
        let ticks = |svg: &str| svg.matches("class=\"grid\"").count();
        assert!(ticks(&svg) >= ticks(&picture(&rows[..5], &models())));
    }
}
