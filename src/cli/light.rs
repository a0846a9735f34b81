//! `light`: the light that surfaces reflect from area lights.

use std::{
    collections::BTreeMap,
    io::{self, BufWriter, Write},
};

use serde_json::json;

use super::{
    CommandFailure, Context, Exit,
    args::LightArgs,
    csv::{CsvLines, LineFailure},
    input::AnyTable,
    light_case,
    out_of_range::{Clamped, OutOfRangeCount, clamped},
    tabulated,
};
use ltcforge_fit::BrdfKind;
use ltcforge_light::{
    LightError, LightModel, Lighting, ReflectedLight, TRUTH_TOLERANCE,
    albedo::{compensation, sampled},
    truth_of,
};

/// Prints the reflected light of each line as soon as it is read.
pub(super) fn run(args: &LightArgs, json: bool, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let chosen = choose(args)?;
    let table = chosen.as_ref().map(|chosen| &chosen.table);
    let lighting = table.map(if args.cut { Lighting::TableAbove } else { Lighting::Table });
    let formula = args.model.closed_form(args.rule).map(Lighting::ClosedForm);
    let lighting = lighting.or(formula).ok_or_else(|| needs_table(args.model))?;
    let brdf = table.map_or(BrdfKind::Ggx.into(), |table| table.model().clone());
    let lines = CsvLines::open(&args.cases, "lights")?;
    let mut out = BufWriter::new(&mut *context.stdout);
    let mut out_of_range = OutOfRangeCount::default();
    if !json {
        writeln!(out, "{}", header(args)).map_err(|error| CommandFailure::stdout(&error))?;
    }
    let is_header = |line: &str| light_case::is_header(args.light, line);
    lines.each(is_header, |line| {
        let Some(case) = light_case::parse(args.light, line).map_err(LineFailure::Line)? else { return Ok(()) };
        let (at, light) = (case.at, &case.light);
        let refuse = |error: LightError| LineFailure::Line(error.to_string());
        let factor = |albedo: Result<f64, LightError>| Ok(compensation(albedo?, args.f0.unwrap_or(0.0)));
        let found = Found {
            light: lighting.reflected(&at, light).map_err(refuse)?,
            factor: if args.compensate { factor(lighting.albedo(&at)).map_err(refuse)? } else { 1.0 },
        };
        let true_light = if args.truth {
            let light = truth_of(&brdf, TRUTH_TOLERANCE, &at, light).map_err(refuse)?;
            Some(Found {
                light,
                factor: if args.compensate { factor(sampled(&brdf, &at)).map_err(refuse)? } else { 1.0 },
            })
        } else {
            None
        };
        let clamped = chosen.as_ref().map(|AnyTable { table, origin, .. }| clamped(&at, table, origin.range()));
        out_of_range.count(clamped.as_deref().unwrap_or_default());
        let written = if json {
            write_json(&mut out, args, &found, true_light.as_ref(), clamped.as_deref())
        } else {
            write_row(&mut out, args, &found, true_light.as_ref())
        };
        written.map_err(|error| LineFailure::stdout(&error))
    })?;
    out.flush().map_err(|error| CommandFailure::stdout(&error))?;
    // In JSON, each line lists the clamped axes.
    if !json && !out_of_range.is_empty() {
        eprintln!("{out_of_range}");
    }
    Ok(Exit::Ok)
}

/// The columns of a row.
fn header(args: &LightArgs) -> String {
    let of = |prefix: &str| {
        let reflected = if args.f0.is_some() { format!(",{prefix}reflected") } else { String::new() };
        format!("{prefix}energy,{prefix}fresnel{reflected}")
    };
    if args.truth { format!("{},{}", of(""), of("true_")) } else { of("") }
}

/// Reflected light, and the factor of `--compensate` on what a material reflects of it.
struct Found {
    light: ReflectedLight,
    factor: f64,
}

