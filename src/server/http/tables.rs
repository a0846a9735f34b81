//! Tables: list, download by hash, manifest; recipes and their tables.

use std::sync::Arc;

use axum::{
    Json,
    body::{Body, Bytes},
    extract::State,
    http::{HeaderMap, HeaderValue, Method, Response as HttpResponse, StatusCode, header, response::Builder},
    response::{IntoResponse, Response},
};
use base64::{Engine as _, engine::general_purpose::STANDARD};
use serde::Deserialize;

use super::{
    api::Api,
    conditional::EntityTag,
    error,
    extract::{NoParameters, PageLimit, PathOf, QueryOf},
    kind::ProblemKind,
    problem::Problem,
    range::{self, Requested},
    views::{PageView, RecipeView},
};
use crate::{
    files::digest::Digest,
    server::service::{TableCursor, TableRow},
};

/// A table's bytes never change under its digest.
const FOREVER: &str = "public, max-age=31536000, immutable";

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ListParameters {
    cursor: Option<TableCursor>,
    #[serde(default)]
    limit: PageLimit,
}

/// `GET /v1/tables`.
pub(super) async fn list(
    State(api): State<Api>,
    QueryOf(parameters): QueryOf<ListParameters>,
) -> Result<Json<PageView<TableRow>>, Problem> {
    let ListParameters { cursor, limit } = parameters;
    let page = api.call(move |service| service.tables(cursor.as_ref(), limit.0)).await?;
    Ok(Json(PageView::new(page, Ok)?))
}

/// `GET` and `HEAD /v1/tables/{digest}`.
pub(super) async fn download(
    State(api): State<Api>,
    _: QueryOf<NoParameters>,
    PathOf(digest): PathOf<Digest>,
    method: Method,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    if api.redirects
        && method == Method::GET
        && let Some(url) = api.call(move |service| service.table_link(digest)).await?
    {
        return finish(
            HttpResponse::builder().status(StatusCode::TEMPORARY_REDIRECT).header(header::LOCATION, url),
            Body::empty(),
        );
    }
    let file = api.call(move |service| service.table(digest)).await?.ok_or_else(|| unknown(digest))?;
    respond(&digest, &method, &headers, Bytes::from_owner(File(file)))
}

/// `GET /v1/tables/{digest}/manifest`.
pub(super) async fn manifest(
    State(api): State<Api>,
    _: QueryOf<NoParameters>,
    PathOf(digest): PathOf<Digest>,
) -> Result<Response, Problem> {
    let manifest = api.call(move |service| service.manifest(digest)).await?.ok_or_else(|| unknown(digest))?;
    Ok(([(header::CONTENT_TYPE, "application/json")], manifest).into_response())
}

/// `GET /v1/recipes/{digest}`.
pub(super) async fn recipe(
    State(api): State<Api>,
    _: QueryOf<NoParameters>,
    PathOf(digest): PathOf<Digest>,
) -> Result<Json<RecipeView>, Problem> {
    let known = api.call(move |service| service.recipe(digest)).await?;
    let (recipe, table) = known.ok_or_else(|| {
        Problem::new(ProblemKind::UnknownRecipe, format!("no recipe with the digest {digest} is known"))
    })?;
    Ok(Json(RecipeView::new(digest, &recipe, table)?))
}

fn unknown(digest: Digest) -> Problem {
    Problem::new(ProblemKind::UnknownTable, format!("no table with the digest {digest} is stored"))
}

/// Shares the service's copy of a file with the response instead of making another.
struct File(Arc<Vec<u8>>);

impl AsRef<[u8]> for File {
    fn as_ref(&self) -> &[u8] {
        &self.0
    }
}

/// The file, a part of it, or 304 if the client has it; conditions are evaluated in the order of RFC 9110, section
/// 13.2.2.
fn respond(digest: &Digest, method: &Method, headers: &HeaderMap, file: Bytes) -> Result<Response, Problem> {
    let tag = EntityTag::strong(digest);
    tag.check_if_match(headers)?;
    if tag.is_known_to(headers) {
        return finish(validators(StatusCode::NOT_MODIFIED, &tag), Body::empty());
    }
    let length = file.len();
    match requested(&tag, method, headers, length) {
        Requested::Whole => finish(representation(StatusCode::OK, &tag, digest), Body::from(file)),
        Requested::Part(part) => {
            let content_range = format!("bytes {}-{}/{length}", part.start, part.end - 1);
            let head = representation(StatusCode::PARTIAL_CONTENT, &tag, digest);
            finish(head.header(header::CONTENT_RANGE, content_range), Body::from(file.slice(part)))
        }
        Requested::Unsatisfiable => {
            let detail = format!("the file has {length} bytes; none of them is in the range");
            let mut response = Problem::new(ProblemKind::RangeNotSatisfiable, detail).into_response();
            if let Ok(content_range) = HeaderValue::from_str(&format!("bytes */{length}")) {
                response.headers_mut().insert(header::CONTENT_RANGE, content_range);
            }
            Ok(response)
        }
    }
}

