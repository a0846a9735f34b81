//! `light`: the light that surfaces reflect from area lights.

use serde_json::{Map, Value, json};

use super::{
    AnyTable, CommandFailure, Context, CsvLines, Exit, LineFailure, Rows, clamped, file_failure, light_args::LightArgs,
    light_case::CaseFormat, light_picture::Picture, tabulated, usage,
};
use ltcforge_fit::{BrdfKind, Table, brdf::edge_factor};
use ltcforge_light::{
    AnisotropicRoughness, LightError, LightModel, Lighting, ReflectedLight, TRUTH_TOLERANCE, TableUse,
    albedo::{compensation, sampled},
    edge_truth_of, truth_of,
};

/// Prints the reflected light of each line as soon as the line is read.
pub(super) fn run(args: &LightArgs, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let chosen = choose(args)?;
    let table = chosen.as_ref().map(|chosen| &chosen.table);
    let used = TableUse { blend: args.blend, cut: args.cut };
    let lighting = table.map(|table| Lighting::Table(table, used));
    let formula = args.model.closed_form(args.rule).map(Lighting::ClosedForm);
    let lighting = lighting.or(formula).ok_or_else(|| usage(needs_table(args.model)))?;
    let brdf = table.map_or(BrdfKind::Ggx.into(), |table| table.model().clone());
    let mut picture = Picture::of(args, &brdf)?;
    let lines = CsvLines::open(&args.cases, "lights")?;
    if let Some(material) = args.material
        && material != material.within_bounds()
    {
        eprintln!("material: alpha {} {} is clamped to 1", material.alpha_x, material.alpha_y);
    }
    let columns = columns(args);
    let mut rows = Rows::new(context, &columns)?;
    let format = CaseFormat { shape: args.light, material: args.material.map(AnisotropicRoughness::within_bounds) };
    lines.each(
        |line| format.is_header(line),
        |line| {
            let Some(case) = format.parse(line).map_err(LineFailure::Line)? else { return Ok(()) };
            let (at, light) = (case.at, &case.light);
            let mut numbers = || -> Result<Vec<f64>, LightError> {
                let channels = picture.as_mut().map(|picture| picture.reflected(table, &at, light)).transpose()?;
                let mut numbers = Of {
                    args,
                    light: lighting.reflected(&at, light)?,
                    material: &|fresnel| lighting.of_material(&at, light, fresnel),
                    edge: &|| lighting.edge(&at, light),
                    albedo: &|| lighting.albedo(&at),
                }
                .numbers(channels)?;
                if args.truth {
                    let light_truth = truth_of(&brdf, TRUTH_TOLERANCE, &at, light)?;
                    let truth = Of {
                        args,
                        material: &|[f0, f90]| Ok(light_truth.schlick(f0, f90)),
                        edge: &|| edge_truth_of(&brdf, TRUTH_TOLERANCE, &at, light),
                        albedo: &|| sampled(&brdf, &at),
                        light: light_truth,
                    };
                    let channels = picture.as_ref().map(|picture| picture.truth(&at, light)).transpose()?;
                    numbers.extend(truth.numbers(channels)?);
                }
                Ok(numbers)
            };
            let numbers = numbers().map_err(|error| LineFailure::Line(error.to_string()))?;
            let clamped = chosen.as_ref().map(|AnyTable { table, origin, .. }| clamped(&at, table, origin.range()));
            // Each number has the fewest digits that parse to the same f64.
            let row = || numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
            let value = || columns.iter().cloned().zip(numbers.iter().map(|number| json!(number)));
            rows.print(clamped.as_deref(), row, || Value::Object(value().collect::<Map<_, _>>()))
        },
    )?;
    rows.end()
}

/// The columns of a row.
fn columns(args: &LightArgs) -> Vec<String> {
    let reflected: &[_] = if args.f0.is_some() { &["reflected"] } else { &[] };
    let channels: &[_] = if args.texture.is_some() { &["red", "green", "blue"] } else { &[] };
    let names = [&["energy", "fresnel"], reflected, channels].concat();
    let prefixes: &[_] = if args.truth { &["", "true_"] } else { &[""] };
    prefixes.iter().flat_map(|prefix| names.iter().map(move |name| format!("{prefix}{name}"))).collect()
}

