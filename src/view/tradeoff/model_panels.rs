//! The models in the picture: error of light against registers and instructions of a GPU, beside engines' ways; and
//! against the time of a frame, bytes, and seconds of the fit.

use std::fmt::Write as _;

use super::{
    EngineRow, FittedRecipe, ModelRow, ModelRows,
    axis::LogAxis,
    label::{Area, places},
    mark::mark,
    model_table,
    number::{bytes, rounded},
};
use ltcforge_fit::{Layout, Precision};
use ltcforge_light::{LightModel, engines::EngineWay};
use ltcforge_shaders::GpuCost;

/// Height of all panels with their titles.
pub(super) const HEIGHT: f64 = GAP + 692.0 + (EngineWay::ALL.len() as f64) * model_table::LINE;
/// Top of the first charts below that of the panels, the height of a chart, and from the top of a line of charts to the next.
const TOP: f64 = 52.0;
const CHART_HEIGHT: f64 = 300.0;
const GAP: f64 = 400.0;
/// Left ends and widths of the charts of a line.
const PAIR: ([f64; 2], f64) = ([64.0, 624.0], 480.0);
const THREE: ([f64; 3], f64) = ([64.0, 428.0, 792.0], 312.0);
/// The width that is kept at the left for models that cost nothing.
const FREE: f64 = 48.0;
/// The width left for the label below a tick.
const TICK_WIDTH: f64 = 40.0;
/// Top of the table below that of the panels.
const TABLE_TOP: f64 = GAP + 428.0;
/// Half a mark, and the size of a name's letter and line.
const MARK: f64 = 5.0;
const LETTER: f64 = 7.6;
const NAME_HEIGHT: f64 = 15.0;

/// A chart, by its horizontal axis.
struct Chart<'a> {
    left: f64,
    top: f64,
    width: f64,
    title: &'static str,
    unit: String,
    marks: Vec<Mark<'a>>,
    /// Tables of the family and the costs of each.
    tables: Vec<(&'a FittedRecipe, f64)>,
    write_tick: fn(f64) -> String,
}

/// A row in a chart.
struct Mark<'a> {
    /// A model, or a way of engines.
    model: Option<&'a ModelRow>,
    name: String,
    error: f64,
    price: f64,
    /// A hollow mark, joined to the first.
    second: Option<f64>,
}

impl<'a> Mark<'a> {
    fn of_model(row: &'a ModelRow, price: f64, second: Option<f64>) -> Self {
        Self { model: Some(row), name: row.name(), error: row.light_error.mean, price, second }
    }

    fn of_engine(row: &'a EngineRow, price: f64) -> Self {
        Self { model: None, name: row.way.name().to_owned(), error: row.light_error.mean, price, second: None }
    }
}

/// Writes the panels from the height `top` of the picture on: the models large and named, the tables of the family
/// small.
pub(super) fn write(out: &mut String, top: f64, family: &[FittedRecipe], models: &ModelRows) -> std::fmt::Result {
    let (first, second) = (top + TOP, top + TOP + GAP);
    let by_gpu = |i: usize, title, unit: &str, price: fn(GpuCost) -> u32| {
        let price = |cost: Option<GpuCost>| cost.map(|cost| f64::from(price(cost)));
        let of_models = models.rows.iter().filter_map(|row| Some(Mark::of_model(row, price(row.gpu_cost)?, None)));
        let of_engines = models.engines.iter().filter_map(|row| Some(Mark::of_engine(row, price(row.gpu_cost)?)));
        Chart {
            left: PAIR.0[i],
            top: first,
            width: PAIR.1,
            title,
            unit: unit.to_owned(),
            marks: of_models.chain(of_engines).collect(),
            tables: Vec::new(),
            write_tick: |tick| rounded(tick).to_string(),
        }
    };
    let chart = |i: usize, title, unit: String, prices: fn(&ModelRow) -> (f64, Option<f64>)| {
        let mark = |row| {
            let (price, second) = prices(row);
            Mark::of_model(row, price, second)
        };
        Chart {
            left: THREE.0[i],
            top: second,
            width: THREE.1,
            title,
            unit,
            marks: models.rows.iter().map(mark).collect(),
            tables: Vec::new(),
            write_tick: |tick| rounded(tick).to_string(),
        }
    };
    let charts = [
        by_gpu(0, "Light against registers", "vector registers of one rectangle on a GPU; rings: engines", |cost| {
            cost.registers
        }),
        by_gpu(1, "Light against instructions", "instructions of one rectangle on a GPU; rings: engines", |cost| {
            cost.instructions
        }),
        chart(0, "Light against time", format!("milliseconds of a frame of {0} x {0}", models.frame_size), |row| {
            (row.frame_milliseconds, None)
        }),
        Chart {
            tables: family.iter().map(|row| (row, row.bytes as f64)).collect(),
            write_tick: bytes,
            ..chart(1, "Light against bytes", "bytes on the GPU; hollow: to ship, with code".to_owned(), |row| {
                (row.gpu_bytes as f64, Some((row.file_bytes + row.shader_bytes) as f64))
            })
        },
        Chart {
            tables: family.iter().map(|row| (row, row.seconds)).collect(),
            ..chart(2, "Light against seconds", "seconds of the fit".to_owned(), |row| (row.fit_seconds, None))
        },
    ];
    let of_models = models.rows.iter().map(|row| row.light_error.mean);
    let of_engines = models.engines.iter().map(|row| row.light_error.mean);
    let errors: Vec<f64> = of_models.chain(of_engines).chain(family.iter().map(|row| row.light_mean)).collect();
    for chart in &charts {
        let y_axis = LogAxis::over_all(errors.iter().copied(), [chart.top + CHART_HEIGHT, chart.top]);
        write_chart(out, chart, &y_axis)?;
    }
    let lights = models.lights;
    for top in [first, second] {
        let (x, y) = (PAIR.0[0] - 48.0, top + 0.5 * CHART_HEIGHT);
        writeln!(
            out,
            r#"<text class="middle" transform="translate({x} {y}) rotate(-90)">mean error of {lights} lights, thousandths</text>"#
        )?;
    }
    model_table::write(out, top + TABLE_TOP, models)
}

