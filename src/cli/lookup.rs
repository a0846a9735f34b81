//! `lookup`: the matrices that a shader would fetch from a table.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::{
    AnyTable, CommandFailure, Context, CsvLines, Exit, LineFailure, Rows, TableChoice, clamped, points, usage,
};
use ltcforge_fit::{LookedUp, Table};

/// `lookup`.
#[derive(Debug, Args)]
pub struct LookupArgs {
    /// The table
    #[command(flatten)]
    pub table: TableChoice,
    /// CSV of `alpha_x,alpha_y,theta,phi` in radians; `-` for stdin
    #[arg(long, value_name = "CSV")]
    pub points: PathBuf,
    /// Index of a material of a `materials` table; the CSV has `theta,phi`
    #[arg(long, value_name = "N")]
    pub material: Option<u32>,
}

/// Prints the matrix of each point as soon as the point is read.
pub(super) fn run(args: &LookupArgs, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let AnyTable { table, origin, .. } = AnyTable::read(&args.table)?;
    let points = CsvLines::open(&args.points, "points")?;
    let has_edge = table.terms().is_some_and(|terms| terms.edge().is_some());
    let mut rows = Rows::new(context, &columns(table.second_matrices().is_some(), has_edge));
    let material = args.material.map(|number| material(&table, number)).transpose()?;
    points.each(points::is_header, |line| {
        let line = match material {
            None => Some(line.to_owned()),
            Some(alphas) => points::of_view(line, alphas).map_err(LineFailure::Line)?,
        };
        let line = line.unwrap_or_default();
        let Some(point) = points::parse(&line).map_err(LineFailure::Line)? else { return Ok(()) };
        let found = table.lookup(&point.configuration);
        let clamped = clamped(&point.configuration, &table, origin.range());
        rows.print(Some(&clamped), || row(&point, &found), || value(&point, &found))
    })?;
    rows.end()
}

/// The roughnesses along x and y of a material of a table.
///
/// # Errors
/// When the table has no material with this number.
fn material(table: &Table, number: u32) -> Result<[f64; 2], CommandFailure> {
    let found = table.materials().nth(number as usize).map(|[alpha, ratio]| [alpha, alpha * ratio]);
    found.ok_or_else(|| {
        let message = match table.materials().count() {
            0 => format!("--material needs layout materials; this table has layout {}", table.layout()),
            count => format!("--material {number}: use 0 to {}", count - 1),
        };
        usage(message)
    })
}

/// The columns. A second lobe and the F82 term come last.
fn columns(has_second: bool, has_edge: bool) -> Vec<String> {
    let matrix = |name: &str| (0..9).map(|i| format!("{name}{}{}", i / 3, i % 3)).collect::<Vec<_>>();
    let mut columns: Vec<String> = points::COLUMNS.map(str::to_owned).into();
    columns.extend(matrix("m"));
    columns.extend(["amplitude", "fresnel"].map(str::to_owned));
    columns.extend(if has_second { matrix("second") } else { vec![] });
    columns.extend(has_edge.then(|| "edge".to_owned()));
    columns
}

/// A CSV line. Each number has the fewest digits that parse to the same f64. Terms that the table lacks are empty.
fn row(point: &points::Point<'_>, found: &LookedUp) -> String {
    let mut fields: Vec<String> = point.written.map(str::to_owned).into();
    fields.extend(found.matrix.iter().map(f64::to_string));
    fields.extend([found.amplitude, found.fresnel].map(|term| term.map(|term| term.to_string()).unwrap_or_default()));
    fields.extend(found.second.iter().flatten().chain(&found.edge).map(f64::to_string));
    fields.join(",")
}

/// A line of JSON.
fn value(point: &points::Point<'_>, found: &LookedUp) -> Value {
    let at = &point.configuration;
    let mut line = json!({
        "alpha_x": at.alpha_x, "alpha_y": at.alpha_y, "theta": at.theta, "phi": at.phi,
        "matrix": found.matrix, "amplitude": found.amplitude, "fresnel": found.fresnel,
    });
    if let Some(second) = found.second {
        line["second"] = json!(second);
    }
    if let Some(edge) = found.edge {
        line["edge"] = json!(edge);
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(found: &LookedUp) -> String {
        super::row(&points::parse("0.10,1,0,7").expect("a point").expect("not empty"), found)
    }

    fn header(has_second: bool, has_edge: bool) -> String {
        columns(has_second, has_edge).join(",")
    }

    #[test]
    fn a_row_echoes_the_point_and_rounds_nothing() {
        let matrix = [1.0, 0.0, 0.1 + 0.2, 1e-17, -2.5, 0.0, 0.0, 0.0, 1.0];
        let found = LookedUp { matrix, second: None, amplitude: Some(0.1), fresnel: Some(0.25), edge: None };
        assert_eq!(row(&found), "0.10,1,0,7,1,0,0.30000000000000004,0.00000000000000001,-2.5,0,0,0,1,0.1,0.25");
        let bare = LookedUp { amplitude: None, fresnel: None, ..found };
        assert!(row(&bare).ends_with(",1,,"), "{}", row(&bare));
        assert_eq!(row(&bare).matches(',').count(), header(false, false).matches(',').count());
        let two = row(&LookedUp { second: Some(matrix), ..bare });
        assert_eq!(two.matches(',').count(), header(true, false).matches(',').count());
        let edged = row(&LookedUp { edge: Some(0.5), ..bare });
        assert_eq!(edged.matches(',').count(), header(false, true).matches(',').count());
        assert!(edged.ends_with(",,,0.5") && header(false, true).ends_with(",edge"), "{edged}");
        assert!(two.ends_with(",,,1,0,0.30000000000000004,0.00000000000000001,-2.5,0,0,0,1"), "{two}");
    }

    #[test]
    fn the_header_names_the_matrix_row_by_row() {
        let expected = "alpha_x,alpha_y,theta,phi,m00,m01,m02,m10,m11,m12,m20,m21,m22,amplitude,fresnel";
        assert_eq!(header(false, false), expected);
        assert!(
            header(true, false)
                .ends_with("fresnel,second00,second01,second02,second10,second11,second12,second20,second21,second22")
        );
    }
}
