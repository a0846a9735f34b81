//! The one table from errors to statuses, and the errors of the layers below as problems.

use std::{fmt, time::Duration};

use axum::http::StatusCode;

use super::problem::Problem;
use crate::{
    files::recipe::RecipeError,
    server::{
        queue::{Failure, FailureKind},
        service::{PictureError, ServiceError, SubmitError},
    },
    view::parameters::ParameterFault,
};

/// When a client that met a stopping service may try its successor.
const RESTART: Duration = Duration::from_secs(5);

/// What kind of problem: decides status, title and `type`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    NotJson,
    BadRecipe,
    BodyTooLarge,
    BadBody,
    NotJsonType,
    BadParameter,
    BadScene,
    BadPlot,
    NoSuchPath,
    UnknownJob,
    UnknownTable,
    UnknownRecipe,
    MethodNotAllowed,
    RangeNotSatisfiable,
    QueueFull,
    TooSlow,
    RenderFailed,
    Stopping,
    DamagedBlob,
    DiskFull,
    Storage,
    FitFailed,
    Internal,
}

/// A line of the table.
pub(super) struct Row {
    pub(super) status: StatusCode,
    /// Last segment of the problem's `type`.
    pub(super) slug: &'static str,
    pub(super) title: &'static str,
}

const fn row(status: StatusCode, slug: &'static str, title: &'static str) -> Row {
    Row { status, slug, title }
}

impl Kind {
    /// The table.
    pub(super) const fn row(self) -> Row {
        match self {
            Self::NotJson => row(StatusCode::BAD_REQUEST, "not-json", "The body is not JSON"),
            Self::BadBody => row(StatusCode::BAD_REQUEST, "bad-body", "The body could not be read"),
            Self::BadParameter => row(StatusCode::BAD_REQUEST, "bad-parameter", "A parameter is malformed"),
            Self::BadScene => row(StatusCode::UNPROCESSABLE_ENTITY, "bad-scene", "The scene has faults"),
            Self::BadPlot => row(StatusCode::UNPROCESSABLE_ENTITY, "bad-plot", "The plot has faults"),
            Self::NoSuchPath => row(StatusCode::NOT_FOUND, "no-such-path", "There is no such path"),
            Self::UnknownJob => row(StatusCode::NOT_FOUND, "unknown-job", "There is no such job"),
            Self::UnknownTable => row(StatusCode::NOT_FOUND, "unknown-table", "There is no such table"),
            Self::UnknownRecipe => row(StatusCode::NOT_FOUND, "unknown-recipe", "There is no such recipe"),
            Self::MethodNotAllowed => {
                row(StatusCode::METHOD_NOT_ALLOWED, "method-not-allowed", "The path does not know this method")
            }
            Self::BodyTooLarge => row(StatusCode::PAYLOAD_TOO_LARGE, "body-too-large", "The body is too large"),
            Self::NotJsonType => row(StatusCode::UNSUPPORTED_MEDIA_TYPE, "not-json-type", "A recipe is sent as JSON"),
            Self::RangeNotSatisfiable => {
                row(StatusCode::RANGE_NOT_SATISFIABLE, "range-not-satisfiable", "The range lies outside the file")
            }
            Self::BadRecipe => row(StatusCode::UNPROCESSABLE_ENTITY, "bad-recipe", "The recipe has faults"),
            Self::QueueFull => row(StatusCode::TOO_MANY_REQUESTS, "queue-full", "The queue is full"),
            Self::TooSlow => row(StatusCode::SERVICE_UNAVAILABLE, "too-slow", "The picture took too long"),
            Self::RenderFailed => row(StatusCode::INTERNAL_SERVER_ERROR, "render-failed", "The renderer failed"),
            Self::Stopping => row(StatusCode::SERVICE_UNAVAILABLE, "stopping", "The service is stopping"),
            Self::DamagedBlob => row(StatusCode::INTERNAL_SERVER_ERROR, "damaged-blob", "The stored table is damaged"),
            Self::DiskFull => row(StatusCode::INSUFFICIENT_STORAGE, "disk-full", "The disk is full"),
            Self::Storage => row(StatusCode::INTERNAL_SERVER_ERROR, "storage", "The storage failed"),
            Self::FitFailed => row(StatusCode::INTERNAL_SERVER_ERROR, "fit-failed", "The fit failed"),
            Self::Internal => row(StatusCode::INTERNAL_SERVER_ERROR, "internal", "The service is at fault"),
        }
    }
}

/// The problem of a service that is stopping.
pub(super) fn stopping() -> Problem {
    Problem::new(Kind::Stopping, "the service is stopping").with_retry_after(RESTART)
}