fn write_chart(out: &mut String, chart: &Chart<'_>, y_axis: &LogAxis) -> std::fmt::Result {
    let Chart { left, top, width, title, unit, marks, tables, write_tick } = chart;
    let (bottom, right, middle) = (top + CHART_HEIGHT, left + width, left + 0.5 * width);
    let of_marks = || marks.iter().flat_map(|mark| [Some(mark.price), mark.second]).flatten();
    let has_free = of_marks().any(|price| price == 0.0);
    let start = if has_free { left + FREE } else { *left };
    let x_axis = LogAxis::over_all(of_marks().chain(tables.iter().map(|(_, price)| *price)), [start, right]);
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
        writeln!(out, r#"<path class="grid" d="M{left} {y:.1}h{width}"/>"#)?;
        writeln!(out, r#"<text class="end" x="{}" y="{:.1}">{}</text>"#, left - 7.0, y + 4.5, rounded(1e3 * error))?;
    }
    writeln!(out, r#"<rect class="frame" x="{left}" y="{top}" width="{width}" height="{CHART_HEIGHT}"/>"#)?;
    writeln!(out, r#"<text class="middle" x="{middle}" y="{}">{unit}</text>"#, bottom + 42.0)?;

    let mut taken = Vec::new();
    for (row, price) in tables {
        let precision = if row.precision == Precision::F16 { " f16" } else { "" };
        let point = [at(*price), y_axis.at(row.light_mean)];
        mark(out, point, row.layout, &format!("{precision} faint"))?;
        taken.push(Area::around(point, MARK));
    }
    let mut points = Vec::new();
    for Mark { model, error, price, second, .. } in marks {
        let (x, y) = (at(*price), y_axis.at(*error));
        points.push([x, y]);
        if let (Some(row), Some(second)) = (model, second.map(at)) {
            writeln!(out, r#"<path class="lead" d="M{x:.1} {y:.1}H{second:.1}"/>"#)?;
            model_mark(out, [second, y], row, " f16")?;
            taken.push(Area::around([second, y], MARK + 1.0));
        }
        match model {
            Some(row) => model_mark(out, [x, y], row, "")?,
            None => writeln!(out, r#"<circle class="preset" cx="{x:.1}" cy="{y:.1}" r="{}"/>"#, MARK + 1.0)?,
        }
        taken.push(Area::around([x, y], MARK + 1.0));
    }
    write_names(out, marks, &points, &taken, &Area { left: *left, top: *top, width: *width, height: CHART_HEIGHT })
}

fn write_names(
    out: &mut String,
    marks: &[Mark<'_>],
    points: &[[f64; 2]],
    taken: &[Area],
    frame: &Area,
) -> std::fmt::Result {
    let sizes: Vec<[f64; 2]> = marks.iter().map(|mark| [LETTER * mark.name.len() as f64, NAME_HEIGHT]).collect();
    for (mark, place) in marks.iter().zip(places(points, &sizes, taken, frame)) {
        if let Some(Area { left, top, .. }) = place {
            writeln!(out, r#"<text class="title" x="{left:.1}" y="{:.1}">{}</text>"#, top + 12.0, mark.name)?;
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
    fn every_row_is_marked_and_named_in_each_chart() {
        let svg = panels();
        // In the chart of bytes twice.
        assert_eq!(svg.matches("<path class=\"normals").count(), 3 * 6, "{svg}");
        assert_eq!(svg.matches("<path class=\"gaussian").count(), 3 * 6, "{svg}");
        assert_eq!(svg.matches("r=\"5\"").count(), 6, "{svg}");
        assert_eq!(svg.matches("<circle class=\"preset\"").count(), 2 * EngineWay::ALL.len(), "{svg}");
        assert_eq!(svg.matches(" faint\"").count(), 2 * 2, "{svg}");
        for row in &rows().rows {
            assert_eq!(svg.matches(&format!(">{}</text>", row.name())).count(), 5 + 1, "{svg}");
        }
        for way in EngineWay::ALL {
            assert_eq!(svg.matches(&format!(">{way}</text>")).count(), 2 + 1, "{svg}");
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

    /// The picture's own claim: further down is nearer to the truth, further right is more expensive.
    #[test]
    fn marks_stand_in_the_order_of_their_numbers() {
        let svg = panels();
        for chart in 0..3 {
            let [balanced, fast, fine] = diamonds(&svg, chart)[..] else { panic!("{svg}") };
            assert!(fast[0] < balanced[0] && balanced[0] < fine[0], "{svg}");
            assert!(fast[1] < balanced[1] && balanced[1] < fine[1], "{svg}");
        }
    }

    #[test]
    fn what_costs_nothing_stands_beside_the_axis() {
        let svg = panels();
        for (chart, left) in [(3, THREE.0[1]), (4, THREE.0[2])] {
            for [x, _] in diamonds(&svg, chart) {
                assert_eq!(x, left + 0.5 * FREE, "{svg}");
            }
        }
        assert_eq!(svg.matches(">0</text>").count(), 2 + 15, "two axes, and three columns of five rows: {svg}");
    }
}
