//! Measures the accuracy of a table through its lookup, as a renderer sees it, with samples that the fit does not use.
//!
//! Invariant: the report depends only on the table, the requested ranges and the number of points. It shares no code
//! and no samples with the loss that fits minimise, so an error in the loss is visible here.

mod accuracy;
mod difference;
mod distance;
mod effort;
mod extremes;
mod figures;
mod floors;
mod light;
mod lobe;
mod map;
mod matrices;
mod places;
mod poor;
mod sampled;
mod second;
mod sequence;
mod steps;

use serde::Serialize;

pub use accuracy::{Accuracy, Spread, TermError, Worst};
pub use difference::{Difference, Gap, difference};
pub use effort::{MOST_POINTS, ReportPoints, report_points};
pub use extremes::{Corner, extremes};
pub use figures::{Figures, GoOn, figures_of};
pub use floors::{Floors, Moved};
pub use map::{ErrorMap, error_map_while};
pub use matrices::{Extent, Matrices};
pub use poor::{POOR_WIDTH, Poor};
pub use sampled::{Closeness, SampledLobes};
pub use second::SecondReport;

use crate::{Configuration, PerAxis, Table};

/// Version of the report. It increases whenever the report of the same table changes.
pub const REPORT_VERSION: u32 = 7;

/// The accuracy of a table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// [`REPORT_VERSION`].
    pub version: u32,
    /// Errors at nodes, due to the fit and the number format.
    pub nodes: Accuracy,
    /// Errors between nodes, including interpolation.
    pub between: Accuracy,
    /// Nodes where the stored LTC or Gaussian is a poor approximation of the lobe.
    pub poor: Poor,
    /// Determinants and condition numbers of the stored matrices.
    pub matrices: Matrices,
    /// Nodes requested beyond the limits of the fit.
    pub floors: Floors,
    /// The errors of the second lobes, if entries have two lobes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub second: Option<SecondReport>,
}

/// Measures a table at nodes and at configurations between nodes. `points` sets the number of nodes and of
/// configurations.
///
/// `range` is the requested range of each axis; the table's nodes may have been moved to the limits of the fit. Runs on
/// the current rayon pool. The size of the pool does not change the result. Domain: a table with at least one node on
/// each axis, finite numbers.
///
/// # Panics
/// Never: the measurement always completes.
#[must_use]
pub fn report(table: &Table, range: &PerAxis<[f64; 2]>, points: impl Into<ReportPoints>) -> Report {
    let report = report_while(&|| true, table, range, points);
    report.expect("the measurement is never stopped")
}

/// Like [`report`], but returns `None` as soon as `go_on` returns false. `go_on` is called every few milliseconds.
#[must_use]
pub fn report_while(
    go_on: &GoOn,
    table: &Table,
    range: &PerAxis<[f64; 2]>,
    points: impl Into<ReportPoints>,
) -> Option<Report> {
    let places = Places::of(table, points.into());
    let measured = figures::all_while(go_on, table, &places.all)?;
    let second = match table.second_lobe() {
        Some(second) => Some(SecondReport::of(go_on, table, second, &places.all[places.nodes..])?),
        None => None,
    };
    Some(places.report(&measured, second, table, range))
}

/// The errors at `points` configurations between nodes, relative to the lobe's width. They equal `between.width` of a
/// [`report`] with the same number of points. Domain: as for [`report`], and at least one point.
#[must_use]
pub fn width_between(table: &Table, points: usize) -> Spread {
    Accuracy::of(&figures::all(table, &places::within(table, points))).width
}

/// Nodes followed by configurations between nodes. Both are measured in one run, which keeps all threads busy until the
/// end.
struct Places {
    all: Vec<Configuration>,
    nodes: usize,
}

impl Places {
    fn of(table: &Table, points: ReportPoints) -> Self {
        let mut all = places::nodes(table.layout, &table.axes, points.nodes);
        let nodes = all.len();
        all.extend(places::within(table, points.between));
        Self { all, nodes }
    }

    fn report(
        &self,
        measured: &[Figures],
        second: Option<SecondReport>,
        table: &Table,
        range: &PerAxis<[f64; 2]>,
    ) -> Report {
        let (at_nodes, between) = measured.split_at(self.nodes);
        Report {
            version: REPORT_VERSION,
            nodes: Accuracy::of(at_nodes),
            between: Accuracy::of(between),
            poor: Poor::of(at_nodes),
            matrices: Matrices::of(table),
            floors: Floors::of(table.layout, &table.axes, range),
            second,
        }
    }
}

#[cfg(test)]
mod tests;
