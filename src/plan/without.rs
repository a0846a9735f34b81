//! Light without a table: models `ltc-formula` and `normals`, which serve every material of GGX.

use serde::Serialize;

use crate::needs::Needs;
use ltcforge_fit::{BrdfKind, Layout, PerAxis, Recipe, Table};
use ltcforge_light::{ClosedForm, LightError, LightModel, Lighting, RandomLights, light_error, normals::NormalsRule};
use ltcforge_shaders::GpuCost;

/// Number of random rectangular lights, over the scene's ranges, for which table and model are compared. Tests do not
/// need accurate errors.
const LIGHTS: usize = if cfg!(test) { 50 } else { 500 };

/// Limits of the GPU cost of a shader, see [`GpuCost`].
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct GpuLimit {
    /// Maximum number of vector registers.
    pub registers: Option<u32>,
    /// Maximum number of instructions.
    pub instructions: Option<u32>,
}

impl GpuLimit {
    /// Whether a cost is within the limits. An unknown cost exceeds every limit.
    pub(crate) fn allows(self, cost: Option<GpuCost>) -> bool {
        let within = |limit: Option<u32>, count: fn(GpuCost) -> u32| {
            limit.is_none_or(|most| cost.is_some_and(|cost| count(cost) <= most))
        };
        within(self.registers, |cost| cost.registers) && within(self.instructions, |cost| cost.instructions)
    }

    /// Whether there is a limit.
    fn is_any(self) -> bool {
        self != Self::default()
    }
}

/// The cost of the shader that reads tables of a layout, with one or two lobes per entry.
pub(crate) fn text_cost(layout: Layout, is_two: bool) -> Option<GpuCost> {
    let blended = if is_two { ", blended" } else { "" };
    GpuCost::of(&format!("ltc {layout}{blended}"))
}

/// The cost of the shader that reads a recipe's table.
pub(crate) fn text_cost_of(recipe: &Recipe) -> Option<GpuCost> {
    text_cost(recipe.layout, recipe.brdf.fresnel().second().is_some())
}

/// A model without a table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct WithoutTable {
    /// The model.
    pub(crate) model: LightModel,
    /// Its rule, if it has rules.
    pub(crate) rule: Option<NormalsRule>,
    /// The cost of its shader for one rectangle.
    pub(crate) gpu_cost: Option<GpuCost>,
    /// Mean absolute error of the light of random rectangles, if the table was measured too.
    pub(crate) light_error: Option<f64>,
}

impl WithoutTable {
    fn new(model: LightModel, rule: Option<NormalsRule>) -> Self {
        let mut without = Self { model, rule, gpu_cost: None, light_error: None };
        // The lobe of a metal takes fewer instructions, but a shader serves all materials.
        let plastic = if model == LightModel::LtcFormula { ", plastic" } else { "" };
        without.gpu_cost = GpuCost::of(&format!("{}{plastic}", without.name(" ")));
        without
    }

    fn form(&self) -> Option<ClosedForm> {
        self.model.closed_form(self.rule)
    }

    /// The model, and its rule after `before`.
    fn name(&self, before: &str) -> String {
        self.rule.map_or_else(|| self.model.to_string(), |rule| format!("{}{before}{rule}", self.model))
    }
}

/// The costs and errors of a table's shader, and of the models that need no table.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Shading {
    /// The cost of the shader that reads the table.
    pub(crate) gpu_cost: Option<GpuCost>,
    /// Whether the cost of the table's shader is within the limits.
    pub(crate) is_table_readable: bool,
    /// Mean absolute error of the table's light, if it was measured.
    pub(crate) light_error: Option<f64>,
    /// The index of the model without a table: the one with the least error within the limits; without limits, model
    /// `normals` with its default rule.
    chosen: Option<usize>,
    /// The models without a table.
    pub(crate) without_table: Vec<WithoutTable>,
    limit: GpuLimit,
}

impl Shading {
    /// The costs for a recipe's table. Scattering models other than GGX need a table.
    pub(crate) fn new(needs: &Needs<'_>, recipe: &Recipe, limit: GpuLimit) -> Self {
        let forms = NormalsRule::SHADED.iter().map(|rule| (LightModel::Normals, Some(*rule)));
        let forms = forms.chain([(LightModel::LtcFormula, None)]).filter(|_| needs.brdf == BrdfKind::Ggx);
        let without_table: Vec<WithoutTable> = forms.map(|(model, rule)| WithoutTable::new(model, rule)).collect();
        let mut within = without_table.iter().enumerate().filter(|(_, without)| limit.allows(without.gpu_cost));
        // A model with more instructions has less error.
        let instructions = |(_, without): &(usize, &WithoutTable)| without.gpu_cost.map(|cost| cost.instructions);
        let finest = if limit.is_any() { within.max_by_key(instructions) } else { within.next() };
        let chosen = finest.map(|(i, _)| i);
        let gpu_cost = text_cost_of(recipe);
        Self { gpu_cost, is_table_readable: limit.allows(gpu_cost), light_error: None, chosen, without_table, limit }
    }

