//! A chart of error against cost, with the Pareto front of its points.

use std::fmt::Write as _;

use super::{
    axis::LogAxis,
    front,
    label::{Area, places},
    mark::{Kind, MARK, diamond, mark},
    number::rounded,
};

/// Width of a chart. Points with price zero have their own space at the left.
pub(super) const WIDTH: f64 = 480.0;
const FREE: f64 = 48.0;
/// The width reserved for the label below a tick.
const TICK_WIDTH: f64 = 52.0;
/// The width of a letter at 13 pixels, and the height of a name.
const LETTER: f64 = 7.6;
const NAME_HEIGHT: f64 = 15.0;
/// The distance of names from the frame.
const INSET: f64 = 5.0;
/// The radius of the ring around a preset.
const RING: f64 = 7.5;

/// A row of charts.
pub(super) struct Line {
    pub(super) top: f64,
    pub(super) height: f64,
    pub(super) error_unit: &'static str,
    /// The factor on errors in axis labels.
    pub(super) error_scale: f64,
    /// The largest shown error, relative to the least. Larger errors are drawn at the upper edge.
    pub(super) most_error: f64,
}

/// A chart of errors against prices.
pub(super) struct Chart {
    pub(super) line: Line,
    pub(super) left: f64,
    pub(super) title: &'static str,
    pub(super) unit: &'static str,
    pub(super) points: Vec<Point>,
    pub(super) write_tick: fn(f64) -> String,
}

/// A point of a chart.
pub(super) struct Point {
    pub(super) price: f64,
    pub(super) error: f64,
    pub(super) kind: Kind,
    pub(super) is_f16: bool,
    /// The price of the form of the table that ships with a renderer. A second mark shows it.
    pub(super) shipped: Option<f64>,
    pub(super) name: Option<String>,
    pub(super) is_preset: bool,
    /// Whether the point is on the front of tables with the presets' layout, resolution and precision.
    pub(super) is_on_base_front: bool,
}

