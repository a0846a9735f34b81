//! The picture of the trade-off. One row of charts shows error against seconds and bytes. The other shows the light
//! error of models and tables against instructions and bytes.

use std::fmt::Write as _;

use super::{
    FittedRecipe, ModelRow, ModelRows,
    chart::{Chart, Line, Point},
    mark::{Kind, mark},
    number::{bytes, rounded},
};
use ltcforge_fit::{Layout, Precision};

const WIDTH: f64 = 1120.0;
const HEIGHT: f64 = 960.0;
/// Left edges of the charts in a row.
const LEFT: [f64; 2] = [64.0, 624.0];
/// The row of lobe errors. Its axis ends at four times the least error, because larger errors would take most of the
/// axis.
const LOBES: Line = Line {
    top: 74.0,
    height: 420.0,
    error_unit: "mean lobe error between nodes, of the lobe's width",
    error_scale: 1.0,
    most_error: 4.0,
};
const LIGHT: Line = Line {
    top: 590.0,
    height: 300.0,
    error_unit: "mean light error of random lights, thousandths",
    error_scale: 1e3,
    most_error: f64::INFINITY,
};

/// Light and dark colours. The viewer's colour preference selects one set.
const STYLE: &str = include_str!("picture.css");

/// The picture as SVG.
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
        r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}" role="img" aria-label="Error against seconds and bytes, and the light error of models against instructions and bytes">"#
    )?;
    writeln!(out, "<style>\n{STYLE}</style>")?;
    writeln!(out, r#"<rect class="paper" width="{WIDTH}" height="{HEIGHT}"/>"#)?;
    write_legend(out, rows)?;
    let preset = |row: &FittedRecipe, price: f64| Point {
        name: row.preset.map(str::to_owned),
        is_preset: row.preset.is_some(),
        ..of_row(row, price, row.error_mean)
    };
    let by_seconds = rows.iter().map(|row| Point { is_on_base_front: row.on_front.base, ..preset(row, row.seconds) });
    let shipped = |row: &FittedRecipe| row.compact_bytes.map(|bytes| bytes as f64);
    let by_bytes = rows.iter().map(|row| Point { shipped: shipped(row), ..preset(row, row.bytes as f64) });
    let of_models = |price: fn(&ModelRow) -> Option<f64>| {
        models.rows.iter().filter_map(move |row| {
            let kind = row.layout.map_or(Kind::ClosedForm(row.model), Kind::Table);
            Some(Point { name: Some(row.name()), ..point(kind, price(row)?, row.light_error.mean) })
        })
    };
    let light_by_instructions = of_models(|row| row.gpu_cost.map(|cost| f64::from(cost.instructions)));
    let tables = rows.iter().map(|row| of_row(row, row.bytes as f64, row.light_mean));
    let light_by_bytes = of_models(|row| Some(row.gpu_bytes as f64)).chain(tables);
    let charts = [
        Chart {
            line: LOBES,
            left: LEFT[0],
            title: "Lobe error against seconds",
            unit: "seconds of the fit, one core per thread",
            points: by_seconds.collect(),
            write_tick: |tick| rounded(tick).to_string(),
        },
        Chart {
            line: LOBES,
            left: LEFT[1],
            title: "Lobe error against bytes",
            unit: "bytes of the numbers on the GPU; diamonds: of the compact form, to ship",
            points: by_bytes.collect(),
            write_tick: bytes,
        },
        Chart {
            line: LIGHT,
            left: LEFT[0],
            title: "Light error against instructions",
            unit: "instructions of one rectangle on a GPU",
            points: light_by_instructions.collect(),
            write_tick: |tick| rounded(tick).to_string(),
        },
        Chart {
            line: LIGHT,
            left: LEFT[1],
            title: "Light error against bytes",
            unit: "bytes of the numbers on the GPU",
            points: light_by_bytes.collect(),
            write_tick: bytes,
        },
    ];
    charts.iter().try_for_each(|chart| chart.write(out))?;
    writeln!(out, "</svg>")
}

fn of_row(row: &FittedRecipe, price: f64, error: f64) -> Point {
    Point { is_f16: row.precision == Precision::F16, ..point(Kind::Table(row.layout), price, error) }
}

fn point(kind: Kind, price: f64, error: f64) -> Point {
    Point { price, error, kind, is_f16: false, shipped: None, name: None, is_preset: false, is_on_base_front: false }
}

