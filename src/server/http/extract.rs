//! Path parameters, query strings and bodies. A malformed value is a problem that names the value and
//! the allowed form.

use std::{fmt::Display, str::FromStr, sync::Arc, time::Duration};

use axum::{
    body::Bytes,
    extract::{FromRequest, FromRequestParts, Path, Query, Request},
    http::{HeaderMap, HeaderValue, StatusCode, header, request::Parts},
};
use headers::{ContentLength, HeaderMapExt as _};
use serde::{Deserialize, de::DeserializeOwned};
use tokio::{sync::OwnedSemaphorePermit, time::timeout};

use super::{api::Api, error::lacking, kind::ProblemKind, problem::Problem};
use crate::service::{SCENE_LIMIT_BYTES, SceneForm};
use ltcforge_files::tabulated::TABULATED_LIMIT_BYTES;

/// Longest request body. A recipe takes less than one kilobyte.
pub const BODY_LIMIT_BYTES: usize = 64 * 1024;
/// Longest list of materials.
const LIST_LIMIT_BYTES: u64 = 1 << 20;
/// Items on a page if the client gives no number.
const DEFAULT_PAGE: usize = 50;
/// Most items on a page.
const LONGEST_PAGE: usize = 1000;

/// The one parameter in a path: a digest or a job id.
pub(super) struct PathOf<T>(pub(super) T);

impl<S, T> FromRequestParts<S> for PathOf<T>
where
    S: Send + Sync,
    T: FromStr<Err: Display>,
{
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        let Path(text) = Path::<String>::from_request_parts(parts, state)
            .await
            .map_err(|rejection| Problem::new(ProblemKind::BadParameter, rejection.body_text()))?;
        text.parse().map(Self).map_err(|error: T::Err| Problem::new(ProblemKind::BadParameter, error.to_string()))
    }
}

/// A query string without unknown or malformed parameters.
pub(super) struct QueryOf<T>(pub(super) T);

impl<S, T> FromRequestParts<S> for QueryOf<T>
where
    S: Send + Sync,
    T: DeserializeOwned,
{
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, _state: &S) -> Result<Self, Problem> {
        match Query::<T>::try_from_uri(&parts.uri) {
            Ok(Query(parameters)) => Ok(Self(parameters)),
            Err(rejection) => {
                let text = rejection.body_text();
                let detail = text.strip_prefix("Failed to deserialize query string: ").unwrap_or(&text);
                Err(Problem::new(ProblemKind::BadParameter, detail))
            }
        }
    }
}

/// The pairs of a query string, in order. The handler reads them and lists their faults.
pub(super) struct QueryPairs(Vec<(String, String)>);

impl QueryPairs {
    /// Each name with its text.
    pub(super) fn iter(&self) -> impl Iterator<Item = (&str, &str)> {
        self.0.iter().map(|(name, text)| (name.as_str(), text.as_str()))
    }
}

impl<S: Send + Sync> FromRequestParts<S> for QueryPairs {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        QueryOf::from_request_parts(parts, state).await.map(|QueryOf(pairs)| Self(pairs))
    }
}

/// The query string of a call that takes no parameters.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct NoParameters {}

/// `limit`: items on a page.
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
            _ => Err(format!("«{text}» is not a page length: a page length is a number from 1 to {LONGEST_PAGE}")),
        }
    }
}

/// The bytes of a recipe document, not parsed yet.
pub(super) struct RecipeBody(pub(super) Bytes);

impl FromRequest<Api> for RecipeBody {
    type Rejection = Problem;

    async fn from_request(request: Request, api: &Api) -> Result<Self, Problem> {
        check_json_type(request.headers(), "")?;
        read_body(request, api, "a recipe", BODY_LIMIT_BYTES as u64).await.map(Self)
    }
}

/// Files of BRDFs that are received and decoded at once. Each takes up to some 300 MB.
pub(super) const UPLOADS: usize = 2;

/// The bytes of a tabulated BRDF's file, not decoded yet, and the right to have them in memory. Its route raises the limit of bodies.
pub(super) struct BrdfBody(pub(super) Bytes, pub(super) OwnedSemaphorePermit);