/// A defect of the service: logged in full, told in short.
pub(super) fn internal(defect: &dyn fmt::Display) -> Problem {
    tracing::error!("a request ended in a defect: {defect}");
    Problem::new(Kind::Internal, "the request met a defect of the service, which has been logged")
}

/// The problem of a picture whose parameters have faults; `kind` says of which picture.
pub(super) fn bad_parameters(kind: Kind, faults: Vec<ParameterFault>) -> Problem {
    Problem::new(kind, format!("{} in the parameters", count(faults.len()))).with_errors(faults)
}

fn count(faults: usize) -> String {
    if faults == 1 { "1 fault".to_owned() } else { format!("{faults} faults") }
}

impl From<RecipeError> for Problem {
    fn from(error: RecipeError) -> Self {
        match error {
            RecipeError::Json(detail) => Self::new(Kind::NotJson, detail),
            RecipeError::Faults(faults) => {
                Self::new(Kind::BadRecipe, format!("{} in the recipe", count(faults.len()))).with_errors(faults)
            }
        }
    }
}

impl From<SubmitError> for Problem {
    fn from(error: SubmitError) -> Self {
        let detail = error.to_string();
        match error {
            SubmitError::Recipe(error) => error.into(),
            SubmitError::QueueFull { retry_after, .. } => {
                Self::new(Kind::QueueFull, detail).with_retry_after(retry_after)
            }
            SubmitError::Stopping => stopping(),
            SubmitError::Store(error) => error.into(),
        }
    }
}

impl From<PictureError> for Problem {
    fn from(error: PictureError) -> Self {
        let detail = error.to_string();
        match error {
            PictureError::UnknownTable(_) | PictureError::NoTable => Self::new(Kind::UnknownTable, detail),
            PictureError::QueueFull { retry_after, .. } => {
                Self::new(Kind::QueueFull, detail).with_retry_after(retry_after)
            }
            PictureError::TooSlow { retry_after, .. } => Self::new(Kind::TooSlow, detail).with_retry_after(retry_after),
            PictureError::Stopping => stopping(),
            PictureError::Failed(_) => {
                tracing::error!("{detail}");
                Self::new(Kind::RenderFailed, detail)
            }
            PictureError::Store(error) => error.into(),
        }
    }
}

impl From<ServiceError> for Problem {
    fn from(error: ServiceError) -> Self {
        tracing::error!("{error}");
        let kind = match error {
            ServiceError::Corrupt { .. } => Kind::DamagedBlob,
            ServiceError::DiskFull => Kind::DiskFull,
            ServiceError::Storage(_) => Kind::Storage,
        };
        Self::new(kind, error.to_string())
    }
}

impl From<&Failure> for Problem {
    fn from(failure: &Failure) -> Self {
        let kind = match failure.kind {
            FailureKind::DiskFull => Kind::DiskFull,
            FailureKind::Storage => Kind::Storage,
            FailureKind::Attempts => Kind::FitFailed,
        };
        Self::new(kind, failure.detail.clone())
    }
}

#[cfg(test)]
mod tests {
    use axum::response::IntoResponse as _;

    use super::*;
    use crate::files::recipe::Fault;

    #[test]
    fn every_error_of_the_layers_below_has_its_status() {
        let fault = Fault { pointer: String::new(), detail: String::new() };
        let cases: [(Problem, u16); 12] = [
            (SubmitError::Recipe(RecipeError::Json("x".into())).into(), 400),
            (SubmitError::Recipe(RecipeError::Faults(vec![fault])).into(), 422),
            (SubmitError::QueueFull { limit: 1, retry_after: RESTART }.into(), 429),
            (SubmitError::Stopping.into(), 503),
            (PictureError::NoTable.into(), 404),
            (PictureError::QueueFull { limit: 1, retry_after: RESTART }.into(), 429),
            (PictureError::TooSlow { limit: RESTART, retry_after: RESTART }.into(), 503),
            (PictureError::Failed("x".into()).into(), 500),
            (SubmitError::Store(ServiceError::DiskFull).into(), 507),
            (ServiceError::Storage("x".into()).into(), 500),
            ((&Failure { kind: FailureKind::DiskFull, detail: "x".into() }).into(), 507),
            ((&Failure { kind: FailureKind::Attempts, detail: "x".into() }).into(), 500),
        ];
        for (problem, status) in cases {
            let shown = format!("{problem:?}");
            assert_eq!(problem.into_response().status().as_u16(), status, "{shown}");
        }
    }

    #[test]
    fn who_is_asked_to_come_back_is_told_when() {
        for problem in [Problem::from(SubmitError::Stopping), stopping()] {
            assert_eq!(problem.into_response().headers()["retry-after"], "5");
        }
    }
}
