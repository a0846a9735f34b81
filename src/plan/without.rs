//! Light without a table: model `normals`, whose closed form serves every material of GGX.

use serde::Serialize;

use crate::needs::Needs;
use ltcforge_fit::{BrdfKind, Layout, PerAxis, Recipe, Table};
use ltcforge_light::{LightError, LightModel, Lighting, RandomLights, light_error, normals::NormalsRule};
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

/// A rule of model `normals`, instead of a table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct WithoutTable {
    /// The rule.
    pub(crate) rule: NormalsRule,
    /// The cost of its shader for one rectangle.
    pub(crate) gpu_cost: Option<GpuCost>,
    /// Mean absolute error of the light of random rectangles, if the table was measured too.
    pub(crate) light_error: Option<f64>,
}

/// The costs and errors of a table's shader, and of the rules that need no table.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Shading {
    /// The cost of the shader that reads the table.
    pub(crate) gpu_cost: Option<GpuCost>,
    /// Whether the cost of the table's shader is within the limits.
    pub(crate) is_table_readable: bool,
    /// Mean absolute error of the table's light, if it was measured.
    pub(crate) light_error: Option<f64>,
    /// The rule with the least error within the limits; without limits, the default rule.
    pub(crate) rule: Option<NormalsRule>,
    /// The rules.
    pub(crate) without_table: Vec<WithoutTable>,
    limit: GpuLimit,
}

impl Shading {
    /// The costs for a recipe's table. Scattering models other than GGX have no rules.
    pub(crate) fn new(needs: &Needs<'_>, recipe: &Recipe, limit: GpuLimit) -> Self {
        let rules = if needs.brdf == BrdfKind::Ggx { &NormalsRule::SHADED[..] } else { &[] };
        let without = |rule: &NormalsRule| WithoutTable {
            rule: *rule,
            gpu_cost: GpuCost::of(&format!("normals {rule}")),
            light_error: None,
        };
        let without_table: Vec<WithoutTable> = rules.iter().map(without).collect();
        let within = without_table.iter().filter(|without| limit.allows(without.gpu_cost));
        // A rule with more instructions has less error.
        let instructions = |without: &&WithoutTable| without.gpu_cost.map(|cost| cost.instructions);
        let finest = if limit.is_any() { within.max_by_key(instructions) } else { without_table.first() };
        let rule = finest.map(|without| without.rule);
        let gpu_cost = text_cost_of(recipe);
        Self { gpu_cost, is_table_readable: limit.allows(gpu_cost), light_error: None, rule, without_table, limit }
    }

    /// Measures the light of the table and of the rules, over the scene's ranges or at the materials of the table, for
    /// a Fresnel factor of one. Runs on the current rayon pool.
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
            if let Some(form) = LightModel::Normals.closed_form(Some(without.rule)) {
                without.light_error = Some(mean(Lighting::ClosedForm(form))?);
            }
        }
        Ok(())
    }

    /// The summary in words: the rule without a table, and costs beyond the limits.
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
        let without = self.without_table.iter().find(|without| Some(without.rule) == self.rule);
        if let Some(WithoutTable { rule, gpu_cost, light_error }) = without {
            let within = if self.limit.is_any() { ", the finest within the limits" } else { "" };
            let errors = self.light_error.zip(*light_error);
            let errors = errors.map_or_else(String::new, |(table, other)| {
                format!("; error of light {other:.4}, with the table {table:.4}")
            });
            let own = words(*gpu_cost);
            lines.push(format!(
                "without a table: model normals, rule {rule}{within}, {own} (the table's shader: {table}){errors}"
            ));
        } else if let Some(least) =
            self.without_table.iter().min_by_key(|least| least.gpu_cost.map(|cost| cost.instructions))
        {
            let own = words(least.gpu_cost);
            let rule = least.rule;
            lines.push(format!(
                "without a table: no rule of model normals is within the limits; the shortest, {rule}, needs {own}"
            ));
        }
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Budget, Form, Scene, TablePlan};

    #[test]
    fn limits_choose_the_finest_rule_within_them() {
        let list =
            br#"{"materials": [{"alpha_x": 0.2, "alpha_y": 0.2}, {"alpha_x": 0.3, "alpha_y": 0.3, "f0": 0.04}]}"#;
        let scene = Scene::from_list(list).expect("a scene");
        let limit = |registers: Option<u32>, instructions: Option<u32>| GpuLimit { registers, instructions };
        let planned = |gpu: GpuLimit| {
            let needs = Needs::of(&scene, false).expect("lobes");
            TablePlan::new(needs, Budget::Knee, Form { gpu, ..Form::default() }, &|| true).expect("nothing stops it")
        };
        let outcome = |plan: &TablePlan<'_>| {
            (plan.shading.rule, plan.chosen.recipe.brdf.fresnel().second().is_some(), plan.is_met)
        };
        let plan = planned(limit(None, None));
        let within = |gpu: GpuLimit| outcome(&plan.within(Budget::Knee, gpu));
        assert_eq!(outcome(&plan), (Some(NormalsRule::Balanced), true, true));
        assert_eq!(within(limit(Some(96), Some(4000))), (Some(NormalsRule::Fine), true, true));
        // A blend of two lobes takes 64 registers, one lobe 48.
        assert_eq!(within(limit(Some(64), None)), (Some(NormalsRule::Fast), true, true));
        let plan = planned(limit(Some(63), None));
        assert_eq!(outcome(&plan), (None, false, true));
        assert!(!plan.within(Budget::Knee, limit(None, Some(100))).is_met);
    }
}