fn write_legend(out: &mut String, rows: &[FittedRecipe]) -> std::fmt::Result {
    let y = 22.0;
    let text = |out: &mut String, x: f64, text: &str| writeln!(out, r#"<text x="{x}" y="{}">{text}</text>"#, y + 4.5);
    for (layout, x) in Layout::ALL.iter().zip([70.0, 170.0]) {
        mark(out, [x, y], Kind::Table(*layout), "")?;
        text(out, x + 10.0, layout.name())?;
    }
    // Other layouts are in the legend only if the rows use them.
    for (column, layout) in
        (0..).zip(&Layout::ALL[2..]).filter(|(_, layout)| rows.iter().any(|row| row.layout == **layout))
    {
        let (x, y) = (70.0 + 100.0 * f64::from(column), y + 20.0);
        mark(out, [x, y], Kind::Table(*layout), "")?;
        writeln!(out, r#"<text x="{}" y="{}">{layout}</text>"#, x + 10.0, y + 4.5)?;
    }
    mark(out, [252.0, y], Kind::Table(Layout::ALL[0]), " f16")?;
    text(out, 262.0, "hollow: f16")?;
    mark(out, [360.0, y], Kind::Table(Layout::ALL[0]), " off")?;
    text(out, 370.0, "faint: on no front")?;
    writeln!(out, r#"<path class="front" d="M510 {y}h28"/>"#)?;
    text(out, 546.0, "Pareto front")?;
    writeln!(out, r#"<path class="front base" d="M652 {y}h28"/>"#)?;
    text(out, 688.0, "at the presets' layout, resolution and precision")?;
    writeln!(out, r#"<circle class="preset" cx="1020" cy="{y}" r="7.5"/>"#)?;
    text(out, 1034.0, "preset")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tradeoff::{Fronts, model::tests::rows as models};
    use ltcforge_files::digest::Digest;
    use ltcforge_fit::PerAxis;

    fn row(seconds: f64, error_mean: f64, preset: Option<&'static str>) -> FittedRecipe {
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
    fn an_error_beyond_the_axis_is_at_its_edge() {
        let mut rows = vec![
            row(0.8, 0.055, Some("draft")),
            row(1.7, 0.052, Some("standard")),
            row(4.8, 0.051, Some("paper")),
            row(23.0, 0.049, Some("best")),
            row(0.5, 0.07, None),
        ];
        let edge = format!("cy=\"{:.1}\"", LOBES.top);
        let before = picture(&rows, &models());
        assert!(!before.contains(&edge), "{before}");
        rows.push(row(2.0, 0.934, None));
        let svg = picture(&rows, &models());
        // The charts for seconds and for bytes both show it.
        assert_eq!(svg.matches(&edge).count(), 2, "{svg}");
        // The other points still use most of the axis.
        let ticks = |svg: &str| svg.matches("class=\"grid\"").count();
        assert!(ticks(&svg) + 4 >= ticks(&before), "{svg}");
    }

    #[test]
    fn presets_models_and_shipped_sizes_are_marked_and_named() {
        let rows = [row(0.5, 0.07, None), row(4.5, 0.06, Some("paper"))];
        let svg = picture(&rows, &models());
        assert_eq!(svg.matches(">paper</text>").count(), 2, "{svg}");
        assert_eq!(svg.matches("r=\"7.5\"").count(), 2 + 1, "two presets and the legend: {svg}");
        for row in models().rows {
            assert_eq!(svg.matches(&format!(">{}</text>", row.name())).count(), 2, "{svg}");
        }
        assert_eq!(svg.matches("<path class=\"normals\"").count(), 2 * 3, "{svg}");
        assert_eq!(svg.matches("<path class=\"gaussian\"").count(), 2 * 2, "{svg}");
        assert_eq!(svg.matches("<path class=\"layout0").count(), rows.len(), "{svg}");
        assert!(svg.contains(">0</text>") && !svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }

    /// Left edges of the diamonds of model `normals` in a chart, and their heights.
    fn diamonds(svg: &str, chart: usize) -> Vec<[f64; 2]> {
        let numbers = svg.lines().filter_map(|line| line.strip_prefix(r#"<path class="normals" d="M"#)).map(|rest| {
            let pair = rest.split('l').next().expect("a place");
            let (x, y) = pair.split_once(' ').expect("two numbers");
            [x, y].map(|x| x.parse().expect("a number"))
        });
        numbers.skip(3 * chart).take(3).collect()
    }

    /// Lower marks have smaller errors, and marks further to the right cost more. Marks with price zero are at the
    /// left.
    #[test]
    fn marks_have_the_order_of_their_numbers() {
        let svg = picture(&[row(0.5, 0.07, None)], &models());
        let [balanced, fast, fine] = diamonds(&svg, 0)[..] else { panic!("{svg}") };
        assert!(fast[0] < balanced[0] && balanced[0] < fine[0], "{svg}");
        assert!(fast[1] < balanced[1] && balanced[1] < fine[1], "{svg}");
        let free = diamonds(&svg, 1);
        assert!(free.iter().all(|at| at[0] == free[0][0] && at[0] < LEFT[1] + 48.0), "{svg}");
    }
}
