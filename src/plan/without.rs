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

/// Measures the models without a table. Scattering models other than GGX need a table. Runs on the current rayon pool.
pub(crate) fn without_table(needs: &Needs<'_>, probes: &Probes) -> Vec<WithoutTable> {
    let rules = NormalsRule::SHADED.iter().map(|rule| (LightModel::Normals, Some(*rule)));
    let all = rules.chain([(LightModel::LtcFormula, None)]).filter(|_| needs.brdf == BrdfKind::Ggx);
    all.map(|(model, rule)| WithoutTable::new(model, rule, probes)).collect()
}

/// The best model within the limits: the cheapest that is far nearer than the table with this error of the light, or
/// else the nearest.
pub(crate) fn best(models: &[WithoutTable], limit: GpuLimit, of_table: Option<f64>) -> Option<&WithoutTable> {
    let key = |model: &WithoutTable| {
        let error = model.light_error.unwrap_or(f64::INFINITY);
        let is_far_nearer = of_table.is_some_and(|of_table| error <= FAR_NEARER * of_table);
        let instructions = f64::from(model.gpu_cost.map_or(u32::MAX, |cost| cost.instructions));
        (!is_far_nearer, if is_far_nearer { instructions } else { error })
    };
    let within = models.iter().filter(|model| limit.allows(model.gpu_cost));
    within.min_by(|a, b| key(a).partial_cmp(&key(b)).unwrap_or(Ordering::Equal))
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
            let name = plan.without().map(|without| without.name(" "));
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
        assert!(!tight.is_met && tight.without().is_none());
    }
}