    /// The best model without a table within the limits.
    pub(crate) fn without(&self) -> Option<&WithoutTable> {
        self.chosen.map(|chosen| &self.without_table[chosen])
    }

    /// Measures the light of the table and of the models without a table, over the scene's ranges or at the materials of
    /// the table, for a Fresnel factor of one. Runs on the current rayon pool.
    ///
    /// # Errors
    /// When the table cannot light surfaces.
    pub(crate) fn measure(&mut self, needs: &Needs<'_>, table: &Table) -> Result<(), LightError> {
        let of_pair = |[alpha, ratio]: [f64; 2]| PerAxis { alpha: [alpha; 2], ratio: [ratio; 2], ..needs.range };
        let mut ranges: Vec<PerAxis<[f64; 2]>> = table.materials().map(of_pair).collect();
        if ranges.is_empty() {
            ranges.push(needs.range);
        }
        let each = LIGHTS.div_ceil(ranges.len());
        let draw = |range| RandomLights::draw(&needs.brdf.into(), range, each);
        let lights = ranges.iter().map(draw).collect::<Result<Vec<_>, _>>()?;
        let mean = |lighting: Lighting<'_>| -> Result<f64, LightError> {
            let errors = lights.iter().map(|lights| light_error(lighting, lights).map(|error| error.mean));
            Ok(errors.sum::<Result<f64, _>>()? / lights.len() as f64)
        };
        self.light_error = Some(mean(Lighting::by(table))?);
        for without in &mut self.without_table {
            if let Some(form) = without.form() {
                without.light_error = Some(mean(Lighting::ClosedForm(form))?);
            }
        }
        Ok(())
    }

    /// The summary in words: the model without a table, and costs beyond the limits.
    pub(crate) fn words(&self) -> Vec<String> {
        let words = |cost: Option<GpuCost>| match cost {
            Some(GpuCost { registers, instructions, .. }) => {
                format!("{registers} registers, {instructions} instructions")
            }
            None => "not counted".to_owned(),
        };
        let table = words(self.gpu_cost);
        let mut lines = Vec::new();
        if !self.is_table_readable {
            lines.push(format!("the table's shader exceeds the GPU limits: {table}"));
        }
        if let Some(without @ WithoutTable { gpu_cost, light_error, .. }) = self.without() {
            let within = if self.limit.is_any() { ", the finest within the limits" } else { "" };
            let errors = self.light_error.zip(*light_error);
            let errors = errors.map_or_else(String::new, |(table, other)| {
                format!("; error of light {other:.4}, with the table {table:.4}")
            });
            let own = words(*gpu_cost);
            lines.push(format!(
                "without a table: model {}{within}, {own} (the table's shader: {table}){errors}",
                without.name(", rule ")
            ));
        } else if let Some(least) =
            self.without_table.iter().min_by_key(|least| least.gpu_cost.map(|cost| cost.instructions))
        {
            let own = words(least.gpu_cost);
            let name = least.name(" ");
            lines.push(format!("without a table: no model is within the limits; the cheapest, {name}, needs {own}"));
        }
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Budget, Form, Scene, TablePlan};

    #[test]
    fn limits_choose_the_finest_model_within_them() {
        let list =
            br#"{"materials": [{"alpha_x": 0.2, "alpha_y": 0.2}, {"alpha_x": 0.3, "alpha_y": 0.3, "f0": 0.04}]}"#;
        let scene = Scene::from_list(list).expect("a scene");
        let limit = |registers: Option<u32>, instructions: Option<u32>| GpuLimit { registers, instructions };
        let planned = |gpu: GpuLimit| {
            let needs = Needs::of(&scene, false).expect("lobes");
            TablePlan::new(needs, Budget::Knee, Form { gpu, ..Form::default() }, &|| true).expect("nothing stops it")
        };
        let outcome = |plan: &TablePlan<'_>| {
            let name = plan.shading.without().map(|without| without.name(" "));
            (name, plan.chosen.recipe.brdf.fresnel().second().is_some(), plan.is_met)
        };
        let named = |name: &str, is_two, is_met| (Some(name.to_owned()), is_two, is_met);
        let plan = planned(limit(None, None));
        let within = |gpu: GpuLimit| outcome(&plan.within(Budget::Knee, gpu));
        assert_eq!(outcome(&plan), named("normals balanced", true, true));
        assert_eq!(within(limit(Some(96), Some(4000))), named("normals fine", true, true));
        // A blend of two lobes takes 64 registers, one lobe 48.
        assert_eq!(within(limit(Some(64), None)), named("normals fast", true, true));
        let plan = planned(limit(Some(63), None));
        assert_eq!(outcome(&plan), named("ltc-formula", false, true));
        let tight = plan.within(Budget::Knee, limit(None, Some(100)));
        assert!(!tight.is_met && tight.shading.without().is_none());
    }
}
