//! `light`: the light that surfaces reflect from area lights.

use serde_json::{Map, Value, json};

use super::{
    AnyTable, CommandFailure, Context, CsvLines, Exit, LineFailure, Rows, clamped, file_failure, light_args::LightArgs,
    light_case::CaseFormat, light_picture::Picture, occluders, tabulated, usage,
};
use ltcforge_fit::{BrdfKind, Table, brdf::f82_light};
use ltcforge_light::{
    AnisotropicRoughness, AnyLight, LightError, LightModel, LightShape, Lighting, ReflectedLight, TRUTH_TOLERANCE,
    TableUse,
    albedo::{compensation, sampled},
    edge_truth_of,
    shadow::shadowed,
    truth_of,
};

/// Prints the reflected light of each line as soon as the line is read.
pub(super) fn run(args: &LightArgs, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let chosen = choose(args)?;
    let table = chosen.as_ref().map(|chosen| &chosen.table);
    let lighting = table.map(|table| Lighting::Table(table, TableUse { blend: args.blend, cut: args.cut }));
    let formula = args.model.closed_form(args.rule).map(|form| Lighting::ClosedForm(form.with_cut(args.cut)));
    let lighting = lighting.or(formula).ok_or_else(|| usage(LightError::NeedsTable(args.model)))?;
    let brdf = table.map_or(BrdfKind::Ggx.into(), |table| table.model().clone());
    let mut picture = Picture::of(args, &brdf)?;
    if [Some(&args.cases), args.occluders.as_ref()].iter().all(|path| path.is_some_and(|path| path.as_os_str() == "-"))
    {
        return Err(usage("only one of the lights and the occluders can be `-`, standard input"));
    }
    let occluders = args.occluders.as_deref().map(occluders::read).transpose()?;
    let lines = CsvLines::open(&args.cases, "lights")?;
    if let Some(material) = args.material
        && material != material.within_bounds()
    {
        eprintln!("material: alpha {} {} is clamped to 1", material.alpha_x, material.alpha_y);
    }
    let columns = columns(args);
    let mut rows = Rows::new(context, &columns);
    let format = CaseFormat { shape: args.light, material: args.material.map(AnisotropicRoughness::within_bounds) };
    // The errors that the input line did not cause. The numbers of these results are unknown, as NaN.
    let mut unknown = Vec::new();
    let of_light = (columns.len() - shadow_columns(args).len()) / (1 + usize::from(args.truth));
    let mut known = |found: Result<Vec<f64>, LightError>, count: usize| match found {
        Err(error @ (LightError::NotConverged { .. } | LightError::Singular)) => {
            unknown.push(error);
            Ok(vec![f64::NAN; count])
        }
        found => found.map_err(|error| LineFailure::Line(error.to_string())),
    };
    lines.each(
        |line| format.is_header(line),
        |line| {
            let Some(case) = format.parse(line).map_err(LineFailure::Line)? else { return Ok(()) };
            let (at, light) = (case.at, &case.light);
            let mut by_model = || -> Result<Vec<f64>, LightError> {
                let channels = picture.as_mut().map(|picture| picture.reflected(table, &at, light)).transpose()?;
                let model = Of {
                    args,
                    light: lighting.reflected(&at, light)?,
                    material: &|fresnel| lighting.of_material(&at, light, fresnel),
                    edge: &|| lighting.edge(&at, light),
                    albedo: &|| lighting.albedo(&at),
                };
                model.numbers(channels)
            };
            let mut numbers = known(by_model(), of_light)?;
            let by_truth = || -> Result<Vec<f64>, LightError> {
                let light_truth = truth_of(&brdf, TRUTH_TOLERANCE, &at, light)?;
                let truth = Of {
                    args,
                    material: &|[f0, f90]| Ok(light_truth.schlick(f0, f90)),
                    edge: &|| edge_truth_of(&brdf, TRUTH_TOLERANCE, &at, light),
                    albedo: &|| sampled(&brdf, &at),
                    light: light_truth,
                };
                truth.numbers(picture.as_ref().map(|picture| picture.truth(&at, light)).transpose()?)
            };
            if args.truth {
                numbers.extend(known(by_truth(), of_light)?);
            }
            if let (Some(occluders), AnyLight::Polygon(light)) = (&occluders, light) {
                let found = truth_of(&brdf, TRUTH_TOLERANCE, &at, light)
                    .and_then(|whole| shadowed(&brdf, &at, light, whole, occluders, SHADOW_DRAWS));
                let reflected = |found: ReflectedLight| args.f0.map(|f0| found.schlick(f0, args.f90));
                let found =
                    found.map(|found| [found.energy, found.fresnel].into_iter().chain(reflected(found)).collect());
                numbers.extend(known(found, shadow_columns(args).len())?);
            }
            let clamped = chosen.as_ref().map(|AnyTable { table, origin, .. }| clamped(&at, table, origin.range()));
            // Each number has the fewest digits that parse to the same f64. Unknown numbers are empty.
            let text = |number: &f64| if number.is_nan() { String::new() } else { number.to_string() };
            let row = || numbers.iter().map(text).collect::<Vec<_>>().join(",");
            let value = || columns.iter().cloned().zip(numbers.iter().map(|number| json!(number)));
            rows.print(clamped.as_deref(), row, || Value::Object(value().collect::<Map<_, _>>()))
        },
    )?;
    if let Some(first) = unknown.first() {
        eprintln!("unknown results (empty in CSV, null in JSON): {}, the first because {first}", unknown.len());
    }
    rows.end()
}