/// `Range` applies to GET only, and only if `If-Range` allows it.
fn requested(tag: &EntityTag, method: &Method, headers: &HeaderMap, length: usize) -> Requested {
    match headers.get(header::RANGE).and_then(|field| field.to_str().ok()) {
        Some(field) if method == Method::GET && tag.allows_range(headers) => range::parse(field, length),
        _ => Requested::Whole,
    }
}

fn validators(status: StatusCode, tag: &EntityTag) -> Builder {
    HttpResponse::builder().status(status).header(header::ETAG, tag.as_str()).header(header::CACHE_CONTROL, FOREVER)
}

fn representation(status: StatusCode, tag: &EntityTag, digest: &Digest) -> Builder {
    validators(status, tag)
        .header(header::CONTENT_TYPE, "application/octet-stream")
        .header(header::CONTENT_DISPOSITION, format!("attachment; filename=\"{}.safetensors\"", digest.hex()))
        .header(header::ACCEPT_RANGES, "bytes")
        .header("repr-digest", format!("sha-256=:{}:", STANDARD.encode(digest.as_bytes())))
}

fn finish(head: Builder, body: Body) -> Result<Response, Problem> {
    head.body(body).map_err(|error| error::internal(&error))
}

#[cfg(test)]
mod tests {
    use axum::http::HeaderName;

    use super::*;

    const FILE: &[u8] = b"0123456789";

    fn get(fields: &[(HeaderName, &str)]) -> Response {
        request(&Method::GET, fields)
    }

    fn request(method: &Method, fields: &[(HeaderName, &str)]) -> Response {
        let fields =
            fields.iter().map(|(name, value)| (name.clone(), HeaderValue::from_str(value).expect("a field value")));
        respond(&Digest::of(FILE), method, &fields.collect(), Bytes::from_static(FILE)).expect("a response")
    }

    async fn body(response: Response) -> Bytes {
        axum::body::to_bytes(response.into_body(), usize::MAX).await.expect("a body in memory")
    }

    #[tokio::test]
    async fn the_whole_file_carries_its_hash_three_times() {
        let response = get(&[]);
        assert_eq!(response.status(), 200);
        let digest = Digest::of(FILE);
        let headers = response.headers();
        assert_eq!(headers[header::ETAG], format!("\"{digest}\""));
        // `printf 0123456789 | openssl dgst -sha256 -binary | base64`
        assert_eq!(headers["repr-digest"], "sha-256=:hNiYd/DUBB77a/kaFvAkjy/Vc+avBcGflr7bn4gveII=:");
        assert_eq!(
            headers[header::CONTENT_DISPOSITION],
            format!("attachment; filename=\"{}.safetensors\"", digest.hex())
        );
        assert_eq!(headers[header::CACHE_CONTROL], FOREVER);
        assert_eq!(body(response).await, FILE);
    }

    #[tokio::test]
    async fn a_client_that_has_the_file_gets_304() {
        let tag = format!("\"{}\"", Digest::of(FILE));
        // If-None-Match takes precedence over Range.
        let response = get(&[(header::IF_NONE_MATCH, &tag), (header::RANGE, "bytes=0-1")]);
        assert_eq!(response.status(), 304);
        assert_eq!(response.headers()[header::ETAG], tag);
        assert_eq!(body(response).await, "");
    }

    #[test]
    fn another_version_than_the_wanted_one_is_412() {
        let tag = format!("\"{}\"", Digest::of(FILE));
        assert_eq!(get(&[(header::IF_MATCH, &tag)]).status(), 200);
        let headers = HeaderMap::from_iter([
            (header::IF_MATCH, HeaderValue::from_static("\"other\"")),
            // If-Match takes precedence over If-None-Match.
            (header::IF_NONE_MATCH, HeaderValue::from_str(&tag).expect("a field value")),
        ]);
        let refused = respond(&Digest::of(FILE), &Method::GET, &headers, Bytes::from_static(FILE));
        assert_eq!(refused.expect_err("another version").status(), 412);
    }

    #[tokio::test]
    async fn a_part_names_its_range() {
        let response = get(&[(header::RANGE, "bytes=2-4")]);
        assert_eq!(response.status(), 206);
        assert_eq!(response.headers()[header::CONTENT_RANGE], "bytes 2-4/10");
        assert_eq!(body(response).await, "234");

        let response = get(&[(header::RANGE, "bytes=10-")]);
        assert_eq!(response.status(), 416);
        assert_eq!(response.headers()[header::CONTENT_RANGE], "bytes */10");
    }

    #[test]
    fn a_range_counts_only_on_get_and_under_its_own_tag() {
        let range = (header::RANGE, "bytes=2-4");
        let tag = format!("\"{}\"", Digest::of(FILE));
        assert_eq!(get(&[range.clone(), (header::IF_RANGE, &tag)]).status(), 206);
        assert_eq!(get(&[range.clone(), (header::IF_RANGE, "\"other\"")]).status(), 200);
        assert_eq!(request(&Method::HEAD, &[range]).status(), 200);
    }
}
