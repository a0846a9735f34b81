//! The models in the picture: error of light against the time of a frame, against bytes, and against seconds of the
//! fit.

use std::fmt::Write as _;

use super::{
    FittedRecipe, ModelRow, ModelRows,
    axis::LogAxis,
    label::{Area, places},
    mark::mark,
    model_table,
    number::{bytes, rounded},
};
use ltcforge_fit::{Layout, Precision};
use ltcforge_light::LightModel;

/// Height of all panels with their titles.
pub(super) const HEIGHT: f64 = 692.0;
/// Top of the charts below that of the panels, and their height.
const TOP: f64 = 52.0;
const CHART_HEIGHT: f64 = 300.0;
/// Left ends of the charts, and their width.
const LEFT: [f64; 3] = [64.0, 428.0, 792.0];
const CHART_WIDTH: f64 = 312.0;
/// The width that is kept at the left for models that cost nothing.
const FREE: f64 = 48.0;
/// The width left for the label below a tick.
const TICK_WIDTH: f64 = 40.0;
/// Top of the table below that of the panels.
const TABLE_TOP: f64 = 428.0;
/// Half a mark, and the size of a name's letter and line.
const MARK: f64 = 5.0;
const LETTER: f64 = 7.6;
const NAME_HEIGHT: f64 = 15.0;

/// A chart, by its horizontal axis.
struct Chart {
    left: f64,
    title: &'static str,
    unit: String,
    /// The cost of a model; a second price is a hollow mark, joined to the first.
    prices: fn(&ModelRow) -> (f64, Option<f64>),
    /// The cost of a table of the family.
    of_table: Option<fn(&FittedRecipe) -> f64>,
    write_tick: fn(f64) -> String,
}

/// Writes the panels from the height `top` of the picture on: the models large and named, the tables of the family
/// small.
pub(super) fn write(out: &mut String, top: f64, family: &[FittedRecipe], models: &ModelRows) -> std::fmt::Result {
    let charts = [
        Chart {
            left: LEFT[0],
            title: "Light against time",
            unit: format!("milliseconds of a frame of {0} x {0}", models.frame_size),
            prices: |row| (row.frame_milliseconds, None),
            of_table: None,
            write_tick: |tick| rounded(tick).to_string(),
        },
        Chart {
            left: LEFT[1],
            title: "Light against bytes",
            unit: "bytes on the GPU; hollow: to ship, with code".to_owned(),
            prices: |row| (row.gpu_bytes as f64, Some((row.file_bytes + row.shader_bytes) as f64)),
            of_table: Some(|row| row.bytes as f64),
            write_tick: bytes,
        },
        Chart {
            left: LEFT[2],
            title: "Light against seconds",
            unit: "seconds of the fit".to_owned(),
            prices: |row| (row.fit_seconds, None),
            of_table: Some(|row| row.seconds),
            write_tick: |tick| rounded(tick).to_string(),
        },
    ];
    let (top, bottom) = (top + TOP, top + TOP + CHART_HEIGHT);
    let errors = models.rows.iter().map(|row| row.light_error.mean).chain(family.iter().map(|row| row.light_mean));
    let y_axis = LogAxis::over_all(errors, [bottom, top]);
    for chart in &charts {
        write_chart(out, chart, top, &y_axis, family, models)?;
    }
    let (x, y) = (LEFT[0] - 48.0, top + 0.5 * CHART_HEIGHT);
    let lights = models.lights;
    writeln!(
        out,
        r#"<text class="middle" transform="translate({x} {y}) rotate(-90)">mean error of {lights} lights, thousandths</text>"#
    )?;
    model_table::write(out, top - TOP + TABLE_TOP, models)
}