/// The columns of a row.
fn columns(args: &LightArgs) -> Vec<String> {
    let reflected: &[_] = if args.f0.is_some() { &["reflected"] } else { &[] };
    let channels: &[_] = if args.texture.is_some() { &["red", "green", "blue"] } else { &[] };
    let names = [&["energy", "fresnel"], reflected, channels].concat();
    let prefixes: &[_] = if args.truth { &["", "true_"] } else { &[""] };
    let columns = prefixes.iter().flat_map(|prefix| names.iter().map(move |name| format!("{prefix}{name}")));
    columns.chain(shadow_columns(args).iter().map(|name| (*name).to_owned())).collect()
}

/// Draws per light with occluders. The error is about 1e-4 of the light.
const SHADOW_DRAWS: u32 = 1 << 16;

/// The last columns of a row.
fn shadow_columns(args: &LightArgs) -> &'static [&'static str] {
    match (&args.occluders, args.f0) {
        (None, _) => &[],
        (Some(_), None) => &["shadowed_energy", "shadowed_fresnel"],
        (Some(_), Some(_)) => &["shadowed_energy", "shadowed_fresnel", "shadowed_reflected"],
    }
}

/// Functions that evaluate a light, by a model or by quadrature.
struct Of<'a> {
    args: &'a LightArgs,
    light: ReflectedLight,
    /// The light reflected by a material with these reflectances at normal and at grazing incidence.
    material: &'a dyn Fn([f64; 2]) -> Result<f64, LightError>,
    /// The light weighted by F82's edge weight.
    edge: &'a dyn Fn() -> Result<f64, LightError>,
    albedo: &'a dyn Fn() -> Result<f64, LightError>,
}

impl Of<'_> {
    /// The numbers of a row, in the order of [`columns`]. `channels` are the reflected channels of the `--texture`
    /// picture.
    fn numbers(&self, channels: Option<[f64; 3]>) -> Result<Vec<f64>, LightError> {
        let LightArgs { f0, f82, f90, compensate, .. } = *self.args;
        let mut numbers = vec![self.light.energy, self.light.fresnel];
        // Option `--compensate` requires `--f0`.
        let gain = if compensate { compensation((self.albedo)()?, f0.unwrap_or(1.0)) } else { 1.0 };
        if let Some(f0) = f0 {
            let schlick = (self.material)([f0, f90])?;
            numbers.push(
                gain * match f82 {
                    Some(tint) => f82_light(schlick, (self.edge)()?, [f0, f90], tint),
                    None => schlick,
                },
            );
        }
        numbers.extend(channels.into_iter().flatten().map(|channel| gain * channel));
        Ok(numbers)
    }
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
    let ruled = LightModel::names_of(|other| !other.rule_choices().is_empty());
    let reflectance = |option: &str, value: Option<f64>| {
        let value = value.filter(|value| !(0.0..=1.0).contains(value))?;
        Some(format!("{option} {value}: a reflectance must be between 0 and 1"))
    };
    let found = [
        reflectance("--f0", args.f0),
        reflectance("--f82", args.f82),
        reflectance("--f90", Some(args.f90)),
        (args.table.is_some() && model.lobe().is_none())
            .then(|| "--table needs a model that reads tables: add --model ltc".to_owned()),
        (args.table.is_none() && model.needs_table()).then(|| LightError::NeedsTable(model).to_string()),
        (args.rule.is_some() && model.rule_choices().is_empty())
            .then(|| format!("--rule is only for model {ruled}, not for {model}: leave it out")),
        (args.occluders.is_some() && args.light != LightShape::Polygon)
            .then(|| format!("--occluders is only for polygons, not for a {}: leave it out", args.light)),
        (args.cut && !model.is_of_ltcs())
            .then(|| format!("--cut is only for models ltc and ltc-formula, not for {model}: leave it out")),
    ];
    found.into_iter().flatten().collect()
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
