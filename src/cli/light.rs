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
    light_case::CaseFormat,
    light_picture::Picture,
    out_of_range::{Clamped, OutOfRangeCount, clamped},
    tabulated,
};
use ltcforge_fit::{BrdfKind, Table, brdf::edge_factor};
use ltcforge_light::{
    AnisotropicRoughness, LightError, LightModel, Lighting, ReflectedLight, TRUTH_TOLERANCE, TableUse,
    albedo::{compensation, sampled},
    edge_truth_of, truth_of,
};

/// Prints the reflected light of each line as soon as it is read.
pub(super) fn run(args: &LightArgs, json: bool, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let chosen = choose(args)?;
    let table = chosen.as_ref().map(|chosen| &chosen.table);
    let used = TableUse { blend: args.blend, cut: args.cut };
    let lighting = table.map(|table| Lighting::Table(table, used));
    let formula = args.model.closed_form(args.rule).map(Lighting::ClosedForm);
    let lighting = lighting.or(formula).ok_or_else(|| CommandFailure::new(Exit::Usage, needs_table(args.model)))?;
    let brdf = table.map_or(BrdfKind::Ggx.into(), |table| table.model().clone());
    let mut picture = Picture::of(args, &brdf)?;
    let lines = CsvLines::open(&args.cases, "lights")?;
    let mut out = BufWriter::new(&mut *context.stdout);
    let mut out_of_range = OutOfRangeCount::default();
    if let Some(material) = args.material
        && material != material.within_bounds()
    {
        eprintln!("material: alpha {} {} is taken as 1 where it is above", material.alpha_x, material.alpha_y);
    }
    if !json {
        writeln!(out, "{}", header(args)).map_err(|error| CommandFailure::stdout(&error))?;
    }
    let format = CaseFormat { shape: args.light, material: args.material.map(AnisotropicRoughness::within_bounds) };
    let is_header = |line: &str| format.is_header(line);
    lines.each(is_header, |line| {
        let Some(case) = format.parse(line).map_err(LineFailure::Line)? else { return Ok(()) };
        let (at, light) = (case.at, &case.light);
        let refuse = |error: LightError| LineFailure::Line(error.to_string());
        let edge_factor = |f0: f64| args.f82.map_or(0.0, |tint| edge_factor(f0, args.f90, tint));
        let gain = |albedo: &dyn Fn() -> Result<f64, LightError>, f0: f64| {
            if args.compensate { Ok(compensation(albedo()?, f0)) } else { Ok(1.0) }
        };
        let found = || -> Result<Printed, LightError> {
            let edge = if args.f82.is_some() { lighting.edge(&at, light)? } else { 0.0 };
            let of_model = |f0: f64| {
                let reflected = lighting.of_material(&at, light, [f0, args.f90])? - edge_factor(f0) * edge;
                Ok(gain(&|| lighting.albedo(&at), f0)? * reflected)
            };
            Ok(Printed {
                light: lighting.reflected(&at, light)?,
                of_material: args.f0.map(of_model).transpose()?,
                of_picture: None,
            })
        };
        let truth = || -> Result<Printed, LightError> {
            let light_truth = truth_of(&brdf, TRUTH_TOLERANCE, &at, light)?;
            let edge = if args.f82.is_some() { edge_truth_of(&brdf, TRUTH_TOLERANCE, &at, light)? } else { 0.0 };
            let of_truth = |f0: f64| {
                let reflected = light_truth.schlick(f0, args.f90) - edge_factor(f0) * edge;
                Ok(gain(&|| sampled(&brdf, &at), f0)? * reflected)
            };
            Ok(Printed { light: light_truth, of_material: args.f0.map(of_truth).transpose()?, of_picture: None })
        };
        let mut found = found().map_err(refuse)?;
        let mut truth = args.truth.then(truth).transpose().map_err(refuse)?;
        if let Some(picture) = &mut picture {
            let gained = |channels: [f64; 3], albedo: &dyn Fn() -> Result<f64, LightError>| {
                let gain = args.f0.map_or(Ok(1.0), |f0| gain(albedo, f0))?;
                Ok(channels.map(|channel| gain * channel))
            };
            let reflected = picture.reflected(table, &at, light).map_err(refuse)?;
            found.of_picture = Some(gained(reflected, &|| lighting.albedo(&at)).map_err(refuse)?);
            if let Some(truth) = &mut truth {
                let reflected = picture.truth(&at, light).map_err(refuse)?;
                truth.of_picture = Some(gained(reflected, &|| sampled(&brdf, &at)).map_err(refuse)?);
            }
        }
        let clamped = chosen.as_ref().map(|AnyTable { table, origin, .. }| clamped(&at, table, origin.range()));
        out_of_range.count(clamped.as_deref().unwrap_or_default());
        let written = if json {
            write_json(&mut out, &found, truth.as_ref(), clamped.as_deref())
        } else {
            write_row(&mut out, &found, truth.as_ref())
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
        let channels = CHANNELS.map(|channel| format!(",{prefix}{channel}")).concat();
        let channels = if args.texture.is_some() { channels } else { String::new() };
        format!("{prefix}energy,{prefix}fresnel{reflected}{channels}")
    };
    if args.truth { format!("{},{}", of(""), of("true_")) } else { of("") }
}

/// The columns of a picture.
const CHANNELS: [&str; 3] = ["red", "green", "blue"];

/// The numbers that are printed for a light.
struct Printed {
    light: ReflectedLight,
    /// What the material of `--f0` reflects, a metal with `--f82`, with `--compensate` more; `None` without the option.
    of_material: Option<f64>,
    /// What is reflected of each channel of the picture of `--texture`.
    of_picture: Option<[f64; 3]>,
}

fn needs_table(model: LightModel) -> String {
    format!("model {model} needs a table: --table TABLE")
}

/// The table that the model lights by; `None` for a model without one. All that stands against the options is told at once.
fn choose(args: &LightArgs) -> Result<Option<AnyTable>, CommandFailure> {
    let usage = |faults: &[String]| CommandFailure::new(Exit::Usage, faults.join("; "));
    let faults = option_faults(args);
    if !faults.is_empty() {
        return Err(usage(&faults));
    }
    let Some(name) = &args.table else { return Ok(None) };
    let chosen = AnyTable::named(name, &args.folder)?;
    let AnyTable { path, table, .. } = &chosen;
    let faults = table_faults(args, table);
    if !faults.is_empty() {
        return Err(usage(&[format!("{}: {}", path.display(), faults.join("; "))]));
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

/// The faults of the options, whatever the table.
fn option_faults(args: &LightArgs) -> Vec<String> {
    let model = args.model;
    let mut faults = Vec::new();
    for (option, value) in [("--f0", args.f0), ("--f82", args.f82), ("--f90", Some(args.f90))] {
        if let Some(value) = value.filter(|value| !(0.0..=1.0).contains(value)) {
            faults.push(format!("{option} {value}: a reflectance is a number from 0 to 1"));
        }
    }
    if args.table.is_some() && model.lobe().is_none() {
        faults.push("--table is of model ltc; add --model ltc, or leave it out".to_owned());
    }
    if args.table.is_none() && model.needs_table() {
        faults.push(needs_table(model));
    }
    if args.rule.is_some() && model.rule_choices().is_empty() {
        let ruled = LightModel::names_of(|other| !other.rule_choices().is_empty());
        let is_alike =
            |other: LightModel| other.rule_choices().is_empty() && other.needs_table() == model.needs_table();
        let alike = LightModel::names_of(is_alike);
        let has = if alike == model.name() { format!("model {model} has") } else { format!("models {alike} have") };
        faults.push(format!("--rule is of model {ruled}; {has} one rule"));
    }
    if args.cut && model != LightModel::Ltc {
        faults.push(format!("--cut is of model ltc; by model {model} nothing shines through from below: leave it out"));
    }
    faults
}

/// Why a table cannot light as the options say: the model, the material of `--f0`, a metal by `--f82`.
fn table_faults(args: &LightArgs, table: &Table) -> Vec<String> {
    let (brdf, lobe, model) = (table.brdf(), table.lobe, args.model);
    let lacks_edge = table.terms().is_none_or(|terms| terms.edge().is_none());
    let found = [
        (Some(lobe) != model.lobe()).then(|| format!("the table has lobe {lobe}, not {model}: choose --model {lobe}")),
        (args.compensate && !brdf.follows_reflection()).then(|| LightError::NoFacets(brdf).to_string()),
        (args.blend && table.second_matrices().is_none()).then(|| LightError::OneLobe.to_string()),
        (args.f0.is_some() && !brdf.has_fresnel()).then(|| {
            format!("--f0: brdf {brdf} has no Fresnel factor, and energy is all that it reflects: leave it out")
        }),
        (args.f82.is_some() && lacks_edge).then(|| format!("--f82: {}", LightError::NoEdge)),
    ];
    found.into_iter().flatten().collect()
}

/// One line of CSV. Numbers are the shortest that read back as the same f64.
fn write_row(out: &mut dyn Write, found: &Printed, truth: Option<&Printed>) -> io::Result<()> {
    let mut numbers = Vec::with_capacity(12);
    for Printed { light, of_material, of_picture } in [Some(found), truth].into_iter().flatten() {
        numbers.extend([light.energy, light.fresnel]);
        numbers.extend(of_material);
        numbers.extend(of_picture.iter().flatten());
    }
    let numbers: Vec<String> = numbers.iter().map(f64::to_string).collect();
    writeln!(out, "{}", numbers.join(","))
}

/// One line of JSON. By a table, `clamped` holds the axes on which the surface and its view lie outside of it, with the
/// value used instead.
fn write_json(
    out: &mut dyn Write,
    found: &Printed,
    truth: Option<&Printed>,
    clamped: Option<&[Clamped]>,
) -> io::Result<()> {
    let mut line = json!({});
    for (prefix, printed) in [("", Some(found)), ("true_", truth)] {
        let Some(Printed { light, of_material, of_picture }) = printed else { continue };
        line[format!("{prefix}energy")] = json!(light.energy);
        line[format!("{prefix}fresnel")] = json!(light.fresnel);
        if let Some(reflected) = of_material {
            line[format!("{prefix}reflected")] = json!(reflected);
        }
        for (channel, value) in CHANNELS.iter().zip(of_picture.iter().flatten()) {
            line[format!("{prefix}{channel}")] = json!(value);
        }
    }
    if let Some(clamped) = clamped {
        let clamped: BTreeMap<&str, f64> = clamped.iter().map(|clamped| (clamped.axis, clamped.to)).collect();
        line["clamped"] = json!(clamped);
    }
    writeln!(out, "{line}")
}
