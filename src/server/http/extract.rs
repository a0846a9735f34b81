//! Path parameters, query strings and bodies. The problem for a malformed value shows the value and the allowed form.

use std::{fmt::Display, str::FromStr, sync::Arc};

use axum::{
    body::Bytes,
    extract::{DefaultBodyLimit, FromRequest, FromRequestParts, Path, Query, Request},
    http::{HeaderMap, Method, StatusCode, header, request::Parts},
};
use futures_util::StreamExt as _;
use headers::{ContentLength, HeaderMapExt as _};
use serde::{Deserialize, de::DeserializeOwned};
use tokio::{sync::OwnedSemaphorePermit, time::timeout};

use super::{
    access::Caller,
    api::{Api, UPLOADS},
    error::{bad_parameter, lacking},
    kind::ProblemKind,
    problem::Problem,
};

/// Maximum size of a recipe. Most recipes take less than one kilobyte.
pub(super) const RECIPE_LIMIT_BYTES: u64 = 64 << 10;
/// Default number of items on a page.
const DEFAULT_PAGE: usize = 50;
/// Maximum number of items on a page.
const LONGEST_PAGE: usize = 1000;

/// The only parameter in a path: a digest or a job id.
pub(super) struct PathOf<T>(pub(super) T);

impl<S: Send + Sync, T: FromStr<Err: Display>> FromRequestParts<S> for PathOf<T> {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        let path = Path::<String>::from_request_parts(parts, state).await;
        let Path(text) = path.map_err(|rejection| bad_parameter(&rejection.body_text()))?;
        text.parse().map(Self).map_err(|error: T::Err| bad_parameter(&error))
    }
}

/// A query string without unknown or malformed parameters. `Vec<(String, String)>` accepts any parameters.
pub(super) struct QueryOf<T>(pub(super) T);

impl<S: Send + Sync, T: DeserializeOwned> FromRequestParts<S> for QueryOf<T> {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, Problem> {
        Query::<T>::try_from_uri(&parts.uri).map(|Query(parameters)| Self(parameters)).map_err(|rejection| {
            let text = rejection.body_text();
            bad_parameter(&text.strip_prefix("Failed to deserialize query string: ").unwrap_or(&text))
        })
    }
}

/// The query string of a call that takes no parameters.
pub(super) type NoQuery = QueryOf<NoParameters>;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct NoParameters {}

/// The method and header fields of a call without parameters.
#[derive(Debug, Default)]
pub(super) struct Asked {
    pub(super) method: Method,
    pub(super) headers: HeaderMap,
    /// The name of the caller's token; `None` if the service needs no token.
    pub(super) by: Option<String>,
}

impl<S: Send + Sync> FromRequestParts<S> for Asked {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        NoQuery::from_request_parts(parts, state).await?;
        let by = parts.extensions.get::<Caller>().map(|Caller(token)| token.name.clone());
        Ok(Self { method: parts.method.clone(), headers: parts.headers.clone(), by })
    }
}

/// The parameter `limit`: the number of items on a page.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(try_from = "String")]
pub(super) struct PageLimit(pub(super) usize);

impl Default for PageLimit {
    fn default() -> Self {
        Self(DEFAULT_PAGE)
    }
}

impl TryFrom<String> for PageLimit {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        match text.parse() {
            Ok(limit) if (1..=LONGEST_PAGE).contains(&limit) => Ok(Self(limit)),
            _ => Err(format!("«{text}» is not a page length: it must be a number from 1 to {LONGEST_PAGE}")),
        }
    }
}

/// The bytes of a recipe document, before parsing.
pub(super) struct RecipeBody(pub(super) Bytes);

impl FromRequest<Api> for RecipeBody {
    type Rejection = Problem;

    async fn from_request(request: Request, api: &Api) -> Result<Self, Problem> {
        check_json(request.headers()).map_err(|given| other_type(&given, JSON))?;
        read_body(request, api, "a recipe", RECIPE_LIMIT_BYTES).await.map(Self)
    }
}

/// The content types to send, for error messages. [`check_json`] also accepts the form type of `curl -d`.
pub(super) const JSON: &str = "application/json, application/*+json or no content type";

/// Accepts JSON media types, no content type, and `application/x-www-form-urlencoded`, the default of `curl -d`. Pages
/// of other sites can send a form without a preflight request, so a form with an `Origin` field is rejected.
///
/// # Errors
/// The rejected content type.
pub(super) fn check_json(headers: &HeaderMap) -> Result<(), String> {
    let Some(value) = headers.get(header::CONTENT_TYPE) else { return Ok(()) };
    let media_type = value.to_str().unwrap_or_default().split(';').next().unwrap_or_default().trim();
    match media_type.to_ascii_lowercase().strip_prefix("application/") {
        Some(subtype) if subtype == "json" || subtype.ends_with("+json") => Ok(()),
        Some("x-www-form-urlencoded") if !headers.contains_key(header::ORIGIN) => Ok(()),
        _ => Err(format!("{value:?}")),
    }
}

/// Accepts only `media_type`. Pages of other sites cannot send it without a preflight request.
///
/// # Errors
/// The rejected content type.
pub(super) fn check_type(headers: &HeaderMap, media_type: &str) -> Result<(), String> {
    match headers.get(header::CONTENT_TYPE) {
        Some(value) if value.as_bytes().eq_ignore_ascii_case(media_type.as_bytes()) => Ok(()),
        Some(other) => Err(format!("{other:?}")),
        None => Err("none".to_owned()),
    }
}

