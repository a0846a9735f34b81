//! Plans the tables for a scene.

use axum::{
    Json,
    extract::{Request, State},
};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::{
    api::Api,
    error::bad_parameter,
    extract::{JSON, QueryOf, check_json, check_type, other_type, read_upload},
    problem::Problem,
};
use crate::service::{Planned, SCENE_LIMIT_BYTES, SceneForm};
use ltcforge_plan::{Budget, Form, GpuLimit};
use ltcforge_textures::Engine;

/// Maximum size of a list of materials.
const LIST_LIMIT_BYTES: u64 = 1 << 20;

const GLB: &str = "model/gltf-binary";

/// The query of `POST /v1/plans`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PlanParameters {
    error: Option<f64>,
    bytes: Option<u64>,
    seconds: Option<f64>,
    #[serde(default)]
    any_nodes: bool,
    #[serde(default)]
    no_terms: bool,
    registers: Option<u32>,
    instructions: Option<u32>,
    engine: Option<String>,
}

impl PlanParameters {
    fn budget(&self) -> Result<Budget, Problem> {
        let wrong = |detail: String| Err(bad_parameter(&detail));
        let is_positive = |number: f64| number.is_finite() && number > 0.0;
        match (self.error, self.bytes, self.seconds) {
            (None, None, None) => Ok(Budget::Knee),
            (Some(most), None, None) if is_positive(most) => Ok(Budget::Error(most)),
            (None, Some(most), None) if most > 0 => Ok(Budget::Bytes(most)),
            (None, None, Some(most)) if is_positive(most) => Ok(Budget::Seconds(most)),
            (Some(most), None, None) => wrong(format!("error={most}: must be a number above 0")),
            (None, Some(_), None) => wrong("bytes=0: must be a whole number above 0".to_owned()),
            (None, None, Some(most)) => wrong(format!("seconds={most}: must be a number above 0")),
            _ => wrong("give only one budget: error, bytes or seconds".to_owned()),
        }
    }
}

/// The engine with a name.
fn engine(name: &str) -> Result<Engine, Problem> {
    Engine::ALL.iter().copied().find(|engine| engine.name() == name).ok_or_else(|| {
        let known: Vec<&str> = Engine::ALL.iter().map(|engine| engine.name()).collect();
        bad_parameter(&format!("engine={name}: must be one of {}", known.join(", ")))
    })
}

/// The response to `POST /v1/plans`.
#[derive(Debug, Serialize)]
pub(super) struct PlanView {
    summary: Vec<String>,
    plan: Value,
}

/// `POST /v1/plans`.
pub(super) async fn plan(
    State(api): State<Api>,
    QueryOf(parameters): QueryOf<PlanParameters>,
    request: Request,
) -> Result<Json<PlanView>, Problem> {
    let budget = parameters.budget()?;
    let engine = parameters.engine.as_deref().map(engine).transpose()?;
    let PlanParameters { any_nodes, no_terms, registers, instructions, .. } = parameters;
    let gpu = GpuLimit { registers, instructions };
    let form = Form { any_nodes, no_terms, gpu, ..Form::of_engine(engine) };
    let (sent, limit_bytes) = if check_type(request.headers(), GLB).is_ok() {
        (SceneForm::Glb, SCENE_LIMIT_BYTES)
    } else {
        check_json(request.headers()).map_err(|given| other_type(&given, &format!("{GLB}, {JSON}")))?;
        (SceneForm::List, LIST_LIMIT_BYTES)
    };
    let (bytes, place) = read_upload(request, &api, "a scene", limit_bytes).await?;
    let plan = move |service: &crate::service::Service| {
        let planned = service.plan(bytes.into(), sent, budget, form);
        drop(place);
        planned
    };
    let Planned { plan, summary } = api.call(plan).await?;
    Ok(Json(PlanView { summary, plan }))
}
