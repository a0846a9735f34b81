//! Light without a table: models `ltc-formula` and `normals`, which serve every material of GGX.

use std::cmp::Ordering;

use serde::Serialize;

use crate::{needs::Needs, probes::Probes};
use ltcforge_fit::{BrdfKind, Recipe};
use ltcforge_light::{LightModel, Lighting, normals::NormalsRule};
use ltcforge_shaders::{GpuCost, GpuLimit};

/// The closed form serves a scene better than a table if its error is below this part of the table's.
pub(crate) const FAR_NEARER: f64 = 0.7;

/// The cost of the shader that reads a recipe's table.
pub(crate) fn text_cost_of(recipe: &Recipe) -> Option<GpuCost> {
    GpuCost::of_layout(recipe.layout.name(), recipe.brdf.fresnel().second().is_some())
}

/// A model without a table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WithoutTable {
    /// The model.
    pub model: LightModel,
    /// Its rule, if it has rules.
    pub rule: Option<NormalsRule>,
    /// The cost of its shader for one rectangle.
    pub(crate) gpu_cost: Option<GpuCost>,
    /// Mean absolute error of the light, and the error at each place.
    pub(crate) light_error: Option<f64>,
    #[serde(skip)]
    pub(crate) light: Option<Vec<f64>>,
}

impl WithoutTable {
    fn new(model: LightModel, rule: Option<NormalsRule>, probes: &Probes) -> Self {
        let light = model.closed_form(rule).and_then(|form| probes.light_errors(Lighting::ClosedForm(form)));
        let light_error = light.as_ref().map(|errors| probes.mean(errors));
        let mut without = Self { model, rule, gpu_cost: None, light_error, light };
        // The lobe of a metal takes fewer instructions, but a shader serves all materials.
        let plastic = if model == LightModel::LtcFormula { ", plastic" } else { "" };
        without.gpu_cost = GpuCost::of(&format!("{}{plastic}", without.name(" ")));
        without
    }

    /// The rule, or the name of a model without rules.
    pub(crate) fn in_words(&self) -> String {
        self.rule.map_or_else(|| format!("model {}", self.model), |rule| format!("rule {rule}"))
    }

    /// The model, and its rule after `before`.
    pub(crate) fn name(&self, before: &str) -> String {
        self.rule.map_or_else(|| self.model.to_string(), |rule| format!("{}{before}{rule}", self.model))
    }
}

/// The costs of a table's shader, and the costs and errors of the models that need no table.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Shading {
    /// The cost of the shader that reads the table.
    pub(crate) gpu_cost: Option<GpuCost>,
    /// Whether the cost of the table's shader is within the limits.
    pub(crate) is_table_readable: bool,
    /// The index of the best model without a table.
    chosen: Option<usize>,
    /// The models without a table.
    pub(crate) without_table: Vec<WithoutTable>,
    limit: GpuLimit,
}

impl Shading {
    /// Measures the models without a table. Scattering models other than GGX need a table. Runs on the current rayon
    /// pool.
    pub(crate) fn new(needs: &Needs<'_>, probes: &Probes, limit: GpuLimit) -> Self {
        let forms = NormalsRule::SHADED.iter().map(|rule| (LightModel::Normals, Some(*rule)));
        let forms = forms.chain([(LightModel::LtcFormula, None)]).filter(|_| needs.brdf == BrdfKind::Ggx);
        let without_table = forms.map(|(model, rule)| WithoutTable::new(model, rule, probes)).collect();
        Self { gpu_cost: None, is_table_readable: true, chosen: None, without_table, limit }
    }

    /// Compares the models with a recipe's table. The best model is within the limits. It is the cheapest that is far
    /// nearer than the table, or else the nearest.
    pub(crate) fn compare(&mut self, recipe: &Recipe, light_error: Option<f64>) {
        self.gpu_cost = text_cost_of(recipe);
        self.is_table_readable = self.limit.allows(self.gpu_cost);
        let most = light_error.map_or(0.0, |error| FAR_NEARER * error);
        let is_far = |error: f64| error <= most;
        let key = |without: &WithoutTable| {
            let (error, cost) =
                (without.light_error.unwrap_or(f64::INFINITY), without.gpu_cost.map(|cost| cost.instructions));
            (!is_far(error), if is_far(error) { f64::from(cost.unwrap_or(u32::MAX)) } else { error })
        };
        let within = self.without_table.iter().enumerate().filter(|(_, without)| self.limit.allows(without.gpu_cost));
        let best = within.min_by(|(_, a), (_, b)| key(a).partial_cmp(&key(b)).unwrap_or(Ordering::Equal));
        self.chosen = best.map(|(index, _)| index);
    }

    /// The best model without a table within the limits.
    pub(crate) fn without(&self) -> Option<&WithoutTable> {
        self.chosen.map(|chosen| &self.without_table[chosen])
    }

    /// The costs in words: of the table's shader, and of the model without a table.
    pub(crate) fn words(&self) -> String {
        let words = |cost: Option<GpuCost>| match cost {
            Some(GpuCost { registers, instructions, .. }) => {
                format!("{registers} registers, {instructions} instructions")
            }
            None => "not counted".to_owned(),
        };
        let without = self.without().map_or_else(String::new, |without| {
            format!("; without a table: model {}, {}", without.name(", rule "), words(without.gpu_cost))
        });
        format!("shader of the table: {}{without}", words(self.gpu_cost))
    }

    /// The reasons that the GPU limits exclude the table or every model without a table.
    pub(crate) fn beyond(&self) -> Vec<String> {
        let mut lines = Vec::new();
        if !self.is_table_readable {
            lines.push("the table's shader exceeds the GPU limits".to_owned());
        }
        let cheapest = self.without_table.iter().min_by_key(|least| least.gpu_cost.map(|cost| cost.instructions));
        if let Some(cheapest) = cheapest.filter(|_| self.chosen.is_none()) {
            let needs = cheapest.gpu_cost.map_or(0, |cost| cost.instructions);
            let name = cheapest.name(" ");
            lines.push(format!("no model without a table is within the GPU limits: {name} needs {needs} instructions"));
        }
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Budget, Form, Scene, TablePlan};

    #[test]
    fn the_cheapest_model_within_the_limits_is_chosen_if_it_is_nearer_than_the_table() {
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
        assert_eq!(outcome(&plan), named("normals fast", true, true));
        // A blend of two lobes takes 64 registers, one lobe 48.
        assert_eq!(within(limit(Some(64), None)), named("normals fast", true, true));
        let plan = planned(limit(Some(63), None));
        assert_eq!(outcome(&plan), named("ltc-formula", false, true));
        let tight = plan.within(Budget::Knee, limit(None, Some(100)));
        assert!(!tight.is_met && tight.shading.without().is_none());
    }
}