/// Functions that evaluate a light, by a model or by quadrature.
struct Of<'a> {
    args: &'a LightArgs,
    light: ReflectedLight,
    /// The light reflected by a material with these reflectances at normal and at grazing incidence.
    material: &'a dyn Fn([f64; 2]) -> Result<f64, LightError>,
    /// The light that the F82 term of a metal removes, divided by `edge_factor`.
    edge: &'a dyn Fn() -> Result<f64, LightError>,
    albedo: &'a dyn Fn() -> Result<f64, LightError>,
}

impl Of<'_> {
    /// The numbers of a row, in the order of [`columns`]. `channels` are the reflected channels of the `--texture`
    /// picture.
    fn numbers(&self, channels: Option<[f64; 3]>) -> Result<Vec<f64>, LightError> {
        let LightArgs { f0, f82, f90, compensate, .. } = *self.args;
        let mut numbers = vec![self.light.energy, self.light.fresnel];
        let gain = match f0 {
            Some(f0) if compensate => compensation((self.albedo)()?, f0),
            _ => 1.0,
        };
        if let Some(f0) = f0 {
            let edge = match f82 {
                Some(tint) => edge_factor(f0, f90, tint) * (self.edge)()?,
                None => 0.0,
            };
            numbers.push(gain * ((self.material)([f0, f90])? - edge));
        }
        numbers.extend(channels.into_iter().flatten().map(|channel| gain * channel));
        Ok(numbers)
    }
}

fn needs_table(model: LightModel) -> String {
    format!("model {model} needs a table: add --table TABLE")
}

/// Reads the model's table; `None` for a model without a table. An error lists all invalid options.
fn choose(args: &LightArgs) -> Result<Option<AnyTable>, CommandFailure> {
    let faults = option_faults(args);
    if !faults.is_empty() {
        return Err(usage(faults.join("; ")));
    }
    let Some(name) = &args.table else { return Ok(None) };
    let chosen = AnyTable::named(name, &args.folder)?;
    let AnyTable { path, table, .. } = &chosen;
    let faults = table_faults(args, table);
    if !faults.is_empty() {
        return Err(usage(format!("{}: {}", path.display(), faults.join("; "))));
    }
    if args.truth {
        tabulated::check_complete(table, path)?;
    }
    if table.terms.is_none() {
        return Err(file_failure(path, &LightError::NoTerms));
    }
    Ok(Some(chosen))
}

/// Invalid options that can be found without the table.
fn option_faults(args: &LightArgs) -> Vec<String> {
    let model = args.model;
    let mut faults = Vec::new();
    for (option, value) in [("--f0", args.f0), ("--f82", args.f82), ("--f90", Some(args.f90))] {
        if let Some(value) = value.filter(|value| !(0.0..=1.0).contains(value)) {
            faults.push(format!("{option} {value}: a reflectance must be between 0 and 1"));
        }
    }
    if args.table.is_some() && model.lobe().is_none() {
        faults.push("--table needs a model that reads tables: add --model ltc".to_owned());
    }
    if args.table.is_none() && model.needs_table() {
        faults.push(needs_table(model));
    }
    if args.rule.is_some() && model.rule_choices().is_empty() {
        let ruled = LightModel::names_of(|other| !other.rule_choices().is_empty());
        faults.push(format!("--rule is only for model {ruled}, not for {model}: leave it out"));
    }
    if args.cut && model != LightModel::Ltc {
        faults.push(format!("--cut is only for model ltc, not for {model}: leave it out"));
    }
    faults
}

/// Options that this table does not support.
fn table_faults(args: &LightArgs, table: &Table) -> Vec<String> {
    let (brdf, lobe, model) = (table.brdf(), table.lobe, args.model);
    let lacks_edge = table.terms().is_none_or(|terms| terms.edge().is_none());
    let found = [
        (Some(lobe) != model.lobe())
            .then(|| format!("the table has lobe {lobe}: use --model {lobe} instead of {model}")),
        (args.compensate && !brdf.follows_reflection()).then(|| LightError::NoFacets(brdf).to_string()),
        (args.blend && table.second_matrices().is_none()).then(|| LightError::OneLobe.to_string()),
        (args.f0.is_some() && !brdf.has_fresnel())
            .then(|| format!("--f0: brdf {brdf} has no Fresnel factor: leave it out")),
        (args.f82.is_some() && lacks_edge).then(|| format!("--f82: {}", LightError::NoEdge)),
    ];
    found.into_iter().flatten().collect()
}
