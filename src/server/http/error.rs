//! Converts errors of the layers below to problems. Only this module maps errors to problem types.

use std::{fmt, time::Duration};

use serde::Serialize;
use serde_json::Value;

use super::{kind::ProblemKind, problem::Problem};
use crate::{
    queue::{Failure, FailureKind},
    service::{DeleteError, ExportFailure, PictureError, PlanError, ServiceError, StoreBrdfError, SubmitError},
};
use ltcforge_files::{
    recipe_document::{Fault, RecipeError},
    tabulated::TabulatedError,
};
use ltcforge_view::parameters::ParameterFault;

/// `Retry-After` of a service that is stopping. It may have restarted by then.
const RESTART: Duration = Duration::from_secs(5);

/// The problem when the service is stopping.
pub(super) fn stopping() -> Problem {
    Problem::new(ProblemKind::Stopping, "the service is stopping").with_retry_after(RESTART)
}

/// The problem when the database or the storage is unavailable.
pub(super) fn unavailable(fault: String) -> Problem {
    Problem::new(ProblemKind::Unavailable, fault).with_retry_after(RESTART)
}

/// The problem when the machine is temporarily short of a resource.
pub(super) fn lacking(detail: String) -> Problem {
    tracing::warn!("{detail}");
    Problem::new(ProblemKind::Lacking, detail).with_retry_after(RESTART)
}

/// The problem for an internal error. The error's text appears only in the log.
pub(super) fn internal(error: &dyn fmt::Display) -> Problem {
    tracing::error!("internal error: {error}");
    Problem::new(ProblemKind::Internal, "internal error; see the log of the service")
}

/// The problem for an invalid value in a path or query.
pub(super) fn bad_parameter(error: &dyn fmt::Display) -> Problem {
    Problem::new(ProblemKind::BadParameter, error.to_string())
}

/// The problem for faults in the parameters of a picture. `kind` depends on the picture.
pub(super) fn bad_parameters(kind: ProblemKind, faults: Vec<ParameterFault>) -> Problem {
    with_faults(kind, "parameters", faults)
}

/// A problem that lists the faults found in `place`.
fn with_faults<T: Serialize>(kind: ProblemKind, place: &str, faults: Vec<T>) -> Problem {
    let count = if faults.len() == 1 { "1 fault".to_owned() } else { format!("{} faults", faults.len()) };
    Problem::new(kind, format!("{count} in the {place}")).with_errors(faults)
}

impl From<RecipeError> for Problem {
    fn from(error: RecipeError) -> Self {
        match error {
            RecipeError::Json(detail) => Self::new(ProblemKind::NotJson, detail),
            RecipeError::Faults(faults) => with_faults(ProblemKind::BadRecipe, "recipe", faults),
        }
    }
}

impl From<StoreBrdfError> for Problem {
    fn from(error: StoreBrdfError) -> Self {
        match error {
            StoreBrdfError::Faults(TabulatedError(faults)) => {
                let faults = faults.into_iter().map(|detail| Fault { pointer: String::new(), detail });
                with_faults(ProblemKind::BadBrdf, "file", faults.collect())
            }
            too_many @ StoreBrdfError::TooMany(_) => Self::new(ProblemKind::BrdfLimit, too_many.to_string()),
            StoreBrdfError::Store(error) => error.into(),
        }
    }
}

impl From<PlanError> for Problem {
    fn from(error: PlanError) -> Self {
        match error {
            PlanError::Scene(faults) => with_faults(ProblemKind::BadPlan, "scene", faults),
            PlanError::Unmet(nearest, summary) => Self::new(ProblemKind::BudgetUnmet, summary).with_recipe(nearest),
            PlanError::Service(error) => error.into(),
        }
    }
}

impl From<DeleteError> for Problem {
    fn from(error: DeleteError) -> Self {
        let detail = error.to_string();
        match error {
            DeleteError::UnknownTable(_) => Self::new(ProblemKind::UnknownTable, detail),
            DeleteError::UnknownBrdf(_) => Self::new(ProblemKind::UnknownBrdf, detail),
            DeleteError::InUse(_) | DeleteError::Incomplete(_) => Self::new(ProblemKind::BrdfInUse, detail),
            DeleteError::Store(error) => error.into(),
        }
    }
}

impl From<SubmitError> for Problem {
    fn from(error: SubmitError) -> Self {
        let detail = error.to_string();
        match error {
            SubmitError::Recipe(error) => error.into(),
            SubmitError::QueueFull(_, after) => Self::new(ProblemKind::QueueFull, detail).with_retry_after(after),
            SubmitError::TooExpensive(..) => Self::new(ProblemKind::TooExpensive, detail),
            SubmitError::Store(error) => error.into(),
        }
    }
}

impl From<PictureError> for Problem {
    fn from(error: PictureError) -> Self {
        let detail = error.to_string();
        match error {
            PictureError::UnknownTable(_) | PictureError::NoTable => Self::new(ProblemKind::UnknownTable, detail),
            PictureError::QueueFull(_, after) => Self::new(ProblemKind::QueueFull, detail).with_retry_after(after),
            PictureError::TooExpensive(..) => Self::new(ProblemKind::TooExpensive, detail),
            PictureError::TooSlow(_, after) => Self::new(ProblemKind::TooSlow, detail).with_retry_after(after),
            PictureError::OtherBrdf(_) => Self::new(ProblemKind::BadParameter, detail),
            PictureError::Failed(_) => {
                tracing::error!("{detail}");
                Self::new(ProblemKind::RenderFailed, detail)
            }
            PictureError::Store(error) => error.into(),
        }
    }
}

