//! `report`: measures the error of a table, whether it was fitted by ltcforge or published.

use std::{f64::consts::FRAC_PI_2, fmt::Write as _};

use clap::Args;
use serde_json::json;

use super::{AnyTable, CommandFailure, Context, Exit, TableChoice, Threads, lut, shown, tabulated, usage};
use ltcforge_fit::{
    Asymmetry, Corner, LobeModel, Moved, PerAxis, Poor, Report, SecondReport, Spread, TermError, extremes,
};

/// `report`.
#[derive(Debug, Args)]
pub struct ReportArgs {
    /// The table
    #[command(flatten)]
    pub table: TableChoice,
    /// Number of nodes and of points between them, 8 to 1000000 [default: as in the manifest]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(8..=1_000_000), hide_default_value = true)]
    pub points: Option<u32>,
    /// Also measure the corners of the domain
    #[arg(long)]
    pub extremes: bool,
    /// Threads.
    #[command(flatten)]
    pub threads: Threads,
}

/// Measures a table and prints the figures.
pub(super) fn run(args: &ReportArgs, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    if let Some(read) = lut::read(&args.table)? {
        if args.points.is_some() || args.extremes {
            return Err(usage(
                "--points and --extremes are for tables of linearly transformed cosines: leave them out",
            ));
        }
        return lut::report(&read, &args.threads, context);
    }
    let read = AnyTable::read(&args.table)?;
    tabulated::check_complete(&read.table, &read.path)?;
    let measure = || (read.report(args.points), args.extremes.then(|| extremes(&read.table)));
    let (report, corners) = args.threads.pool()?.install(measure);
    let mut value = json!({
        "file": shown(&read.path), "digest": read.digest, "resolution": read.table.lengths(), "report": report,
    });
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _ = write_text(&mut text, &read, &report);
    if let Some(asymmetry) = read.table.model().file().and_then(|file| file.data()).and_then(|data| data.asymmetry()) {
        value["asymmetry"] = json!(asymmetry);
        let _ = writeln!(text, "\n{}", asymmetry_line(&asymmetry));
    }
    if let Some(corners) = &corners {
        value["extremes"] = json!(corners);
        let _ = write_corners(&mut text, corners);
    }
    context.print(&value, &format!("{text}\n{HOW_TO_READ}"))
}

fn write_text(out: &mut String, read: &AnyTable, report: &Report) -> std::fmt::Result {
    let PerAxis { alpha, ratio, theta, phi } = read.table.lengths();
    let Report { nodes, between, poor, matrices, floors, second, .. } = report;
    // The main figure for comparing tables.
    let Spread { mean, p95, max } = percent(between.width);
    writeln!(out, "error between nodes, mean / p95 / max: {mean:.2} / {p95:.2} / {max:.2} % of the lobe's width\n")?;
    writeln!(out, "{}\n{}", read.path.display(), read.digest)?;
    writeln!(out, "{alpha} x {ratio} x {theta} x {phi} entries: alpha x ratio x theta x phi\n")?;

    let [at, between_places] = [format!("at {} nodes", nodes.points), format!("at {} places between", between.points)];
    writeln!(out, "{:24}{at:>28}   {between_places:>28}", "")?;
    let columns = format!("{:>10}{:>9}{:>9}", "mean", "p95", "max");
    writeln!(out, "{:24}{columns}   {columns}", "")?;
    row(out, "distance sw1, rad", &cells(nodes.sw1, 5), &cells(between.sw1, 5))?;
    row(out, "of the lobe's width, %", &cells(percent(nodes.width), 2), &cells(percent(between.width), 2))?;
    row(out, "light, % of the lobe", &cells(percent(nodes.light), 2), &cells(percent(between.light), 2))?;
    row(out, "amplitude, absolute", &term_cells(nodes.amplitude), &term_cells(between.amplitude))?;
    row(out, "Fresnel term, absolute", &term_cells(nodes.fresnel), &term_cells(between.fresnel))?;
    if let Some(SecondReport { f0, between }) = second {
        let nothing = " ".repeat(28);
        row(out, &format!("F0 {f0}: width, %"), &nothing, &cells(percent(between.width), 2))?;
        row(out, &format!("F0 {f0}: light, %"), &nothing, &cells(percent(between.light), 2))?;
    }

    for (name, accuracy) in [("at nodes", nodes), ("between nodes", between)] {
        writeln!(
            out,
            "\nworst {name:18}{:>10}{:>10}{:>8}{:>8}{:>10}{:>10}",
            "alpha_x", "alpha_y", "theta", "phi", "sw1", "width, %"
        )?;
        for w in &accuracy.worst {
            let (sw1, width) = (w.sw1, 100.0 * w.width);
            writeln!(
                out,
                "{:24}{:>10.6}{:>10.6}{:>8.4}{:>8.4}{sw1:>10.5}{width:>10.2}",
                "", w.alpha_x, w.alpha_y, w.theta, w.phi
            )?;
        }
    }

    writeln!(out, "\n{}", poor_line(read.table.lobe, poor))?;
    let (determinant, condition) = (matrices.determinant, matrices.condition);
    writeln!(out, "\nmatrices                {} entries", matrices.entries)?;
    writeln!(
        out,
        "  determinant           {:.3e} to {:.3e}, {} negative",
        determinant.min, determinant.max, matrices.negative_determinants
    )?;
    writeln!(
        out,
        "  condition number      {:.3e} to {:.3e}, {} without an inverse",
        condition.min, condition.max, matrices.singular
    )?;
    writeln!(out, "floors")?;
    for (name, moved) in
        [("alpha", floors.alpha), ("ratio", floors.ratio), ("alpha_y", floors.alpha_y), ("theta, rad", floors.theta)]
    {
        let Moved { floor, nodes, entries } = moved;
        writeln!(out, "  {name:22}{floor:<10.7} nodes moved: {nodes}, entries: {entries}")?;
    }
    Ok(())
}

