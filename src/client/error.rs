//! Why a request to a service failed.

use serde::Deserialize;

use crate::files::{digest::Digest, recipe::Fault};

/// A failed request. Every variant names the URL.
#[derive(Debug, thiserror::Error)]
pub enum ClientError {
    /// No service answers there, or it says that it cannot now.
    #[error("{url}: the server is unavailable: {reason}")]
    Unavailable {
        /// What was asked for.
        url: String,
        /// What the system or the server said.
        reason: String,
    },
    /// The service refused the request.
    #[error("{url}: {detail} ({status})")]
    Refused {
        /// What was asked for.
        url: String,
        /// HTTP status.
        status: u16,
        /// The problem's detail.
        detail: String,
        /// Faults of a recipe.
        faults: Vec<Fault>,
    },
    /// The answer is not one that ltcforge gives.
    #[error("{url}: unexpected answer: {reason}")]
    Unexpected {
        /// What was asked for.
        url: String,
        /// What is wrong with the answer.
        reason: String,
    },
    /// The bytes are not those that were asked for.
    #[error("{url}: the bytes hash to {actual}, {expected} was asked for")]
    Mismatch {
        /// What was asked for.
        url: String,
        /// The digest in the request.
        expected: Digest,
        /// The digest of the answer.
        actual: Digest,
    },
}

/// What the client reads of a problem document; a proxy's page in its place reads as empty.
#[derive(Debug, Default, Deserialize)]
pub(super) struct ProblemDocument {
    #[serde(default)]
    pub(super) detail: String,
    #[serde(default)]
    pub(super) errors: Vec<Fault>,
}

impl ClientError {
    /// A request that got no answer.
    pub(super) fn transport(url: &str, error: &ureq::Error) -> Self {
        let (url, reason) = (url.to_owned(), error.to_string());
        match error {
            ureq::Error::Io(_)
            | ureq::Error::Timeout(_)
            | ureq::Error::HostNotFound
            | ureq::Error::ConnectionFailed
            | ureq::Error::ConnectProxyFailed(_)
            | ureq::Error::BodyStalled => Self::Unavailable { url, reason },
            _ => Self::Unexpected { url, reason },
        }
    }

    /// An answer with a status that is no success.
    pub(super) fn status(url: &str, status: u16, body: &[u8]) -> Self {
        let problem: ProblemDocument = serde_json::from_slice(body).unwrap_or_default();
        let url = url.to_owned();
        let detail = if problem.detail.is_empty() { "the server refused".to_owned() } else { problem.detail };
        match status {
            502..=504 => Self::Unavailable { url, reason: format!("{detail} ({status})") },
            _ => Self::Refused { url, status, detail, faults: problem.errors },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn problems_are_read_and_foreign_pages_survived() {
        let body = br#"{"type":"/problems/bad-recipe","title":"t","status":422,"detail":"1 fault in the recipe",
            "errors":[{"pointer":"/x","detail":"unknown field"}]}"#;
        let error = ClientError::status("http://h/v1/jobs", 422, body);
        assert_eq!(error.to_string(), "http://h/v1/jobs: 1 fault in the recipe (422)");
        assert!(matches!(error, ClientError::Refused { faults, .. } if faults.len() == 1));
        assert!(matches!(ClientError::status("u", 404, b"<html>"), ClientError::Refused { status: 404, .. }));
    }

    #[test]
    fn a_gateway_without_a_server_behind_it_is_unavailable() {
        for status in [502, 503, 504] {
            assert!(matches!(ClientError::status("u", status, b""), ClientError::Unavailable { .. }), "{status}");
        }
        assert!(matches!(ClientError::status("u", 500, b""), ClientError::Refused { .. }));
    }
}