impl Chart {
    /// Writes the chart as SVG. Points on a front and closed forms are opaque, and other points are faint. Presets have
    /// rings.
    pub(super) fn write(&self, out: &mut String) -> std::fmt::Result {
        let Self { line: Line { top, height, error_unit, error_scale, most_error }, left, title, unit, points, .. } =
            self;
        let (bottom, right, middle) = (top + height, left + WIDTH, left + 0.5 * WIDTH);
        let prices = || points.iter().flat_map(|point| [Some(point.price), point.shipped]).flatten();
        let has_free = prices().any(|price| price == 0.0);
        let x_axis = LogAxis::over(prices(), [if has_free { left + FREE } else { *left }, right]);
        let most = most_error * points.iter().map(|point| point.error).fold(f64::INFINITY, f64::min);
        let y_axis = LogAxis::over(points.iter().map(|point| point.error.min(most)), [bottom, *top]);
        let x_of = |price: f64| if price > 0.0 { x_axis.at(price) } else { left + 0.5 * FREE };

        writeln!(out, r#"<text class="title middle" x="{middle}" y="{}">{title}</text>"#, top - 16.0)?;
        let free = has_free.then(|| (x_of(0.0), "0".to_owned()));
        let ticks = x_axis.ticks_apart(TICK_WIDTH).into_iter().map(|tick| (x_axis.at(tick), (self.write_tick)(tick)));
        for (x, label) in free.into_iter().chain(ticks) {
            writeln!(out, r#"<path class="grid" d="M{x:.1} {top}V{bottom}"/>"#)?;
            writeln!(out, r#"<text class="middle" x="{x:.1}" y="{}">{label}</text>"#, bottom + 18.0)?;
        }
        for tick in y_axis.ticks() {
            let (y, label) = (y_axis.at(tick), rounded(error_scale * tick));
            writeln!(out, r#"<path class="grid" d="M{left} {y:.1}h{WIDTH}"/>"#)?;
            writeln!(out, r#"<text class="end" x="{}" y="{:.1}">{label}</text>"#, left - 7.0, y + 4.5)?;
        }
        writeln!(out, r#"<rect class="frame" x="{left}" y="{top}" width="{WIDTH}" height="{height}"/>"#)?;
        writeln!(out, r#"<text class="middle" x="{middle}" y="{}">{unit}</text>"#, bottom + 42.0)?;
        let (x, y) = (left - 48.0, top + 0.5 * height);
        writeln!(out, r#"<text class="middle" transform="translate({x} {y}) rotate(-90)">{error_unit}</text>"#)?;

        let at: Vec<[f64; 2]> = points.iter().map(|point| [x_of(point.price), y_axis.at(point.error)]).collect();
        let on_front = front(&points.iter().map(|point| [point.price, point.error]).collect::<Vec<_>>());
        let on_base_front = points.iter().map(|point| point.is_on_base_front);
        let of = |which: Vec<bool>| staircase(at.iter().zip(which).filter(|(_, is_on)| *is_on).map(|(at, _)| *at));
        let fronts = [("front", of(on_front.clone())), ("front base", of(on_base_front.collect()))];
        for (class, corners) in &fronts {
            write_front(out, class, corners)?;
        }
        for ((point, [x, y]), is_on_front) in points.iter().zip(&at).zip(on_front) {
            let is_full = is_on_front || point.is_on_base_front || matches!(point.kind, Kind::ClosedForm(_));
            let faint = if is_full { "" } else { " off" };
            let precision = if point.is_f16 { " f16" } else { "" };
            mark(out, [*x, *y], point.kind, &format!("{precision}{faint}"))?;
            if let Some(price) = point.shipped {
                diamond(out, [x_of(price), *y], point.kind, faint)?;
            }
            if point.is_preset {
                writeln!(out, r#"<circle class="preset" cx="{x:.1}" cy="{y:.1}" r="{RING}"/>"#)?;
            }
        }
        self.write_names(out, &at, &fronts.map(|(_, corners)| corners))
    }

    /// Writes each name where it does not cover another name, a mark or a front.
    fn write_names(&self, out: &mut String, at: &[[f64; 2]], fronts: &[Vec<[f64; 2]>]) -> std::fmt::Result {
        let points = || self.points.iter().zip(at);
        let marks = points().map(|(point, at)| Area::around(*at, if point.is_preset { RING } else { MARK } + 1.0));
        let lines = fronts.iter().flat_map(|corners| corners.windows(2)).map(|ends| Area::along(ends[0], ends[1], 1.0));
        let taken: Vec<Area> = marks.chain(lines).collect();
        let named: Vec<_> = points().filter_map(|(point, at)| Some((point.name.as_ref()?, *at))).collect();
        let (names, places_of): (Vec<&String>, Vec<[f64; 2]>) = named.into_iter().unzip();
        let sizes: Vec<[f64; 2]> = names.iter().map(|name| [LETTER * name.len() as f64, NAME_HEIGHT]).collect();
        let frame = Area {
            left: self.left + INSET,
            top: self.line.top + INSET,
            width: WIDTH - 2.0 * INSET,
            height: self.line.height - 2.0 * INSET,
        };
        for ((name, [x, y]), area) in names.iter().zip(&places_of).zip(places(&places_of, &sizes, &taken, &frame)) {
            let Some(area) = area else { continue };
            let near = area.near([*x, *y]);
            writeln!(out, r#"<path class="lead" d="M{x:.1} {y:.1}L{:.1} {:.1}"/>"#, near[0], near[1])?;
            writeln!(out, r#"<text class="title" x="{:.1}" y="{:.1}">{name}</text>"#, area.left, area.top + 12.0)?;
        }
        Ok(())
    }
}

/// The corners of a staircase. Between two points on a front, the best known error is that of the cheaper point.
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
    // Corners come in pairs. The first ends a horizontal line, and the second ends a vertical line.
    let steps = rest.chunks_exact(2).map(|pair| format!("H{:.1}V{:.1}", pair[1][0], pair[1][1]));
    writeln!(out, r#"<path class="{class}" d="M{x:.1} {y:.1}{}"/>"#, steps.collect::<String>())
}