impl From<ExportFailure> for Problem {
    fn from(failure: ExportFailure) -> Self {
        let detail = failure.to_string();
        match failure {
            ExportFailure::Refused(error) => {
                let problem = Self::new(ProblemKind::CannotExport, detail);
                let recipe = error.recipe().and_then(|recipe| serde_json::from_str::<Value>(recipe).ok());
                recipe.into_iter().fold(problem, Self::with_recipe)
            }
            ExportFailure::Lut(_) => Self::new(ProblemKind::CannotExport, detail),
            ExportFailure::TooLarge(..) => Self::new(ProblemKind::TooExpensive, detail),
            ExportFailure::QueueFull(_, after) => Self::new(ProblemKind::QueueFull, detail).with_retry_after(after),
            ExportFailure::Store(error) => error.into(),
        }
    }
}

impl From<ServiceError> for Problem {
    fn from(error: ServiceError) -> Self {
        let kind = match error {
            ServiceError::Stopping => return stopping(),
            ServiceError::Lacking(_) => return lacking(error.to_string()),
            ServiceError::LookupTable(_) => return Self::new(ProblemKind::BadParameter, error.to_string()),
            ServiceError::Corrupt(_) => ProblemKind::DamagedBlob,
            ServiceError::DiskFull => ProblemKind::DiskFull,
            ServiceError::Unavailable(_) => ProblemKind::Unavailable,
            ServiceError::Storage(_) => ProblemKind::Storage,
        };
        tracing::error!("{error}");
        match kind {
            ProblemKind::Unavailable => unavailable(error.to_string()),
            kind => Self::new(kind, error.to_string()),
        }
    }
}

impl From<&Failure> for Problem {
    fn from(failure: &Failure) -> Self {
        let kind = match failure.kind {
            FailureKind::DiskFull => ProblemKind::DiskFull,
            FailureKind::Storage => ProblemKind::Storage,
            FailureKind::Attempts => ProblemKind::FitFailed,
        };
        Self::new(kind, failure.detail.clone())
    }
}

#[cfg(test)]
mod tests {
    use axum::response::IntoResponse as _;

    use super::*;

    #[test]
    fn every_error_of_the_layers_below_has_its_status() {
        let fault = Fault { pointer: String::new(), detail: String::new() };
        let cases: [(Problem, u16); 24] = [
            (SubmitError::Recipe(RecipeError::Json("x".into())).into(), 400),
            (SubmitError::Recipe(RecipeError::Faults(vec![fault])).into(), 422),
            (StoreBrdfError::Faults(TabulatedError(vec!["x".into()])).into(), 422),
            (StoreBrdfError::Store(ServiceError::DiskFull).into(), 507),
            (PlanError::Scene(Vec::new()).into(), 422),
            (PlanError::Unmet(serde_json::json!({}), "x".into()).into(), 422),
            (PlanError::Service(ServiceError::Stopping).into(), 503),
            (SubmitError::QueueFull(1, RESTART).into(), 429),
            (SubmitError::Store(ServiceError::Stopping).into(), 503),
            (PictureError::NoTable.into(), 404),
            (PictureError::QueueFull(1, RESTART).into(), 429),
            (PictureError::TooExpensive(31.0, 30.0).into(), 422),
            (PictureError::TooSlow(RESTART, RESTART).into(), 503),
            (PictureError::OtherBrdf("x".into()).into(), 400),
            (PictureError::Failed("x".into()).into(), 500),
            (ExportFailure::TooLarge(2, 1).into(), 422),
            (ExportFailure::QueueFull(1, RESTART).into(), 429),
            (ExportFailure::Store(ServiceError::Stopping).into(), 503),
            (SubmitError::Store(ServiceError::DiskFull).into(), 507),
            (ServiceError::Storage("x".into()).into(), 500),
            (ServiceError::Unavailable("x".into()).into(), 503),
            (ServiceError::Lacking("x".into()).into(), 503),
            ((&Failure { kind: FailureKind::DiskFull, detail: "x".into() }).into(), 507),
            ((&Failure { kind: FailureKind::Attempts, detail: "x".into() }).into(), 500),
        ];
        for (problem, status) in cases {
            let shown = format!("{problem:?}");
            // Every message about a limit names it. The limits of exports and waiting pictures have no flag.
            let is_limit = shown.contains("TooSlow") || shown.contains("TooExpensive") || shown.contains("QueueFull");
            let names_it =
                ["`--picture-", "`--queue-limit`", "exports", "pictures"].iter().any(|name| shown.contains(name));
            assert!(!is_limit || names_it, "{shown}");
            assert_eq!(problem.into_response().status().as_u16(), status, "{shown}");
        }
    }

    #[test]
    fn a_stopping_service_says_when_to_try_again() {
        for problem in [Problem::from(SubmitError::Store(ServiceError::Stopping)), stopping()] {
            assert_eq!(problem.into_response().headers()["retry-after"], "5");
        }
    }
}
