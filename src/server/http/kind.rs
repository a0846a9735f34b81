//! The types of problems: the one table from a type to its status and title.

use axum::http::StatusCode;

/// The type of a problem: decides its status, its title and the `type` in its document.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ProblemKind {
    BadRequest,
    NotJson,
    BadRecipe,
    BodyTooLarge,
    BadBody,
    NotJsonType,
    BadParameter,
    BadScene,
    BadPlot,
    ForeignOrigin,
    NoSuchPath,
    UnknownJob,
    UnknownTable,
    UnknownRecipe,
    UnknownBrdf,
    BadBrdf,
    UnknownExport,
    UnknownFile,
    OtherBytes,
    CannotExport,
    MethodNotAllowed,
    SlowRequest,
    PreconditionFailed,
    UriTooLong,
    RangeNotSatisfiable,
    TooExpensive,
    WrongHost,
    HeadTooLarge,
    QueueFull,
    TooManyConnections,
    TooSlow,
    RenderFailed,
    Stopping,
    Lacking,
    DamagedBlob,
    DiskFull,
    Storage,
    Unavailable,
    FitFailed,
    Internal,
}

/// A row of the table.
pub(super) struct KindRow {
    pub(super) status: StatusCode,
    /// Last segment of the problem's `type`.
    pub(super) slug: &'static str,
    pub(super) title: &'static str,
}

const fn row(status: StatusCode, slug: &'static str, title: &'static str) -> KindRow {
    KindRow { status, slug, title }
}

impl ProblemKind {
    /// The row of this type.
    pub(super) const fn row(self) -> KindRow {
        match self {
            Self::BadRequest => row(StatusCode::BAD_REQUEST, "bad-request", "The request is malformed"),
            Self::NotJson => row(StatusCode::BAD_REQUEST, "not-json", "The body is not JSON"),
            Self::BadBody => row(StatusCode::BAD_REQUEST, "bad-body", "The body could not be read"),
            Self::BadParameter => row(StatusCode::BAD_REQUEST, "bad-parameter", "A parameter is malformed"),
            Self::BadScene => row(StatusCode::UNPROCESSABLE_ENTITY, "bad-scene", "The scene has faults"),
            Self::BadPlot => row(StatusCode::UNPROCESSABLE_ENTITY, "bad-plot", "The plot has faults"),
            Self::ForeignOrigin => row(StatusCode::FORBIDDEN, "foreign-origin", "The page is of another site"),
            Self::NoSuchPath => row(StatusCode::NOT_FOUND, "no-such-path", "There is no such path"),
            Self::UnknownJob => row(StatusCode::NOT_FOUND, "unknown-job", "There is no such job"),
            Self::UnknownTable => row(StatusCode::NOT_FOUND, "unknown-table", "There is no such table"),
            Self::UnknownRecipe => row(StatusCode::NOT_FOUND, "unknown-recipe", "There is no such recipe"),
            Self::UnknownBrdf => row(StatusCode::NOT_FOUND, "unknown-brdf", "There is no such BRDF"),
            Self::BadBrdf => row(StatusCode::UNPROCESSABLE_ENTITY, "bad-brdf", "The BRDF has faults"),
            Self::UnknownExport => row(StatusCode::NOT_FOUND, "unknown-export", "There is no such export"),
            Self::UnknownFile => row(StatusCode::NOT_FOUND, "unknown-file", "The export has no such file"),
            Self::OtherBytes => row(StatusCode::CONFLICT, "other-bytes", "The file has other bytes"),
            Self::CannotExport => row(StatusCode::UNPROCESSABLE_ENTITY, "cannot-export", "The table has no such files"),
            Self::MethodNotAllowed => {
                row(StatusCode::METHOD_NOT_ALLOWED, "method-not-allowed", "The path does not allow this method")
            }
            Self::SlowRequest => {
                row(StatusCode::REQUEST_TIMEOUT, "slow-request", "The request took too long to arrive")
            }
            Self::PreconditionFailed => {
                row(StatusCode::PRECONDITION_FAILED, "precondition-failed", "There is another version")
            }
            Self::UriTooLong => row(StatusCode::URI_TOO_LONG, "uri-too-long", "Path and query are too long"),
            Self::BodyTooLarge => row(StatusCode::PAYLOAD_TOO_LARGE, "body-too-large", "The body is too large"),
            Self::NotJsonType => {
                row(StatusCode::UNSUPPORTED_MEDIA_TYPE, "not-json-type", "The body is of another media type")
            }
            Self::RangeNotSatisfiable => {
                row(StatusCode::RANGE_NOT_SATISFIABLE, "range-not-satisfiable", "The range lies outside the file")
            }
            Self::BadRecipe => row(StatusCode::UNPROCESSABLE_ENTITY, "bad-recipe", "The recipe has faults"),
            Self::TooExpensive => row(StatusCode::UNPROCESSABLE_ENTITY, "too-expensive", "It would take too long"),
            Self::WrongHost => row(StatusCode::MISDIRECTED_REQUEST, "wrong-host", "The service has another name"),
            Self::HeadTooLarge => {
                row(StatusCode::REQUEST_HEADER_FIELDS_TOO_LARGE, "head-too-large", "The head is too large")
            }
            Self::QueueFull => row(StatusCode::TOO_MANY_REQUESTS, "queue-full", "The queue is full"),
            Self::TooManyConnections => {
                row(StatusCode::SERVICE_UNAVAILABLE, "too-many-connections", "Too many connections are open")
            }
            Self::TooSlow => row(StatusCode::SERVICE_UNAVAILABLE, "too-slow", "The picture took too long"),
            Self::RenderFailed => row(StatusCode::INTERNAL_SERVER_ERROR, "render-failed", "The renderer failed"),
            Self::Stopping => row(StatusCode::SERVICE_UNAVAILABLE, "stopping", "The service is stopping"),
            Self::Lacking => {
                row(StatusCode::SERVICE_UNAVAILABLE, "lacking", "The machine lacks something for a moment")
            }
            Self::DamagedBlob => row(StatusCode::INTERNAL_SERVER_ERROR, "damaged-blob", "The stored table is damaged"),
            Self::DiskFull => row(StatusCode::INSUFFICIENT_STORAGE, "disk-full", "The disk is full"),
            Self::Storage => row(StatusCode::INTERNAL_SERVER_ERROR, "storage", "The storage failed"),
            Self::Unavailable => row(StatusCode::SERVICE_UNAVAILABLE, "unavailable", "The storage does not answer now"),
            Self::FitFailed => row(StatusCode::INTERNAL_SERVER_ERROR, "fit-failed", "The fit failed"),
            Self::Internal => row(StatusCode::INTERNAL_SERVER_ERROR, "internal", "The service is at fault"),
        }
    }
}
