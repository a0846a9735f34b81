//! Tables: list, download by hash, manifest.

use axum::{
    Json,
    extract::State,
    http::{HeaderMap, Method, StatusCode, header},
    response::{IntoResponse, Response},
};
use serde::Deserialize;

use super::{
    api::Api,
    download::stored_file,
    extract::{NoParameters, PageLimit, PathOf, QueryOf},
    kind::ProblemKind,
    problem::Problem,
    views::PageView,
};
use crate::service::{FileKind, TableCursor, TableRow};
use ltcforge_files::digest::Digest;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ListParameters {
    pub(super) cursor: Option<TableCursor>,
    #[serde(default)]
    pub(super) limit: PageLimit,
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
    // A conditional request is answered here, where the store would know another tag.
    let is_conditional = [header::IF_NONE_MATCH, header::IF_MATCH].iter().any(|name| headers.contains_key(name));
    if api.redirects
        && method == Method::GET
        && !is_conditional
        && let Some(url) = api.call(move |service| service.table_link(digest)).await?
    {
        return Ok((StatusCode::TEMPORARY_REDIRECT, [(header::LOCATION, url)]).into_response());
    }
    stored_file(api, FileKind::Table, digest, &method, &headers).await
}

/// `GET /v1/tables/{digest}/manifest`.
pub(super) async fn manifest(
    State(api): State<Api>,
    _: QueryOf<NoParameters>,
    PathOf(digest): PathOf<Digest>,
) -> Result<Response, Problem> {
    let manifest = api.read(move |service| service.manifest(digest)).await?.ok_or_else(|| unknown(digest))?;
    Ok(([(header::CONTENT_TYPE, "application/json")], manifest).into_response())
}

/// The problem of a table that is not there.
pub(super) fn unknown(digest: Digest) -> Problem {
    Problem::new(ProblemKind::UnknownTable, format!("no table with the digest {digest} is stored"))
}
