//! The models in the picture: error of light against the time of a frame, and what each needs.

use std::fmt::Write as _;

use super::{
    ModelRow, ModelRows,
    axis::LogAxis,
    label::{Area, places},
    number::{bytes, rounded, two_digits},
};
use crate::fit::Layout;

/// Height of both panels with their titles.
pub(super) const HEIGHT: f64 = 400.0;
/// Top of the chart below that of the panels, and the chart itself.
const TOP: f64 = 52.0;
const CHART_HEIGHT: f64 = 280.0;
const CHART_LEFT: f64 = 64.0;
const CHART_WIDTH: f64 = 480.0;
/// Half a mark, and the size of a name's letter and line.
const MARK: f64 = 5.0;
const LETTER: f64 = 7.6;
const NAME_HEIGHT: f64 = 15.0;
/// Left end of the table, right ends of its columns, and the distance of its lines.
const TABLE_LEFT: f64 = 584.0;
const COLUMNS: [f64; 7] = [756.0, 816.0, 872.0, 936.0, 1000.0, 1056.0, 1104.0];
const LINE: f64 = 26.0;

/// Writes the panels from the height `top` of the picture on.
pub(super) fn write(out: &mut String, top: f64, models: &ModelRows) -> std::fmt::Result {
    write_chart(out, top + TOP, models)?;
    write_table(out, top + TOP, models)
}

