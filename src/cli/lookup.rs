//! `lookup`: the matrices that a shader would fetch from a table.

use std::{
    collections::BTreeMap,
    io::{self, BufWriter, Write},
};

use serde_json::json;

use super::{
    CommandFailure, Context, Exit,
    args::LookupArgs,
    csv::{CsvLines, LineFailure},
    input::AnyTable,
    out_of_range::{Clamped, OutOfRangeCount, clamped},
    points::{self, COLUMNS, Point},
};
use ltcforge_fit::{Layout, LookedUp, Table};

/// Prints a matrix for each point as soon as it is read.
pub(super) fn run(args: &LookupArgs, json: bool, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let AnyTable { table, origin, .. } = AnyTable::read(&args.table)?;
    let points = CsvLines::open(&args.points, "points")?;
    let mut out = BufWriter::new(&mut *context.stdout);
    let mut out_of_range = OutOfRangeCount::default();
    if !json {
        writeln!(
            out,
            "{}",
            header(table.second_matrices().is_some(), table.terms().is_some_and(|terms| terms.edge().is_some()))
        )
        .map_err(|error| CommandFailure::stdout(&error))?;
    }
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
        out_of_range.count(&clamped);
        let written =
            if json { write_json(&mut out, &point, &found, &clamped) } else { write_row(&mut out, &point, &found) };
        written.map_err(|error| LineFailure::stdout(&error))
    })?;
    out.flush().map_err(|error| CommandFailure::stdout(&error))?;
    // In JSON, each line lists the clamped axes of its point.
    if !json && !out_of_range.is_empty() {
        eprintln!("{out_of_range}");
    }
    Ok(Exit::Ok)
}

/// The roughnesses along x and y of a material of a table.
///
/// # Errors
/// When the table has no materials, or not so many.
fn material(table: &Table, number: u32) -> Result<[f64; 2], CommandFailure> {
    let found = table.materials().nth(number as usize).map(|[alpha, ratio]| [alpha, alpha * ratio]);
    found.ok_or_else(|| {
        let message = match table.materials().count() {
            0 => format!("--material is for tables of layout {}; this one is of {}", Layout::Materials, table.layout()),
            count => format!("--material {number}: the table has the materials 0 to {}", count - 1),
        };
        CommandFailure::new(Exit::Usage, message)
    })
}

/// The columns; those of a second lobe and the term of F82 come last.
fn header(has_second: bool, has_edge: bool) -> String {
    let matrix = |name: &'static str| (0..9).map(move |i| format!("{name}{}{}", i / 3, i % 3));
    let terms = ["amplitude", "fresnel"].map(str::to_owned);
    let second = has_second.then(|| matrix("second"));
    let columns =
        COLUMNS.map(str::to_owned).into_iter().chain(matrix("m")).chain(terms).chain(second.into_iter().flatten());
    let edge = has_edge.then(|| "edge".to_owned());
    columns.chain(edge).collect::<Vec<_>>().join(",")
}

/// One line of CSV. Numbers are the shortest that read back as the same f64; terms that the table lacks are empty.
fn write_row(out: &mut dyn Write, point: &Point<'_>, found: &LookedUp) -> io::Result<()> {
    write!(out, "{}", point.written.join(","))?;
    for element in found.matrix {
        write!(out, ",{element}")?;
    }
    for term in [found.amplitude, found.fresnel] {
        match term {
            Some(term) => write!(out, ",{term}")?,
            None => write!(out, ",")?,
        }
    }
    for element in found.second.iter().flatten() {
        write!(out, ",{element}")?;
    }
    if let Some(edge) = found.edge {
        write!(out, ",{edge}")?;
    }
    writeln!(out)
}

/// One line of JSON. `clamped` holds the axes on which the point lies outside the table, with the value used instead.
fn write_json(out: &mut dyn Write, point: &Point<'_>, found: &LookedUp, clamped: &[Clamped]) -> io::Result<()> {
    let at = &point.configuration;
    let clamped: BTreeMap<&str, f64> = clamped.iter().map(|clamped| (clamped.axis, clamped.to)).collect();
    let mut line = json!({
        "alpha_x": at.alpha_x, "alpha_y": at.alpha_y, "theta": at.theta, "phi": at.phi,
        "matrix": found.matrix, "amplitude": found.amplitude, "fresnel": found.fresnel,
        "clamped": clamped,
    });
    if let Some(second) = found.second {
        line["second"] = json!(second);
    }
    if let Some(edge) = found.edge {
        line["edge"] = json!(edge);
    }
    writeln!(out, "{line}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(found: &LookedUp) -> String {
        let point = points::parse("0.10,1,0,7").expect("a point").expect("not empty");
        let mut out = Vec::new();
        write_row(&mut out, &point, found).expect("a line in memory");
        String::from_utf8(out).expect("text")
    }

    #[test]
    fn a_row_echoes_the_point_and_rounds_nothing() {
        let matrix = [1.0, 0.0, 0.1 + 0.2, 1e-17, -2.5, 0.0, 0.0, 0.0, 1.0];
        let found = LookedUp { matrix, second: None, amplitude: Some(0.1), fresnel: Some(0.25), edge: None };
        assert_eq!(row(&found), "0.10,1,0,7,1,0,0.30000000000000004,0.00000000000000001,-2.5,0,0,0,1,0.1,0.25\n");
        let bare = LookedUp { amplitude: None, fresnel: None, ..found };
        assert!(row(&bare).ends_with(",1,,\n"), "{}", row(&bare));
        assert_eq!(row(&bare).matches(',').count(), header(false, false).matches(',').count());
        let two = row(&LookedUp { second: Some(matrix), ..bare });
        assert_eq!(two.matches(',').count(), header(true, false).matches(',').count());
        let edged = row(&LookedUp { edge: Some(0.5), ..bare });
        assert_eq!(edged.matches(',').count(), header(false, true).matches(',').count());
        assert!(edged.ends_with(",,,0.5\n") && header(false, true).ends_with(",edge"), "{edged}");
        assert!(two.ends_with(",,,1,0,0.30000000000000004,0.00000000000000001,-2.5,0,0,0,1\n"), "{two}");
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