impl FromRequest<Api> for BrdfBody {
    type Rejection = Problem;

    async fn from_request(request: Request, api: &Api) -> Result<Self, Problem> {
        check_brdf_type(request.headers())?;
        let room = timeout(api.limits.client, Arc::clone(&api.uploads).acquire_owned()).await;
        // The semaphore is never closed.
        let Ok(Ok(room)) = room else {
            return Err(lacking(format!("{UPLOADS} files of BRDFs are being received already; try again later")));
        };
        let bytes = read_body(request, api, "the file of a BRDF", TABULATED_LIMIT_BYTES).await?;
        Ok(Self(bytes, room))
    }
}

/// Longest picture that is sent.
pub(super) const PICTURE_LIMIT_BYTES: u64 = 64 << 20;

/// The bytes of a picture, not decoded yet, and the right to have them in memory: as many are at once as files of BRDFs.
/// Its route raises the limit of bodies.
pub(super) struct PictureBody(pub(super) Bytes, pub(super) OwnedSemaphorePermit);

impl FromRequest<Api> for PictureBody {
    type Rejection = Problem;

    async fn from_request(request: Request, api: &Api) -> Result<Self, Problem> {
        check_picture_type(request.headers())?;
        let room = timeout(api.limits.client, Arc::clone(&api.uploads).acquire_owned()).await;
        // The semaphore is never closed.
        let Ok(Ok(room)) = room else {
            return Err(lacking(format!("{UPLOADS} files are being received already; try again later")));
        };
        let bytes = read_body(request, api, "a picture", PICTURE_LIMIT_BYTES).await?;
        Ok(Self(bytes, room))
    }
}

/// A scene and its form, not read yet, and the right to have it in memory and to plan for it: as many are at once as
/// files of BRDFs. Its route raises the limit of bodies.
pub(super) struct SceneBody(pub(super) Bytes, pub(super) SceneForm, pub(super) OwnedSemaphorePermit);

impl FromRequest<Api> for SceneBody {
    type Rejection = Problem;

    async fn from_request(request: Request, api: &Api) -> Result<Self, Problem> {
        let form = scene_form(request.headers())?;
        let room = timeout(api.limits.client, Arc::clone(&api.uploads).acquire_owned()).await;
        // The semaphore is never closed.
        let Ok(Ok(room)) = room else {
            return Err(lacking(format!("{UPLOADS} files are being received already; try again later")));
        };
        let limit_bytes = match form {
            SceneForm::Glb => SCENE_LIMIT_BYTES,
            SceneForm::List => LIST_LIMIT_BYTES,
        };
        let bytes = read_body(request, api, "a scene", limit_bytes).await?;
        Ok(Self(bytes, form, room))
    }
}

/// Reads the body of a request that sends `what`. A body that is announced as too large is refused before any of it is
/// read: a client that waits for `100 Continue` then sends none of it.
pub(super) async fn read_body(request: Request, api: &Api, what: &str, limit_bytes: u64) -> Result<Bytes, Problem> {
    let too_large = || Problem::new(ProblemKind::BodyTooLarge, format!("{what} takes at most {limit_bytes} bytes"));
    if request.headers().typed_get::<ContentLength>().is_some_and(|length| length.0 > limit_bytes) {
        return Err(too_large());
    }
    let body = timeout(api.limits.client, Bytes::from_request(request, api)).await;
    let body = body.map_err(|_| Problem::new(ProblemKind::SlowRequest, slow("body", api.limits.client)))?;
    body.map_err(|rejection| match rejection.status() {
        StatusCode::PAYLOAD_TOO_LARGE => too_large(),
        _ => Problem::new(ProblemKind::BadBody, rejection.body_text()),
    })
}

/// The message about a `part` of a request that was not complete within `limit`.
pub(super) fn slow(part: &str, limit: Duration) -> String {
    let seconds = limit.as_secs_f64();
    format!("the {part} of the request was not complete within {seconds} s; --client-seconds raises the limit")
}