fn write_chart(
    out: &mut String,
    chart: &Chart,
    top: f64,
    y_axis: &LogAxis,
    family: &[FittedRecipe],
    ModelRows { rows, .. }: &ModelRows,
) -> std::fmt::Result {
    let Chart { left, title, unit, prices, of_table, write_tick } = chart;
    let (bottom, right, middle) = (top + CHART_HEIGHT, left + CHART_WIDTH, left + 0.5 * CHART_WIDTH);
    let of_models = || rows.iter().map(prices).flat_map(|(first, second)| [Some(first), second]).flatten();
    let of_family = of_table.iter().flat_map(|price| family.iter().map(price));
    let has_free = of_models().any(|price| price == 0.0);
    let from = if has_free { left + FREE } else { *left };
    let x_axis = LogAxis::over_all(of_models().chain(of_family), [from, right]);
    let at = |price: f64| if price > 0.0 { x_axis.at(price) } else { left + 0.5 * FREE };

    writeln!(out, r#"<text class="title middle" x="{middle}" y="{}">{title}</text>"#, top - 16.0)?;
    let mut tick = |x: f64, name: &str| -> std::fmt::Result {
        writeln!(out, r#"<path class="grid" d="M{x:.1} {top}V{bottom}"/>"#)?;
        writeln!(out, r#"<text class="middle" x="{x:.1}" y="{}">{name}</text>"#, bottom + 18.0)
    };
    if has_free {
        tick(at(0.0), "0")?;
    }
    for price in x_axis.ticks_apart(TICK_WIDTH) {
        tick(x_axis.at(price), &write_tick(price))?;
    }
    for error in y_axis.ticks() {
        let y = y_axis.at(error);
        writeln!(out, r#"<path class="grid" d="M{left} {y:.1}h{CHART_WIDTH}"/>"#)?;
        writeln!(out, r#"<text class="end" x="{}" y="{:.1}">{}</text>"#, left - 7.0, y + 4.5, rounded(1e3 * error))?;
    }
    writeln!(out, r#"<rect class="frame" x="{left}" y="{top}" width="{CHART_WIDTH}" height="{CHART_HEIGHT}"/>"#)?;
    writeln!(out, r#"<text class="middle" x="{middle}" y="{}">{unit}</text>"#, bottom + 42.0)?;

    let mut taken = Vec::new();
    for (row, price) in of_table.iter().flat_map(|price| family.iter().map(move |row| (row, price(row)))) {
        let precision = if row.precision == Precision::F16 { " f16" } else { "" };
        let point = [at(price), y_axis.at(row.light_mean)];
        mark(out, point, row.layout, &format!("{precision} faint"))?;
        taken.push(Area::around(point, MARK));
    }
    let mut points = Vec::new();
    for row in rows {
        let (first, second) = prices(row);
        let y = y_axis.at(row.light_error.mean);
        points.push([at(first), y]);
        if let Some(x) = second.map(at) {
            writeln!(out, r#"<path class="lead" d="M{:.1} {y:.1}H{x:.1}"/>"#, at(first))?;
            model_mark(out, [x, y], row, " f16")?;
            taken.push(Area::around([x, y], MARK + 1.0));
        }
        model_mark(out, [at(first), y], row, "")?;
        taken.push(Area::around([at(first), y], MARK + 1.0));
    }
    write_names(out, rows, &points, &taken, &Area { left: *left, top, width: CHART_WIDTH, height: CHART_HEIGHT })
}

fn write_names(
    out: &mut String,
    rows: &[ModelRow],
    points: &[[f64; 2]],
    taken: &[Area],
    frame: &Area,
) -> std::fmt::Result {
    let names: Vec<String> = rows.iter().map(ModelRow::name).collect();
    let sizes: Vec<[f64; 2]> = names.iter().map(|name| [LETTER * name.len() as f64, NAME_HEIGHT]).collect();
    for (name, place) in names.iter().zip(places(points, &sizes, taken, frame)) {
        if let Some(Area { left, top, .. }) = place {
            writeln!(out, r#"<text class="title" x="{left:.1}" y="{:.1}">{name}</text>"#, top + 12.0)?;
        }
    }
    Ok(())
}

/// A mark of a model; `classes` begin with a space.
fn model_mark(out: &mut String, [x, y]: [f64; 2], row: &ModelRow, classes: &str) -> std::fmt::Result {
    let d = MARK + 1.0;
    match row.model {
        LightModel::Normals => {
            let y = y - d;
            writeln!(out, r#"<path class="normals{classes}" d="M{x:.1} {y:.1}l{d} {d}l-{d} {d}l-{d} -{d}z"/>"#)
        }
        // A triangle, upside down for a table.
        LightModel::Sg | LightModel::Asg => {
            let down = if row.layout.is_some() { -1.0 } else { 1.0 };
            let (x, y) = (x - d, y + down * 0.8 * d);
            let (width, height) = (2.0 * d, down * 2.0 * d);
            writeln!(out, r#"<path class="gaussian{classes}" d="M{x:.1} {y:.1}h{width}l-{d} {}z"/>"#, -height)
        }
        LightModel::Ltc => {
            let number = Layout::ALL.iter().position(|known| Some(*known) == row.layout).unwrap_or(0);
            writeln!(out, r#"<circle class="layout{number}{classes}" cx="{x:.1}" cy="{y:.1}" r="{MARK}"/>"#)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{
        super::{model::tests::rows, picture::tests::row},
        *,
    };

    fn panels() -> String {
        let family = [row(0.5, 0.07, None), row(4.5, 0.06, Some("paper"))];
        let mut svg = String::new();
        write(&mut svg, 0.0, &family, &rows()).expect("a string");
        svg
    }

    #[test]
    fn every_model_is_marked_and_named_in_each_chart() {
        let svg = panels();
        // In the chart of bytes twice.
        assert_eq!(svg.matches("<path class=\"normals").count(), 3 * 4, "{svg}");
        assert_eq!(svg.matches("<path class=\"gaussian").count(), 3 * 4, "{svg}");
        assert_eq!(svg.matches("r=\"5\"").count(), 4, "{svg}");
        assert_eq!(svg.matches(" faint\"").count(), 2 * 2, "{svg}");
        for row in &rows().rows {
            assert_eq!(svg.matches(&format!(">{}</text>", row.name())).count(), 3 + 1, "{svg}");
        }
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }

    /// Left ends of the full diamonds of a chart, and their tops.
    fn diamonds(svg: &str, chart: usize) -> Vec<[f64; 2]> {
        let numbers = svg
            .lines()
            .filter_map(|line| line.strip_prefix(r#"<path class="normals" d="M"#))
            .filter_map(|rest| rest.split('l').next())
            .map(|pair| pair.split(' ').map(|x| x.parse().expect("a number")).collect::<Vec<f64>>())
            .map(|pair| [pair[0], pair[1]]);
        numbers.skip(3 * chart).take(3).collect()
    }

    /// The picture's own claim: further down is nearer to the truth, further right is slower.
    #[test]
    fn marks_stand_in_the_order_of_their_numbers() {
        let svg = panels();
        let [balanced, fast, fine] = diamonds(&svg, 0)[..] else { panic!("{svg}") };
        assert!(fast[0] < balanced[0] && balanced[0] < fine[0], "{svg}");
        assert!(fast[1] < balanced[1] && balanced[1] < fine[1], "{svg}");
    }

    #[test]
    fn what_costs_nothing_stands_beside_the_axis() {
        let svg = panels();
        for chart in [1, 2] {
            for [x, _] in diamonds(&svg, chart) {
                assert_eq!(x, LEFT[chart] + 0.5 * FREE, "{svg}");
            }
        }
        assert_eq!(svg.matches(">0</text>").count(), 2 + 15, "two axes, and three columns of five rows: {svg}");
    }
}
