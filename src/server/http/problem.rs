//! Problem documents [RFC 9457].

use std::time::Duration;

use axum::{
    Json,
    http::{HeaderValue, StatusCode, header},
    response::{IntoResponse, Response},
};
use serde::Serialize;
use serde_json::{Map, Value};

use super::kind::ProblemKind;

/// Maximum number of faults that a problem lists. Once they are fixed, the next response lists the rest.
const MOST_FAULTS: usize = 100;

/// Maximum number of characters in a `detail`, and in each text of a fault.
const LONGEST_DETAIL: usize = 2000;

/// How a client authenticates.
const SCHEME: &str = "Bearer realm=\"ltcforge\"";

/// Maximum number of characters in a word of these texts. Only words from a client can be longer.
const LONGEST_WORD: usize = 200;

/// The result of a handler.
pub(super) type Answer = Result<Response, Problem>;

/// An error that is reported to a client. Serialises to the problem document.
#[derive(Debug, Serialize)]
pub(super) struct Problem {
    r#type: &'static str,
    title: &'static str,
    status: u16,
    detail: String,
    /// The faults of the request, each with its place.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    errors: Vec<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    recipe: Option<Box<Value>>,
    #[serde(skip)]
    kind: ProblemKind,
    /// Whole seconds for `Retry-After`.
    #[serde(skip)]
    retry_after: Option<u64>,
}

impl Problem {
    /// A problem of `kind`. `detail` is one sentence about this occurrence.
    pub(super) fn new(kind: ProblemKind, detail: impl Into<String>) -> Self {
        let (status, r#type, title) = kind.row();
        let (status, detail) = (status.as_u16(), bounded(&detail.into()));
        Self { r#type, title, status, detail, errors: Vec::new(), recipe: None, kind, retry_after: None }
    }

    /// Adds the faults of the request, but at most [`MOST_FAULTS`].
    pub(super) fn with_errors<I>(self, errors: I) -> Self
    where
        I: IntoIterator<Item: Serialize, IntoIter: ExactSizeIterator>,
    {
        let errors = errors.into_iter();
        let detail = match errors.len().checked_sub(MOST_FAULTS) {
            Some(more @ 1..) => format!("{}; the first {MOST_FAULTS} are listed, {more} are omitted", self.detail),
            _ => self.detail,
        };
        let listed = errors.take(MOST_FAULTS).filter_map(|fault| {
            let mut fault = serde_json::to_value(fault).ok()?;
            for text in fault.as_object_mut().into_iter().flat_map(Map::values_mut) {
                if let Value::String(text) = text {
                    *text = bounded(text);
                }
            }
            Some(fault)
        });
        Self { detail, errors: listed.collect(), ..self }
    }

    /// Adds a recipe that the client could use instead, as a document to submit.
    pub(super) fn with_recipe(self, recipe: Value) -> Self {
        Self { recipe: Some(Box::new(recipe)), ..self }
    }

    /// Adds a `Retry-After` field.
    pub(super) fn with_retry_after(self, after: Duration) -> Self {
        Self { retry_after: Some(whole_seconds(after)), ..self }
    }

    /// Whether the problem is of `kind`.
    pub(super) fn is(&self, kind: ProblemKind) -> bool {
        self.kind == kind
    }

    /// The status of the response.
    pub(super) fn status(&self) -> StatusCode {
        self.kind.row().0
    }
}

/// Shortens a text and its long words, because they may come from a client.
fn bounded(text: &str) -> String {
    let shown: String = text.split_inclusive(char::is_whitespace).map(|word| cut(word, LONGEST_WORD)).collect();
    cut(&shown, LONGEST_DETAIL)
}

fn cut(text: &str, most: usize) -> String {
    match text.char_indices().nth(most) {
        Some((end, _)) => format!("{}... ({} bytes) ", &text[..end], text.len()),
        None => text.to_owned(),
    }
}

/// Whole seconds for `Retry-After`, at least one.
pub(super) fn whole_seconds(after: Duration) -> u64 {
    after.as_secs_f64().ceil().max(1.0) as u64
}

impl IntoResponse for Problem {
    fn into_response(self) -> Response {
        let retry_after = self.retry_after.map(|seconds| [(header::RETRY_AFTER, HeaderValue::from(seconds))]);
        let scheme = (self.kind == ProblemKind::NoToken).then_some([(header::WWW_AUTHENTICATE, SCHEME)]);
        let content_type = [(header::CONTENT_TYPE, "application/problem+json")];
        (self.status(), retry_after, scheme, content_type, Json(self)).into_response()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ltcforge_files::recipe_document::Fault;

    #[test]
    fn a_problem_carries_its_faults_and_when_to_retry() {
        let fault = Fault { pointer: "/fit/samples".into(), detail: "0 is below 1".into() };
        let problem = Problem::new(ProblemKind::BadRecipe, "1 fault").with_errors([fault]);
        let view = serde_json::to_value(problem).expect("a problem serialises");
        let expected = serde_json::json!({
            "type": "/problems/bad-recipe", "title": "The recipe has faults", "status": 422, "detail": "1 fault",
            "errors": [{ "pointer": "/fit/samples", "detail": "0 is below 1" }],
        });
        assert_eq!(view, expected);

        let response =
            Problem::new(ProblemKind::QueueFull, "").with_retry_after(Duration::from_millis(1200)).into_response();
        assert_eq!(response.headers()[header::RETRY_AFTER], "2");
        assert_eq!(response.headers()[header::CONTENT_TYPE], "application/problem+json");
    }

    #[test]
    fn a_long_list_of_faults_is_cut_and_says_so() {
        let listed = |count: usize| {
            let faults = vec![Fault { pointer: "/x".into(), detail: "unknown field".into() }; count];
            let problem = Problem::new(ProblemKind::BadRecipe, format!("{count} faults")).with_errors(faults);
            (problem.errors.len(), problem.detail)
        };
        assert_eq!(listed(100), (100, "100 faults".to_owned()));
        assert_eq!(listed(137), (100, "137 faults; the first 100 are listed, 37 are omitted".to_owned()));
    }

    #[test]
    fn retry_after_is_never_zero() {
        assert_eq!(whole_seconds(Duration::ZERO), 1);
    }
}
