//! `report --model`: the error of the light of tables and closed forms, by a measure that both share.

use std::fmt::Write as _;

use serde_json::json;

use super::{CommandFailure, Context, Exit, args::ReportArgs, input::AnyTable, print, tabulated};
use ltcforge_fit::{BrdfKind, BrdfModel, Spread};
use ltcforge_light::{
    ClosedForm, EVERYWHERE, LightError, LightModel, Lighting, RandomLights, TableUse, light_error, material_error,
};

/// The default number of random rectangles.
const LIGHTS: u32 = 2000;

/// Reflectances seen from above of the materials whose error is told: metal is 1, plastic 0.04.
const MATERIALS: [f64; 2] = [0.2, 0.04];

/// A model and its error.
struct Row {
    name: String,
    model: LightModel,
    error: Spread,
    /// The error of each of [`MATERIALS`]; none for a scattering model without a Fresnel factor.
    of_materials: Vec<Spread>,
}

impl Row {
    fn measure(
        name: String,
        model: LightModel,
        lighting: Lighting<'_>,
        lights: &RandomLights,
    ) -> Result<Self, LightError> {
        let of_material = |f0: &f64| material_error(lighting, lights, *f0);
        let of_materials = if lights.brdf().kind().has_fresnel() {
            MATERIALS.iter().map(of_material).collect::<Result<_, _>>()?
        } else {
            Vec::new()
        };
        Ok(Self { name, model, error: light_error(lighting, lights)?, of_materials })
    }
}

/// Measures a table or the chosen model, and each rule of model normals, by the same lights.
pub(super) fn run(
    args: &ReportArgs,
    model: LightModel,
    read: Option<&AnyTable>,
    json: bool,
    context: &mut Context<'_>,
) -> Result<Exit, CommandFailure> {
    let usage = |what: &str| Err(CommandFailure::new(Exit::Usage, what));
    if model.needs_table() && read.is_none() {
        return usage(&LightError::NeedsTable(model).to_string());
    }
    if args.rule.is_some() && model.rule_choices().is_empty() {
        let name = LightModel::names_of(|model| !model.rule_choices().is_empty());
        return usage(&format!("--rule belongs to model {name}"));
    }
    if let Some(any) = read.filter(|any| !model.needs_table() && any.table.brdf != BrdfKind::Ggx) {
        return usage(&format!("{}: {}", any.path.display(), LightError::OtherBrdf(any.table.brdf())));
    }
    if args.points.is_some() || args.extremes {
        return usage("--points and --extremes belong to the lobes of a table, without --model");
    }
    if let Some(any) = read {
        tabulated::check_complete(&any.table, &any.path)?;
    }
    let ggx = BrdfModel::from(BrdfKind::Ggx);
    let brdf = read.map_or(&ggx, |any| any.table.model());
    let range = read.map_or(EVERYWHERE, |any| *any.origin.range());
    let count = args.lights.unwrap_or(LIGHTS) as usize;
    let measure = || -> Result<(RandomLights, Vec<Row>), CommandFailure> {
        let failed = |error: LightError| CommandFailure::new(Exit::Failed, error.to_string());
        let lights = RandomLights::draw(brdf, &range, count).map_err(failed)?;
        let mut rows = Vec::new();
        if let Some(any) = read {
            let name = format!("{}, table {}", any.table.lobe, &any.digest.hex()[..12]);
            let table = Lighting::by(&any.table);
            rows.push(Row::measure(name.clone(), LightModel::Ltc, table, &lights).map_err(failed)?);
            if any.table.second_lobe().is_some() {
                let (name, blend) = (
                    format!("{name}, blended"),
                    Lighting::Table(&any.table, TableUse { blend: true, ..TableUse::default() }),
                );
                rows.push(Row::measure(name, LightModel::Ltc, blend, &lights).map_err(failed)?);
            }
        }
        let is_asked = |form: &ClosedForm| args.rule.is_none_or(|rule| form.rule() == rule);
        for form in model.closed_forms().filter(is_asked) {
            let name = form.chosen_rule().map_or(model.to_string(), |rule| format!("{model}, rule {rule}"));
            rows.push(Row::measure(name, model, Lighting::ClosedForm(form), &lights).map_err(failed)?);
        }
        Ok((lights, rows))
    };
    let (lights, rows) = args.threads.pool()?.install(measure)?;
    let value = json!({
        "lights": lights.len(),
        "mean_energy": lights.mean_energy(),
        "brdf": brdf.kind(),
        "range": range,
        "models": rows.iter().map(|row| row_value(row, &lights)).collect::<Vec<_>>(),
    });
    print(context.stdout, json, &value, text(&lights, &rows).trim_end())?;
    Ok(Exit::Ok)
}

fn row_value(Row { name, model, error, of_materials }: &Row, lights: &RandomLights) -> serde_json::Value {
    let of_material = |(f0, error): (&f64, &Spread)| json!({ "f0": f0, "mean_reflected": lights.mean_reflected(*f0), "error": error });
    let materials: Vec<_> = MATERIALS.iter().zip(of_materials).map(of_material).collect();
    json!({ "name": name, "model": model, "error": error, "materials": materials })
}

fn text(lights: &RandomLights, rows: &[Row]) -> String {
    let mut out = format!(
        "error of the light of {} random rectangles of radiance one, of which surfaces reflect {:.3} on average\n\n{:32}{:>10}{:>9}{:>9}\n",
        lights.len(),
        lights.mean_energy(),
        "",
        "mean",
        "p95",
        "max"
    );
    for Row { name, error: Spread { mean, p95, max }, .. } in rows {
        // Writing to a String cannot fail.
        let _ = writeln!(out, "{name:32}{mean:>10.5}{p95:>9.5}{max:>9.5}");
    }
    if rows.iter().any(|row| !row.of_materials.is_empty()) {
        let heads = MATERIALS.map(|f0| format!("{:>10}", format!("F0 {f0}"))).concat();
        let _ = writeln!(out, "\n{:32}{:>10}{heads}", "mean error, % of the mean light", "F0 1");
        for Row { name, error, of_materials, .. } in rows {
            let part = |error: &Spread, mean: f64| format!("{:>10.2}", 100.0 * error.mean / mean);
            let parts = MATERIALS.iter().zip(of_materials).map(|(f0, error)| part(error, lights.mean_reflected(*f0)));
            let _ = writeln!(out, "{name:32}{}{}", part(error, lights.mean_energy()), parts.collect::<String>());
        }
    }
    out + "\n0 is perfect. The truth is adaptive quadrature; the Fresnel factor is one, or Schlick's by F0. docs/report.md explains the measure."
}