/// The light that the material of `--f0` reflects; `None` without the option.
fn of_material(args: &LightArgs, found: &Found) -> Option<f64> {
    args.f0.map(|f0| found.factor * found.light.schlick(f0, args.f90))
}

fn needs_table(model: LightModel) -> CommandFailure {
    CommandFailure::new(Exit::Usage, format!("model {model} needs a table: --table TABLE"))
}

/// The table that the model lights by; `None` for a model without one.
fn choose(args: &LightArgs) -> Result<Option<AnyTable>, CommandFailure> {
    let usage = |message: String| Err(CommandFailure::new(Exit::Usage, message));
    let model = args.model;
    if args.table.is_some() && model.lobe().is_none() {
        return usage("--table is of model ltc; add --model ltc, or leave it out".to_owned());
    }
    if args.table.is_none() && model.needs_table() {
        return Err(needs_table(model));
    }
    if args.rule.is_some() && model.rule_choices().is_empty() {
        let ruled = LightModel::names_of(|other| !other.rule_choices().is_empty());
        let is_alike =
            |other: LightModel| other.rule_choices().is_empty() && other.needs_table() == model.needs_table();
        let alike = LightModel::names_of(is_alike);
        let has = if alike == model.name() { format!("model {model} has") } else { format!("models {alike} have") };
        return usage(format!("--rule is of model {ruled}; {has} one rule"));
    }
    if args.cut && model != LightModel::Ltc {
        return usage(format!(
            "--cut is of model ltc; by model {model} nothing shines through from below: leave it out"
        ));
    }
    let Some(name) = &args.table else { return Ok(None) };
    let chosen = AnyTable::named(name, &args.folder)?;
    let AnyTable { path, table, .. } = &chosen;
    if Some(table.lobe) != model.lobe() {
        let (path, lobe) = (path.display(), table.lobe);
        return usage(format!("{path}: the table has lobe {lobe}, not {model}: choose --model {lobe}"));
    }
    if args.truth {
        tabulated::check_complete(table, path)?;
    }
    if table.terms.is_none() {
        let message = format!("{}: {}", path.display(), LightError::NoTerms);
        return Err(CommandFailure::new(Exit::Failed, message));
    }
    Ok(Some(chosen))
}

/// One line of CSV. Numbers are the shortest that read back as the same f64.
fn write_row(out: &mut dyn Write, args: &LightArgs, found: &Found, true_light: Option<&Found>) -> io::Result<()> {
    let mut numbers = Vec::with_capacity(6);
    for found in [Some(found), true_light].into_iter().flatten() {
        numbers.extend([found.light.energy, found.light.fresnel]);
        numbers.extend(of_material(args, found));
    }
    let numbers: Vec<String> = numbers.iter().map(f64::to_string).collect();
    writeln!(out, "{}", numbers.join(","))
}

/// One line of JSON. By a table, `clamped` holds the axes on which the surface and its view lie outside of it, with the
/// value used instead.
fn write_json(
    out: &mut dyn Write,
    args: &LightArgs,
    found: &Found,
    true_light: Option<&Found>,
    clamped: Option<&[Clamped]>,
) -> io::Result<()> {
    let mut line = json!({ "energy": found.light.energy, "fresnel": found.light.fresnel });
    if let Some(reflected) = of_material(args, found) {
        line["reflected"] = json!(reflected);
    }
    if let Some(true_light) = true_light {
        line["true_energy"] = json!(true_light.light.energy);
        line["true_fresnel"] = json!(true_light.light.fresnel);
        if let Some(reflected) = of_material(args, true_light) {
            line["true_reflected"] = json!(reflected);
        }
    }
    if let Some(clamped) = clamped {
        let clamped: BTreeMap<&str, f64> = clamped.iter().map(|clamped| (clamped.axis, clamped.to)).collect();
        line["clamped"] = json!(clamped);
    }
    writeln!(out, "{line}")
}
