//! Tables: list, download by digest, manifest, delete.

use axum::{Json, extract::State, http::header, response::IntoResponse};
use serde::Deserialize;

use super::{
    api::Api,
    extract::{Asked, NoQuery, PageLimit, PathOf, QueryOf},
    file,
    kind::ProblemKind,
    problem::{Answer, Problem},
};
use crate::service::{FileKind, ListedTable, Page, TableCursor};
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
    QueryOf(ListParameters { cursor, limit }): QueryOf<ListParameters>,
) -> Result<Json<Page<ListedTable>>, Problem> {
    let page = api.call(move |service| service.tables(cursor.as_ref(), limit.0)).await?;
    Ok(Json(page))
}

/// `GET` and `HEAD /v1/tables/{digest}`.
pub(super) async fn download(State(api): State<Api>, asked: Asked, PathOf(digest): PathOf<Digest>) -> Answer {
    file::stored(&api, FileKind::Table, digest, &asked).await
}

/// `GET /v1/tables/{digest}/manifest`.
pub(super) async fn manifest(State(api): State<Api>, _: NoQuery, PathOf(digest): PathOf<Digest>) -> Answer {
    match api.read(move |service| service.manifest(digest)).await? {
        Some(manifest) => Ok(([(header::CONTENT_TYPE, "application/json")], manifest).into_response()),
        None => Err(file::absent(&api, digest).await),
    }
}

/// `DELETE /v1/tables/{digest}`.
pub(super) async fn delete(State(api): State<Api>, asked: Asked, PathOf(digest): PathOf<Digest>) -> Answer {
    let Asked { headers, by, .. } = asked;
    match file::delete(&api, digest, &headers, move |service| service.delete_table(digest, by.as_deref())).await {
        Err(problem) if problem.is(ProblemKind::UnknownTable) => Err(file::absent(&api, digest).await),
        deleted => deleted,
    }
}
