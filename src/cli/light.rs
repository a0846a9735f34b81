//! `light`: the light that surfaces reflect from area lights.

use std::io::{self, BufWriter, Write};

use serde_json::json;

use super::{
    CommandFailure, Context, Exit,
    args::LightArgs,
    csv::{CsvLines, LineFailure},
    input::AnyTable,
    light_case, tabulated,
};
use ltcforge_fit::{BrdfKind, BrdfModel, Table};
use ltcforge_light::{
    Gaussian, LightError, LightModel, Reflected, TRUTH_TOLERANCE, WeightRule, by_gaussian, by_normals, by_table,
    truth_of,
};

/// The model that the light is computed with.
enum Found {
    Normals(WeightRule),
    Gaussian(Gaussian),
    Ltc(Box<Table>),
}

impl Found {
    /// The scattering model of a table. Closed forms are of GGX.
    fn brdf(&self) -> Option<&BrdfModel> {
        match self {
            Self::Ltc(table) => Some(table.model()),
            Self::Normals(_) | Self::Gaussian(_) => None,
        }
    }
}

/// Prints the reflected light of each line as soon as it is read.
pub(super) fn run(args: &LightArgs, json: bool, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let (found, ggx) = (choose(args)?, BrdfModel::from(BrdfKind::Ggx));
    let lines = CsvLines::open(&args.cases, "lights")?;
    let mut out = BufWriter::new(&mut *context.stdout);
    if !json {
        let header = if args.truth { "energy,fresnel,true_energy,true_fresnel" } else { "energy,fresnel" };
        writeln!(out, "{header}").map_err(|error| CommandFailure::stdout(&error))?;
    }
    let is_header = |line: &str| light_case::is_header(args.light, line);
    lines.each(is_header, |line| {
        let Some(case) = light_case::parse(args.light, line).map_err(LineFailure::Line)? else { return Ok(()) };
        let (at, light) = (case.at, case.light());
        let refuse = |error: LightError| LineFailure::Line(error.to_string());
        let reflected = match &found {
            Found::Normals(rule) => by_normals(&at, light, *rule),
            Found::Gaussian(gaussian) => by_gaussian(&at, light, *gaussian),
            Found::Ltc(table) => by_table(table, &at, light),
        };
        let reflected = reflected.map_err(refuse)?;
        let true_light = if args.truth {
            Some(truth_of(found.brdf().unwrap_or(&ggx), TRUTH_TOLERANCE, &at, light).map_err(refuse)?)
        } else {
            None
        };
        let written = if json {
            write_json(&mut out, &reflected, true_light.as_ref())
        } else {
            write_row(&mut out, &reflected, true_light.as_ref())
        };
        written.map_err(|error| LineFailure::stdout(&error))
    })?;
    out.flush().map_err(|error| CommandFailure::stdout(&error))?;
    Ok(Exit::Ok)
}

fn choose(args: &LightArgs) -> Result<Found, CommandFailure> {
    let usage = |message: &str| Err(CommandFailure::new(Exit::Usage, message));
    match (args.model, &args.table, args.weight) {
        (LightModel::Normals, None, rule) => Ok(Found::Normals(rule.unwrap_or(WeightRule::ALL[0]))),
        (LightModel::Sg, None, None) => Ok(Found::Gaussian(Gaussian::Sg)),
        (LightModel::Asg, None, None) => Ok(Found::Gaussian(Gaussian::Asg)),
        (LightModel::Sg | LightModel::Asg, _, Some(_)) => {
            usage("--weight is of model normals; models sg and asg have one rule")
        }
        (LightModel::Normals, Some(_), _) => usage("--table is of model ltc; add --model ltc, or leave it out"),
        (LightModel::Ltc, None, _) => usage("model ltc needs a table: --table TABLE"),
        (LightModel::Ltc, Some(_), Some(_)) => usage("--weight is of model normals; model ltc has one rule"),
        (model, Some(name), None) => {
            let AnyTable { path, table, .. } = AnyTable::named(name, &args.folder)?;
            if table.lobe.name() != model.name() {
                let (path, lobe) = (path.display(), table.lobe);
                return usage(&format!("{path}: the table has lobe {lobe}, not {model}: choose --model {lobe}"));
            }
            if args.truth {
                tabulated::check_complete(&table, &path)?;
            }
            if table.terms.is_none() {
                let message = format!("{}: {}", path.display(), LightError::NoTerms);
                return Err(CommandFailure::new(Exit::Failed, message));
            }
            Ok(Found::Ltc(Box::new(table)))
        }
    }
}

/// One line of CSV. Numbers are the shortest that read back as the same f64.
fn write_row(out: &mut dyn Write, found: &Reflected, true_light: Option<&Reflected>) -> io::Result<()> {
    write!(out, "{},{}", found.energy, found.fresnel)?;
    if let Some(Reflected { energy, fresnel }) = true_light {
        write!(out, ",{energy},{fresnel}")?;
    }
    writeln!(out)
}

fn write_json(out: &mut dyn Write, found: &Reflected, true_light: Option<&Reflected>) -> io::Result<()> {
    let mut line = json!({ "energy": found.energy, "fresnel": found.fresnel });
    if let Some(Reflected { energy, fresnel }) = true_light {
        line["true_energy"] = json!(energy);
        line["true_fresnel"] = json!(fresnel);
    }
    writeln!(out, "{line}")
}
