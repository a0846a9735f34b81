//! Errors of light models, for docs/accuracy.md, lights.md, recipe.md and tradeoff.md. Tables and closed forms are
//! measured with random lights. Methods of engines and papers are measured with the lights of `ltcforge tradeoff`.

use std::{error::Error, fmt::Write as _, fs, path::Path};

use ltcforge::{
    BrdfKind, BrdfModel, Configuration, LightModel, PerAxis, PolygonLight, Preset, Recipe, RecipeDocument as _, Table,
    files::{container, tabulated::locate},
    fit::{FitSettings, Spread},
    light::{
        EVERYWHERE, Lighting, RandomLights, TableUse, engines::EngineWay, light_error, light_error_by, material_error,
        material_error_by,
    },
    shaders::GpuCost,
    view::tradeoff::LIGHTS,
};

use crate::{markdown::short, tables::fitted};

/// F0 of the materials, in addition to a perfect metal.
const MATERIALS: [f64; 2] = [0.2, 0.04];

/// Rows with errors of a table, if its file is given, and of each closed form of `model`. All use the same `count`
/// lights within the table's range. A table with two lobes has a row for each way to use them. The columns are the
/// mean, 95th percentile and largest error. Three more columns divide the mean error by the mean light that a material
/// reflects, for an F0 of 1, .2 and .04.
///
/// # Errors
/// The file cannot be read, or its light cannot be computed.
pub fn rows(table: Option<&Path>, model: LightModel, count: usize) -> Result<String, Box<dyn Error>> {
    let read = table.map(read).transpose()?;
    let ggx = BrdfModel::from(BrdfKind::Ggx);
    let brdf = read.as_ref().map_or(&ggx, |(table, _)| table.model());
    let range = read.as_ref().map_or(EVERYWHERE, |(_, range)| *range);
    let lights = RandomLights::draw(brdf, &range, count)?;
    let mut models = Vec::new();
    if let Some((table, _)) = &read {
        models.push(("table".to_owned(), Lighting::by(table)));
        if table.second_lobe().is_some() {
            let blend = TableUse { blend: true, ..TableUse::default() };
            models.push(("table, blended".to_owned(), Lighting::Table(table, blend)));
        }
    }
    for form in model.closed_forms() {
        let name = form.chosen_rule().map_or(model.to_string(), |rule| format!("`{model}`, rule `{rule}`"));
        models.push((name, Lighting::ClosedForm(form)));
    }
    let mut out = format!("{brdf}: {count} lights of mean energy {}\n\n", short(lights.mean_energy(), 3));
    out += "| model | mean | p95 | max | of the light of F0 1 | .2 | .04 |\n|---|---|---|---|---|---|---|\n";
    for (name, lighting) in models {
        let Spread { mean, p95, max } = light_error(lighting, &lights)?;
        let errors = [mean, p95, max].map(|x| short(x, 2)).join(" | ");
        let mut parts = vec![mean / lights.mean_energy()];
        if brdf.kind().has_fresnel() {
            for f0 in MATERIALS {
                parts.push(material_error(lighting, &lights, f0)?.mean / lights.mean_reflected(f0));
            }
        }
        let parts: Vec<String> = parts.iter().map(|part| format!("{:.1} %", 100.0 * part)).collect();
        // Writing to a String cannot fail.
        let _ = writeln!(out, "| {name} | {errors} | {} |", parts.join(" | "));
    }
    Ok(out)
}

type TableAndRanges = (Table, PerAxis<[f64; 2]>);

/// Reads a table from a file of `ltcforge fit`, with its ranges. If the BRDF is tabulated, its file must be next to the
/// table.
fn read(path: &Path) -> Result<TableAndRanges, Box<dyn Error>> {
    let mut file = container::decode(&fs::read(path)?)?;
    let folder = path.parent().unwrap_or(Path::new(".")).to_owned();
    file.find_brdf(&|name| Ok(locate(std::slice::from_ref(&folder), name)?.file))?;
    Ok((file.table, file.recipe.range))
}

/// A row for each method of engines and papers: errors with the lights of `tradeoff`, as in [`rows`], registers and
/// instructions. The tables cover the whole domain.
///
/// # Errors
/// None, because every method has its table.
pub fn engines(effort: Preset) -> Result<String, Box<dyn Error>> {
    let FitSettings { samples, directions, steps, .. } = effort.fit();
    let lights = RandomLights::draw(&BrdfKind::Ggx.into(), &Recipe::builder().build()?.range, LIGHTS)?;
    let mut out = "| way | mean | p95 | of the light of F0 1 | .2 | .04 | registers | instructions |\n".to_owned();
    out += "|---|---|---|---|---|---|---|---|\n";
    for way in EngineWay::ALL {
        let builder = || Recipe::builder().samples(samples).directions(directions).steps(steps);
        let recipe = way.layout().map(|layout| builder().layout(layout).build()).transpose()?;
        let table = recipe.as_ref().map(fitted);
        let reflected = |at: &Configuration, light: &PolygonLight| way.reflected(table.as_ref(), at, light);
        let Spread { mean, p95, .. } = light_error_by(reflected, &lights)?;
        let mut parts = format!("{:.1} %", 100.0 * mean / lights.mean_energy());
        for f0 in MATERIALS {
            let error = material_error_by(reflected, &lights, f0)?.mean / lights.mean_reflected(f0);
            // Writing to a String cannot fail.
            let _ = write!(parts, " | {:.1} %", 100.0 * error);
        }
        let costs = GpuCost::of(way.name()).map(|cost| format!("{} | {}", cost.registers, cost.instructions));
        let costs = costs.unwrap_or_default();
        let _ = writeln!(out, "| `{way}` | {} | {} | {parts} | {costs} |", short(mean, 2), short(p95, 2));
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mean(row: &str) -> f64 {
        row.split(" | ").nth(1).and_then(|cell| cell.parse().ok()).expect("a mean")
    }

    #[test]
    fn better_rules_have_smaller_errors_and_a_gaussian_has_larger_errors() {
        let normals = rows(None, LightModel::Normals, 60).expect("rows");
        let errors: Vec<f64> = normals.lines().skip(4).map(mean).collect();
        let [balanced, fast, fine, _exact] = errors[..] else { panic!("{normals}") };
        assert!(fast > balanced && balanced > fine && fine > 0.0, "{normals}");
        let gaussian = rows(None, LightModel::Asg, 60).expect("rows");
        let error = gaussian.lines().last().map_or(0.0, mean);
        assert!(error > fast && error < 0.06, "{gaussian}");
        assert!(rows(Some(Path::new("none")), LightModel::Ltc, 10).is_err());
    }

    #[test]
    fn engines_have_larger_errors_than_normals() {
        let text = engines(Preset::Draft).expect("rows");
        let errors: Vec<f64> = text.lines().skip(2).map(mean).collect();
        let [clipless, stretched, own, point] = errors[..] else { panic!("{text}") };
        assert!(clipless < 0.05 && stretched < 0.05 && own < 0.02 && point < 0.12 && own > 0.005, "{text}");
    }
}
