//! No table at all: model `normals`, whose closed form lights every material of GGX.

use serde::Serialize;

use crate::needs::Needs;
use ltcforge_fit::{BrdfKind, PerAxis, Table};
use ltcforge_light::{LightError, LightModel, Lighting, RandomLights, light_error, normals::NormalsRule};
use ltcforge_shaders::GpuCost;

/// Random rectangles over the scene's ranges by which table and model are compared.
const LIGHTS: usize = 500;

/// A rule of model `normals`, in place of a table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WithoutTable {
    /// The rule.
    pub rule: NormalsRule,
    /// What its text costs a GPU, for one rectangle.
    pub gpu_cost: Option<GpuCost>,
    /// Mean absolute error of the light of random rectangles, where a table was measured beside it.
    pub light_error: Option<f64>,
}

/// What stands beside a table: the same figures of its own text and light, and the rules that need no table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Beside {
    /// What the text that reads the table costs a GPU.
    pub gpu_cost: Option<GpuCost>,
    /// Mean absolute error of the table's light, where it was measured.
    pub light_error: Option<f64>,
    /// The rules.
    pub without_table: Vec<WithoutTable>,
}

impl Beside {
    /// The rules beside a table of a layout, by their costs; none where the scattering model is not GGX.
    pub(crate) fn new(needs: &Needs<'_>, layout: &str) -> Self {
        let rules = if needs.brdf().kind() == BrdfKind::Ggx { &NormalsRule::SHADED[..] } else { &[] };
        let of = |rule: &NormalsRule| WithoutTable {
            rule: *rule,
            gpu_cost: GpuCost::of(&format!("normals {rule}")),
            light_error: None,
        };
        let gpu_cost = GpuCost::of(&format!("ltc {layout}"));
        Self { gpu_cost, light_error: None, without_table: rules.iter().map(of).collect() }
    }

    /// Measures the light of the table and of the rules, over the scene's ranges or at the materials of the table, for a
    /// Fresnel factor of one. Runs on the current rayon pool.
    ///
    /// # Errors
    /// Where the table's light cannot be told.
    pub(crate) fn measure(&mut self, needs: &Needs<'_>, table: &Table) -> Result<(), LightError> {
        let of_pair = |[alpha, ratio]: [f64; 2]| PerAxis { alpha: [alpha; 2], ratio: [ratio; 2], ..needs.range() };
        let mut ranges: Vec<PerAxis<[f64; 2]>> = table.materials().map(of_pair).collect();
        if ranges.is_empty() {
            ranges.push(needs.range());
        }
        let each = LIGHTS.div_ceil(ranges.len());
        let draw = |range| RandomLights::draw(&needs.brdf().kind().into(), range, each);
        let lights = ranges.iter().map(draw).collect::<Result<Vec<_>, _>>()?;
        let mean = |lighting: Lighting<'_>| -> Result<f64, LightError> {
            let errors = lights.iter().map(|lights| light_error(lighting, lights).map(|error| error.mean));
            Ok(errors.collect::<Result<Vec<_>, _>>()?.iter().sum::<f64>() / lights.len() as f64)
        };
        self.light_error = Some(mean(Lighting::by(table))?);
        for without in &mut self.without_table {
            if let Some(form) = LightModel::Normals.closed_form(Some(without.rule)) {
                without.light_error = Some(mean(Lighting::ClosedForm(form))?);
            }
        }
        Ok(())
    }

    /// The summary in words: the default rule beside the table.
    pub(crate) fn words(&self) -> Option<String> {
        let without = self.without_table.first()?;
        let cost = |of: Option<GpuCost>| {
            of.map_or_else(
                || "not counted".to_owned(),
                |of| format!("{} registers, {} instructions", of.registers, of.instructions),
            )
        };
        let errors = self.light_error.zip(without.light_error);
        let errors = errors
            .map_or_else(String::new, |(table, other)| format!("; error of light {other:.4}, the table's {table:.4}"));
        Some(format!(
            "without a table: model normals, rule {}, {} (the table's shader: {}){errors}",
            without.rule,
            cost(without.gpu_cost),
            cost(self.gpu_cost)
        ))
    }
}