/// The problem for a body with another content type.
pub(super) fn other_type(given: &str, allowed: &str) -> Problem {
    Problem::new(ProblemKind::NotJsonType, format!("the content type is {given}; send {allowed}"))
}

/// Reads a large body. Returns it with its permit, one of [`UPLOADS`]. Keep the permit until the body is processed.
pub(super) async fn read_upload(
    request: Request,
    api: &Api,
    what: &str,
    limit_bytes: u64,
) -> Result<(Bytes, OwnedSemaphorePermit), Problem> {
    let place = timeout(api.client, Arc::clone(&api.uploads).acquire_owned()).await;
    // The semaphore is never closed.
    let Ok(Ok(place)) = place else {
        return Err(lacking(format!("{UPLOADS} files are being received already; try again later")));
    };
    Ok((read_body(request, api, what, limit_bytes).await?, place))
}

/// Reads the body of a request. Errors call the body `what`. If `Content-Length` is too large, a client that waits for
/// `100 Continue` does not send the body. Other clients read the response only after they have sent the body, so the
/// body is read and dropped.
async fn read_body(mut request: Request, api: &Api, what: &str, limit_bytes: u64) -> Result<Bytes, Problem> {
    let too_large = || Problem::new(ProblemKind::BodyTooLarge, format!("{what} may have at most {limit_bytes} bytes"));
    if request.headers().typed_get::<ContentLength>().is_some_and(|length| length.0 > limit_bytes) {
        if !request.headers().contains_key(header::EXPECT) {
            let mut parts = request.into_body().into_data_stream();
            let rest = async { while let Some(Ok(_)) = parts.next().await {} };
            // A slow client gets the response before it has sent everything.
            let _ = timeout(api.client, rest).await;
        }
        return Err(too_large());
    }
    DefaultBodyLimit::max(usize::try_from(limit_bytes).unwrap_or(usize::MAX)).apply(&mut request);
    let Ok(body) = timeout(api.client, Bytes::from_request(request, api)).await else {
        let seconds = api.client.as_secs_f64();
        let detail =
            format!("the body of the request was not complete within {seconds} s; --client-seconds raises the limit");
        return Err(Problem::new(ProblemKind::SlowRequest, detail));
    };
    body.map_err(|rejection| match rejection.status() {
        StatusCode::PAYLOAD_TOO_LARGE => too_large(),
        _ => Problem::new(ProblemKind::BadBody, rejection.body_text()),
    })
}

#[cfg(test)]
mod tests {
    use axum::http::{HeaderValue, Uri};

    use super::*;
    use crate::queue::StateName;
    use ltcforge_files::digest::Digest;

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Parameters {
        state: Option<StateName>,
        #[serde(default)]
        limit: PageLimit,
    }

    async fn query(text: &str) -> Result<Parameters, Problem> {
        let uri: Uri = format!("/v1/jobs{text}").parse().expect("a URI");
        let (mut parts, ()) = Request::builder().uri(uri).body(()).expect("a request").into_parts();
        QueryOf::from_request_parts(&mut parts, &()).await.map(|QueryOf(parameters)| parameters)
    }

    #[tokio::test]
    async fn query_parameters_are_parsed_and_default() {
        let plain = query("").await.expect("no parameters are fine");
        assert_eq!((plain.state, plain.limit), (None, PageLimit(DEFAULT_PAGE)));
        let full = query("?state=done&limit=1000").await.expect("known parameters");
        assert_eq!((full.state, full.limit), (Some(StateName::Done), PageLimit(1000)));
    }

    #[tokio::test]
    async fn a_malformed_query_is_a_400_that_names_the_value() {
        let cases =
            [("?sate=done", "sate"), ("?state=finished", "finished"), ("?limit=0", "«0»"), ("?limit=1001", "1001")];
        for (text, named) in cases {
            let problem = query(text).await.expect_err(text);
            let view = serde_json::to_value(problem).expect("a problem serialises");
            assert_eq!(view["status"], 400, "{text}");
            let detail = view["detail"].as_str().expect("a text");
            assert!(detail.contains(named) && !detail.contains("deserialize"), "{view}");
        }
    }

    #[test]
    fn recipes_are_sent_as_json_or_without_a_type() {
        let check = |value: &'static str| {
            check_json(&HeaderMap::from_iter([(header::CONTENT_TYPE, HeaderValue::from_static(value))]))
        };
        assert!(check_json(&HeaderMap::new()).is_ok());
        for good in ["application/json", "Application/JSON; charset=utf-8", "application/vnd.ltc+json"] {
            assert!(check(good).is_ok(), "{good}");
        }
        assert!(check("application/x-www-form-urlencoded").is_ok(), "the default of curl -d");
        let from_page =
            [(header::CONTENT_TYPE, "application/x-www-form-urlencoded"), (header::ORIGIN, "http://a.example")];
        let from_page = from_page.map(|(name, value)| (name, HeaderValue::from_static(value)));
        assert!(check_json(&HeaderMap::from_iter(from_page)).is_err(), "a form of another site's page");
        for bad in ["text/plain", "application/jsonl", "json", ""] {
            assert!(check(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn a_malformed_digest_is_named_with_the_allowed_form() {
        // PathOf passes the parser's message on.
        let error = "xyz".parse::<Digest>().expect_err("no digest").to_string();
        assert!(error.contains("«xyz»") && error.contains("64 hex digits"), "{error}");
    }
}
