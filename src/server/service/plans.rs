//! Plans the tables for a scene.

use serde_json::Value;

use super::{Service, ServiceError};
use ltcforge_plan::{Budget, Form, Needs, Scene, SceneError, SceneFault, TablePlan, document, recipe_value, words};

/// Maximum size of a scene.
pub const SCENE_LIMIT_BYTES: u64 = 64 << 20;

/// The format of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SceneForm {
    /// A GLB that contains all its buffers.
    Glb,
    /// A list of materials in JSON.
    List,
}

/// A plan within the budget.
#[derive(Debug, Clone, PartialEq)]
pub struct Planned {
    /// The plan, as in `plan.json`.
    pub plan: Value,
    /// The lines of the plan's summary.
    pub summary: Vec<String>,
}

/// Why there is no plan.
#[derive(Debug, thiserror::Error)]
pub enum PlanError {
    /// The scene has faults.
    #[error("{} fault(s) in the scene", .0.len())]
    Scene(Vec<SceneFault>),
    /// No table is within the budget. The values are the recipe of the table that comes closest, and the summary of its
    /// plan.
    #[error("{1}")]
    Unmet(Value, String),
    /// The service is stopping.
    #[error(transparent)]
    Service(#[from] ServiceError),
}

impl From<SceneError> for PlanError {
    fn from(error: SceneError) -> Self {
        match error {
            SceneError::Faults(faults) => Self::Scene(faults),
            SceneError::Stopped => Self::Service(ServiceError::Stopping),
            other => Self::Scene(vec![SceneFault { pointer: String::new(), detail: other.to_string() }]),
        }
    }
}

impl Service {
    /// Plans the tables for a scene within a budget.
    ///
    /// # Errors
    /// See [`PlanError`].
    pub fn plan(&self, bytes: Vec<u8>, sent: SceneForm, budget: Budget, form: Form) -> Result<Planned, PlanError> {
        let go_on = || !self.is_stopping();
        let scene = match sent {
            SceneForm::Glb => self.state.pool.install(|| Scene::from_bytes(bytes, &go_on))?,
            SceneForm::List => Scene::from_list(&bytes)?,
        };
        let mut plans = Vec::new();
        // An engine's own layout holds one scattering model.
        let models = [false, true].into_iter().filter(|sheen| !sheen || form.layout.is_none());
        for needs in models.filter_map(|sheen| Needs::of(&scene, sheen)) {
            let plan = self.state.pool.install(|| TablePlan::new(needs, budget, form, &go_on));
            plans.push(plan.map_err(|_| ServiceError::Stopping)?);
        }
        let summary = words(&scene, &plans, false);
        match plans.iter().find(|plan| !plan.is_met) {
            Some(unmet) => Err(PlanError::Unmet(recipe_value(&unmet.chosen.recipe), summary.join("; "))),
            None => Ok(Planned { plan: document(&scene, &plans), summary }),
        }
    }
}
