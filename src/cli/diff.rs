//! `diff`: the distance between two tables, and the error of each.

use std::{fmt::Write as _, path::PathBuf};

use clap::Args;
use serde_json::json;

use super::{AnyTable, CommandFailure, Context, Exit, TableFolder, Threads, shown, tabulated};
use ltcforge_fit::{Difference, Gap, MOST_POINTS, Report, Spread, difference};

/// `diff`.
#[derive(Debug, Args)]
pub struct DiffArgs {
    /// Table: a file, or the first digits of a digest in --tables
    pub a: PathBuf,
    /// Second table, compared with the first
    pub b: PathBuf,
    /// The folder of tables
    #[command(flatten)]
    pub folder: TableFolder,
    /// Number of nodes and of points between them, 8 to 1000000 [default: 1024]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(8..=1_000_000), hide_default_value = true)]
    pub points: Option<u32>,
    /// Threads.
    #[command(flatten)]
    pub threads: Threads,
}

/// Compares two tables. Different tables are not a failure.
pub(super) fn run(args: &DiffArgs, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let tables = [AnyTable::named(&args.a, &args.folder)?, AnyTable::named(&args.b, &args.folder)?];
    let [a, b] = &tables;
    for read in &tables {
        tabulated::check_complete(&read.table, &read.path)?;
    }
    let points = args.points.map_or(MOST_POINTS, |points| points as usize);
    let (apart, reports) = args.threads.pool()?.install(|| {
        let apart = difference(&a.table, &b.table, points);
        (apart, [a.report(args.points), b.report(args.points)])
    });
    let side = |read: &AnyTable, report: &Report| {
        json!({
            "file": shown(&read.path), "digest": read.digest, "layout": read.table.layout.name(),
            "resolution": read.table.lengths(), "report": report,
        })
    };
    let same_bytes = a.digest == b.digest;
    let value = json!({
        "same_bytes": same_bytes, "difference": apart, "a": side(a, &reports[0]), "b": side(b, &reports[1]),
    });
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _ = write_text(&mut text, &tables, apart.as_ref(), &reports);
    context.print(&value, text.trim_end())
}

fn write_text(
    out: &mut String,
    tables: &[AnyTable; 2],
    apart: Option<&Difference>,
    reports: &[Report; 2],
) -> std::fmt::Result {
    for (name, read) in ["a", "b"].into_iter().zip(tables) {
        let n = read.table.lengths();
        let size = format!("{} x {} x {} x {}", n.alpha, n.ratio, n.theta, n.phi);
        writeln!(out, "{name}  {}  {}, {size}\n   {}", read.path.display(), read.table.layout, read.digest)?;
    }
    if tables[0].digest == tables[1].digest {
        writeln!(out, "the same bytes")?;
    }
    match apart {
        Some(Difference { places, matrix, amplitude, fresnel }) => {
            let lookups = format!("lookups at {places} places");
            writeln!(out, "\n{lookups:24}{:>12}{:>12}   largest at alpha_x alpha_y theta phi", "mean", "max")?;
            let gaps = [Some(matrix), amplitude.as_ref(), fresnel.as_ref()];
            for (name, gap) in ["matrix, of its norm", "amplitude", "Fresnel term"].into_iter().zip(gaps) {
                let Some(Gap { mean, max, alpha_x, alpha_y, theta, phi }) = gap else {
                    writeln!(out, "{name:24}{:>24}", "not in both tables")?;
                    continue;
                };
                writeln!(out, "{name:24}{mean:>12.2e}{max:>12.2e}   {alpha_x:.4} {alpha_y:.4} {theta:.4} {phi:.4}")?;
            }
        }
        None => writeln!(out, "\nlookups: not compared, because the tables' ranges do not overlap")?,
    }
    writeln!(out, "\nerror between nodes, mean / p95 / max, % of the lobe's width")?;
    for (name, Report { between, .. }) in ["a", "b"].into_iter().zip(reports) {
        let Spread { mean, p95, max } = between.width;
        let (mean, p95, max) = (100.0 * mean, 100.0 * p95, 100.0 * max);
        writeln!(out, "{name:24}{mean:>12.2}{p95:>12.2}{max:>12.2}")?;
    }
    Ok(())
}