/// The form of a scene: `model/gltf-binary`, or what is accepted as the JSON of recipes is.
fn scene_form(headers: &HeaderMap) -> Result<SceneForm, Problem> {
    let glb = |value: &HeaderValue| value.as_bytes().eq_ignore_ascii_case(b"model/gltf-binary");
    if headers.get(header::CONTENT_TYPE).is_some_and(glb) {
        return Ok(SceneForm::Glb);
    }
    check_json_type(headers, "model/gltf-binary, ").map(|()| SceneForm::List)
}

/// Accepts `application/octet-stream` alone: a page of another site can send forms without a preflight request.
fn check_brdf_type(headers: &HeaderMap) -> Result<(), Problem> {
    match headers.get(header::CONTENT_TYPE) {
        Some(value) if value.as_bytes().eq_ignore_ascii_case(b"application/octet-stream") => Ok(()),
        other => {
            let given = other.map_or("no content type".to_owned(), |value| format!("{value:?}"));
            let detail = format!("{given} is not that of a BRDF's file; send application/octet-stream");
            Err(Problem::new(ProblemKind::NotJsonType, detail))
        }
    }
}

/// Accepts `application/octet-stream` and types of images alone: a page of another site can send neither without a
/// preflight request.
fn check_picture_type(headers: &HeaderMap) -> Result<(), Problem> {
    let given = headers.get(header::CONTENT_TYPE);
    let media_type = given.and_then(|value| value.to_str().ok()).unwrap_or_default().to_ascii_lowercase();
    if media_type == "application/octet-stream" || media_type.starts_with("image/") {
        return Ok(());
    }
    let given = given.map_or("no content type".to_owned(), |value| format!("{value:?}"));
    let detail = format!("{given} is not that of a picture; send image/png and so on, or application/octet-stream");
    Err(Problem::new(ProblemKind::NotJsonType, detail))
}

/// Accepts `application/json`, `application/*+json`, no content type, and the default of `curl -d`,
/// `application/x-www-form-urlencoded`. A page of another site can send that default without a preflight request, so a
/// request with an `Origin` must say JSON. `or` are types that the call takes beside it.
fn check_json_type(headers: &HeaderMap, or: &str) -> Result<(), Problem> {
    let Some(value) = headers.get(header::CONTENT_TYPE) else {
        return Ok(());
    };
    let media_type = value.to_str().unwrap_or_default().split(';').next().unwrap_or_default().trim();
    let subtype = media_type.to_ascii_lowercase();
    match subtype.strip_prefix("application/") {
        Some(subtype) if subtype == "json" || subtype.ends_with("+json") => Ok(()),
        Some("x-www-form-urlencoded") if !headers.contains_key(header::ORIGIN) => Ok(()),
        _ => {
            let detail =
                format!("{value:?} is not JSON; send {or}application/json, application/*+json or no content type");
            Err(Problem::new(ProblemKind::NotJsonType, detail))
        }
    }
}

#[cfg(test)]
mod tests {
    use axum::{http::Uri, response::IntoResponse as _};

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
            check_json_type(&HeaderMap::from_iter([(header::CONTENT_TYPE, HeaderValue::from_static(value))]), "")
        };
        assert!(check_json_type(&HeaderMap::new(), "").is_ok());
        for good in ["application/json", "Application/JSON; charset=utf-8", "application/vnd.ltc+json"] {
            assert!(check(good).is_ok(), "{good}");
        }
        assert!(check("application/x-www-form-urlencoded").is_ok(), "the default of curl -d");
        let from_page =
            [(header::CONTENT_TYPE, "application/x-www-form-urlencoded"), (header::ORIGIN, "http://a.example")];
        let from_page = from_page.map(|(name, value)| (name, HeaderValue::from_static(value)));
        assert!(check_json_type(&HeaderMap::from_iter(from_page), "").is_err(), "a form of another site's page");
        for bad in ["text/plain", "application/jsonl", "json", ""] {
            let status = check(bad).expect_err(bad).into_response().status();
            assert_eq!(status, 415, "{bad}");
        }
    }

    #[test]
    fn a_malformed_digest_is_named_with_the_allowed_form() {
        // PathOf passes the parser's message on.
        let error = "xyz".parse::<Digest>().expect_err("no digest").to_string();
        assert!(error.contains("«xyz»") && error.contains("64 hex digits"), "{error}");
    }
}
