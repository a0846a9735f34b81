//! Tables: list, download by hash, manifest.

use axum::{
    Extension, Json,
    extract::State,
    http::{HeaderMap, Method, StatusCode, header},
    response::{IntoResponse, Response},
};
use serde::Deserialize;

use super::{
    absent::absent,
    access::Caller,
    api::Api,
    conditional::EntityTag,
    download::stored_file,
    extract::{NoParameters, PageLimit, PathOf, QueryOf},
    problem::Problem,
    views::PageView,
};
use crate::service::{DeleteTableError, FileKind, TableCursor, TableRow};
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
    match api.read(move |service| service.manifest(digest)).await? {
        Some(manifest) => Ok(([(header::CONTENT_TYPE, "application/json")], manifest).into_response()),
        None => Err(absent(&api, digest).await),
    }
}

/// `DELETE /v1/tables/{digest}`.
pub(super) async fn delete(
    State(api): State<Api>,
    _: QueryOf<NoParameters>,
    PathOf(digest): PathOf<Digest>,
    caller: Option<Extension<Caller>>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let tag = EntityTag::strong(digest);
    tag.check_if_match(&headers)?;
    let deleted = api.read(move |service| {
        let by = caller.as_ref().map(|Extension(Caller(by))| by.name.as_str());
        match service.delete_table(digest, by) {
            Err(DeleteTableError::Unknown(_)) => Ok(false),
            deleted => deleted.map(|()| true),
        }
    });
    if deleted.await? {
        return Ok((StatusCode::NO_CONTENT, [(header::ETAG, tag.as_str())]).into_response());
    }
    Err(absent(&api, digest).await)
}
