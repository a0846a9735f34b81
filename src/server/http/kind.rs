//! The types of problems. Only this table maps a type to its status and title.

use axum::http::StatusCode;

/// Declares each type: its name, status, last segment of `type`, and title.
macro_rules! problem_kinds {
    ($($name:ident: $status:ident, $slug:literal, $title:literal;)*) => {
        /// The type of a problem.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub(super) enum ProblemKind {
            $($name,)*
        }

        impl ProblemKind {
            /// Status, `type` and title. The type is a relative reference, which never changes.
            pub(super) const fn row(self) -> (StatusCode, &'static str, &'static str) {
                match self {
                    $(Self::$name => (StatusCode::$status, concat!("/problems/", $slug), $title),)*
                }
            }
        }
    };
}

problem_kinds! {
    BadRequest: BAD_REQUEST, "bad-request", "The request is malformed";
    NotJson: BAD_REQUEST, "not-json", "The body is not JSON";
    BadRecipe: UNPROCESSABLE_ENTITY, "bad-recipe", "The recipe has faults";
    BodyTooLarge: PAYLOAD_TOO_LARGE, "body-too-large", "The body is too large";
    BadBody: BAD_REQUEST, "bad-body", "The body could not be read";
    NotJsonType: UNSUPPORTED_MEDIA_TYPE, "not-json-type", "The media type of the body is not accepted";
    BadParameter: BAD_REQUEST, "bad-parameter", "A parameter is malformed";
    BadScene: UNPROCESSABLE_ENTITY, "bad-scene", "The scene has faults";
    BadPlot: UNPROCESSABLE_ENTITY, "bad-plot", "The parameters of the plot have faults";
    NoToken: UNAUTHORIZED, "no-token", "The request needs a token";
    OutOfScope: FORBIDDEN, "out-of-scope", "The token does not allow this";
    ForeignOrigin: FORBIDDEN, "foreign-origin", "The request comes from a page of another site";
    NoSuchPath: NOT_FOUND, "no-such-path", "There is no such path";
    UnknownJob: NOT_FOUND, "unknown-job", "There is no such job";
    UnknownTable: NOT_FOUND, "unknown-table", "There is no such table";
    RemovedTable: NOT_FOUND, "removed-table", "The table was removed";
    UnknownRecipe: NOT_FOUND, "unknown-recipe", "There is no such recipe";
    UnknownBrdf: NOT_FOUND, "unknown-brdf", "There is no such BRDF";
    BrdfInUse: CONFLICT, "brdf-in-use", "A recipe uses the BRDF";
    BrdfLimit: INSUFFICIENT_STORAGE, "brdf-limit", "The limit of stored BRDFs is reached";
    BadBrdf: UNPROCESSABLE_ENTITY, "bad-brdf", "The BRDF has faults";
    BadPlan: UNPROCESSABLE_ENTITY, "bad-plan", "The scene of the plan has faults";
    BudgetUnmet: UNPROCESSABLE_ENTITY, "budget-unmet", "No table is within the budget";
    UnknownExport: NOT_FOUND, "unknown-export", "There is no such export";
    UnknownFile: NOT_FOUND, "unknown-file", "The export has no such file";
    OtherBytes: CONFLICT, "other-bytes", "The file has another digest";
    CannotExport: UNPROCESSABLE_ENTITY, "cannot-export", "The table does not support this export";
    MethodNotAllowed: METHOD_NOT_ALLOWED, "method-not-allowed", "The path does not allow this method";
    SlowRequest: REQUEST_TIMEOUT, "slow-request", "The request took too long to arrive";
    PreconditionFailed: PRECONDITION_FAILED, "precondition-failed", "The condition If-Match does not hold";
    RangeNotSatisfiable: RANGE_NOT_SATISFIABLE, "range-not-satisfiable", "The range is outside of the file";
    TooExpensive: UNPROCESSABLE_ENTITY, "too-expensive", "The request would take too long";
    WrongHost: MISDIRECTED_REQUEST, "wrong-host", "The service does not accept this host name";
    QueueFull: TOO_MANY_REQUESTS, "queue-full", "The queue is full";
    Busy: SERVICE_UNAVAILABLE, "busy", "Too many requests are being served";
    TooSlow: SERVICE_UNAVAILABLE, "too-slow", "The picture took too long";
    RenderFailed: INTERNAL_SERVER_ERROR, "render-failed", "The renderer failed";
    Stopping: SERVICE_UNAVAILABLE, "stopping", "The service is stopping";
    Lacking: SERVICE_UNAVAILABLE, "lacking", "The machine is temporarily short of a resource";
    DamagedBlob: INTERNAL_SERVER_ERROR, "damaged-blob", "The stored table is damaged";
    DiskFull: INSUFFICIENT_STORAGE, "disk-full", "The disk is full";
    Storage: INTERNAL_SERVER_ERROR, "storage", "The storage failed";
    Unavailable: SERVICE_UNAVAILABLE, "unavailable", "The storage is temporarily unavailable";
    FitFailed: INTERNAL_SERVER_ERROR, "fit-failed", "The fit failed";
    Internal: INTERNAL_SERVER_ERROR, "internal", "The service failed";
}