fn write_chart(out: &mut String, top: f64, models: &ModelRows) -> std::fmt::Result {
    let ModelRows { lights, frame_size, rows, .. } = models;
    let (bottom, middle) = (top + CHART_HEIGHT, CHART_LEFT + 0.5 * CHART_WIDTH);
    let x_axis = LogAxis::over(rows.iter().map(|row| row.frame_milliseconds), [CHART_LEFT, CHART_LEFT + CHART_WIDTH]);
    let y_axis = LogAxis::over(rows.iter().map(|row| row.light_error.mean), [bottom, top]);
    writeln!(out, r#"<text class="title middle" x="{middle}" y="{}">Models of light</text>"#, top - 16.0)?;
    for tick in x_axis.ticks() {
        let x = x_axis.at(tick);
        writeln!(out, r#"<path class="grid" d="M{x:.1} {top}V{bottom}"/>"#)?;
        writeln!(out, r#"<text class="middle" x="{x:.1}" y="{}">{}</text>"#, bottom + 18.0, rounded(tick))?;
    }
    for tick in y_axis.ticks() {
        let y = y_axis.at(tick);
        writeln!(out, r#"<path class="grid" d="M{CHART_LEFT} {y:.1}h{CHART_WIDTH}"/>"#)?;
        writeln!(
            out,
            r#"<text class="end" x="{}" y="{:.1}">{}</text>"#,
            CHART_LEFT - 7.0,
            y + 4.5,
            rounded(1e3 * tick)
        )?;
    }
    writeln!(out, r#"<rect class="frame" x="{CHART_LEFT}" y="{top}" width="{CHART_WIDTH}" height="{CHART_HEIGHT}"/>"#)?;
    writeln!(
        out,
        r#"<text class="middle" x="{middle}" y="{}">milliseconds of a frame of {frame_size} x {frame_size} pixels</text>"#,
        bottom + 42.0
    )?;
    let (x, y) = (CHART_LEFT - 48.0, top + 0.5 * CHART_HEIGHT);
    writeln!(
        out,
        r#"<text class="middle" transform="translate({x} {y}) rotate(-90)">mean error of {lights} lights, thousandths</text>"#
    )?;
    let points: Vec<[f64; 2]> =
        rows.iter().map(|row| [x_axis.at(row.frame_milliseconds), y_axis.at(row.light_error.mean)]).collect();
    for (row, point) in rows.iter().zip(&points) {
        mark(out, *point, row)?;
    }
    let names: Vec<String> = rows.iter().map(ModelRow::name).collect();
    let sizes: Vec<[f64; 2]> = names.iter().map(|name| [LETTER * name.len() as f64, NAME_HEIGHT]).collect();
    let taken: Vec<Area> = points.iter().map(|point| Area::around(*point, MARK + 1.0)).collect();
    let frame = Area { left: CHART_LEFT, top, width: CHART_WIDTH, height: CHART_HEIGHT };
    for (name, place) in names.iter().zip(places(&points, &sizes, &taken, &frame)) {
        if let Some(Area { left, top, .. }) = place {
            writeln!(out, r#"<text class="title" x="{left:.1}" y="{:.1}">{name}</text>"#, top + 12.0)?;
        }
    }
    Ok(())
}

fn write_table(out: &mut String, top: f64, models: &ModelRows) -> std::fmt::Result {
    let heads = ["error", "p95", "ms", "GPU", "file", "WGSL", "fit, s"];
    let mut line = |y: f64, name: &str, cells: [String; 7], class: &str| -> std::fmt::Result {
        writeln!(out, r#"<text class="{class}" x="{TABLE_LEFT}" y="{y}">{name}</text>"#)?;
        for (cell, right) in cells.iter().zip(COLUMNS) {
            writeln!(out, r#"<text class="end {class}" x="{right}" y="{y}">{cell}</text>"#)?;
        }
        Ok(())
    };
    line(top + 12.0, "model", heads.map(str::to_owned), "title")?;
    for (number, row) in (1..).zip(&models.rows) {
        let cells = [
            format!("{:.5}", row.light_error.mean),
            format!("{:.4}", row.light_error.p95),
            format!("{:.1}", row.frame_milliseconds),
            few_bytes(row.gpu_bytes),
            few_bytes(row.file_bytes),
            few_bytes(row.shader_bytes),
            two_digits(row.fit_seconds).to_string(),
        ];
        line(top + 12.0 + f64::from(number) * LINE, &row.name(), cells, "model")?;
    }
    let ([adapter, end], y) = (adapter_lines(&models.adapter), top + 24.0 + (models.rows.len() + 1) as f64 * LINE);
    writeln!(out, r#"<text x="{TABLE_LEFT}" y="{y}">frames by {}</text>"#, escaped(adapter))?;
    writeln!(out, r#"<text x="{TABLE_LEFT}" y="{}">{}</text>"#, y + 18.0, escaped(end))
}

/// A driver's name in two lines: it is broken at the last space before it is too wide.
fn adapter_lines(name: &str) -> [&str; 2] {
    const MOST: usize = 56;
    let Some((end, _)) = name.char_indices().nth(MOST) else { return [name, ""] };
    let at = name[..end].rfind(' ').unwrap_or(end);
    [&name[..at], name[at..].trim_start()]
}

/// Bytes with two digits.
fn few_bytes(count: u64) -> String {
    if count == 0 { "0".to_owned() } else { bytes(two_digits(count as f64)) }
}

fn mark(out: &mut String, [x, y]: [f64; 2], row: &ModelRow) -> std::fmt::Result {
    let Some(layout) = row.layout else {
        let d = MARK + 1.0;
        return writeln!(out, r#"<path class="normals" d="M{x:.1} {:.1}l{d} {d}l-{d} {d}l-{d} -{d}z"/>"#, y - d);
    };
    let number = Layout::ALL.iter().position(|known| *known == layout).unwrap_or(0);
    writeln!(out, r#"<circle class="layout{number}" cx="{x:.1}" cy="{y:.1}" r="{MARK}"/>"#)
}

/// A driver's name as text of an XML document.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::{super::model::tests::rows, *};

    #[test]
    fn every_model_is_marked_named_and_told() {
        let models = ModelRows { adapter: "a <b> & c".to_owned(), ..rows() };
        let mut svg = String::new();
        write(&mut svg, 100.0, &models).expect("a string");
        assert_eq!((svg.matches("<circle").count(), svg.matches("class=\"normals\"").count()), (1, 3), "{svg}");
        for row in &models.rows {
            assert_eq!(svg.matches(&format!(">{}</text>", row.name())).count(), 2, "{svg}");
        }
        assert!(svg.contains(">180 kB</text>") && svg.contains(">0</text>"), "{svg}");
        assert!(svg.contains("a &lt;b&gt; &amp; c") && !svg.contains("NaN"), "{svg}");
    }

    #[test]
    fn a_long_name_of_a_driver_is_broken_between_words() {
        assert_eq!(adapter_lines("cpu"), ["cpu", ""]);
        let [first, second] = adapter_lines("llvmpipe (LLVM 15.0.6, 256 bits) (Mesa 22.3.6 (LLVM 15.0.6))");
        assert_eq!([first, second], ["llvmpipe (LLVM 15.0.6, 256 bits) (Mesa 22.3.6 (LLVM", "15.0.6))"]);
        let wide = "\u{e9}".repeat(60);
        let [first, second] = adapter_lines(&wide);
        assert_eq!((first.chars().count(), second.chars().count()), (56, 4));
    }

    /// The picture's own claim: further down is nearer to the truth, further right is slower.
    #[test]
    fn marks_stand_in_the_order_of_their_numbers() {
        let mut svg = String::new();
        write(&mut svg, 0.0, &rows()).expect("a string");
        let diamonds: Vec<[f64; 2]> = svg
            .lines()
            .filter_map(|line| line.strip_prefix(r#"<path class="normals" d="M"#))
            .filter_map(|rest| rest.split('l').next())
            .map(|pair| pair.split(' ').map(|x| x.parse().expect("a number")).collect::<Vec<f64>>())
            .map(|pair| [pair[0], pair[1]])
            .collect();
        let [fan, mean, fine] = diamonds[..] else { panic!("{svg}") };
        assert!(mean[0] < fan[0] && fan[0] < fine[0], "{diamonds:?}");
        assert!(mean[1] < fan[1] && fan[1] < fine[1], "{diamonds:?}");
    }
}