fn poor_line(lobe: LobeModel, Poor { limit, nodes, alpha, theta }: &Poor) -> String {
    let model = if lobe.gaussian().is_some() { "a Gaussian" } else { "an LTC" };
    let what = format!("nodes with an error over {:.0} % of the lobe's width", 100.0 * limit);
    match (alpha, theta) {
        (Some(alpha), Some(theta)) => format!(
            "{what}: {nodes}, alpha {:.4} to {:.4}, theta {:.3} to {:.3}, where {model} models the lobe poorly",
            alpha[0], alpha[1], theta[0], theta[1]
        ),
        _ => format!("{what}: none"),
    }
}

/// A line on how much the fitted BRDF violates reciprocity.
pub(super) fn asymmetry_line(asymmetry: &Asymmetry) -> String {
    let Asymmetry { largest, alpha, ratio, theta_o, phi_o, theta_i, phi } = asymmetry;
    let alpha = alpha.map(|alpha| format!("alpha {alpha:.4}, ")).unwrap_or_default();
    let ratio = ratio.map(|ratio| format!("ratio {ratio:.4}, ")).unwrap_or_default();
    let phi_o = phi_o.map(|phi_o| format!("phi_o {phi_o:.3}, ")).unwrap_or_default();
    format!(
        "tabulated BRDF: exchanging view and light changes it by up to {:.2} % of its largest value, at {alpha}{ratio}theta_o \
         {theta_o:.3}, {phi_o}theta_i {theta_i:.3}, phi {phi:.3}",
        100.0 * largest
    )
}

fn write_corners(out: &mut String, corners: &[Corner]) -> std::fmt::Result {
    writeln!(
        out,
        "\ncorners     alpha   ratio pi/2-theta  broken  sw1, rad  jump, widths  f32 inverse, rad  in widths"
    )?;
    for corner in corners {
        let Corner { alpha, ratio, theta, lookups, broken, sw1, jump, inversion, inversion_width } = corner;
        let up = FRAC_PI_2 - theta;
        writeln!(
            out,
            "{:>17.0e}{ratio:>8.0e}{up:>11.1e}{:>8}{sw1:>10.1e}{jump:>14.1e}{inversion:>18.1e}{inversion_width:>11.1e}",
            alpha,
            format!("{broken}/{lookups}")
        )?;
    }
    Ok(())
}

const HOW_TO_READ: &str = "\
Each row is an error: 0 is perfect. A renderer meets the errors between nodes. An error of 2 % of the lobe's width
is hardly visible; at 20 % a highlight is a fifth too wide, or displaced by a fifth. Even the best LTC differs from
its lobe by a few percent. Light is the part of the lobe's energy that square lights lose or gain. A negative
determinant reverses the winding of lights in a shader. docs/accuracy.md explains all figures.";

fn percent(spread: Spread) -> Spread {
    Spread { mean: 100.0 * spread.mean, p95: 100.0 * spread.p95, max: 100.0 * spread.max }
}

fn cells(Spread { mean, p95, max }: Spread, digits: usize) -> String {
    format!("{mean:>10.digits$}{p95:>9.digits$}{max:>9.digits$}")
}

fn term_cells(term: Option<TermError>) -> String {
    match term {
        Some(TermError { mean, max }) => format!("{mean:>10.5}{:>9}{max:>9.5}", ""),
        None => format!("{:>10}{:>9}{:>9}", "none", "", ""),
    }
}

fn row(out: &mut String, name: &str, nodes: &str, between: &str) -> std::fmt::Result {
    writeln!(out, "{}", format!("{name:24}{nodes}   {between}").trim_end())
}
