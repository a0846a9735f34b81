//! Files of tabulated BRDFs: store, list, download by digest, delete.

use axum::{
    Json,
    extract::State,
    http::{HeaderMap, Method, StatusCode, header},
    response::{IntoResponse, Response},
};

use super::{
    api::Api,
    conditional::{EntityTag, check_untagged},
    download::stored_file,
    extract::{BrdfBody, NoParameters, PathOf, QueryOf},
    problem::Problem,
    tables::ListParameters,
    views::PageView,
};
use crate::service::{FileKind, FileRow};
use ltcforge_files::digest::Digest;

/// `POST /v1/brdfs`.
pub(super) async fn store(
    State(api): State<Api>,
    _: QueryOf<NoParameters>,
    headers: HeaderMap,
    BrdfBody(bytes, room): BrdfBody,
) -> Result<Response, Problem> {
    check_untagged(&headers)?;
    let (stored, was_there) = api
        .call(move |service| {
            let stored = service.store_brdf(&bytes);
            drop((bytes, room));
            stored
        })
        .await?;
    let status = if was_there { StatusCode::OK } else { StatusCode::CREATED };
    let location = [(header::LOCATION, format!("/v1/brdfs/{}", stored.digest))];
    Ok((status, location, Json(stored)).into_response())
}

/// `GET` and `HEAD /v1/brdfs/{digest}`.
pub(super) async fn download(
    State(api): State<Api>,
    _: QueryOf<NoParameters>,
    PathOf(digest): PathOf<Digest>,
    method: Method,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    stored_file(api, FileKind::Brdf, digest, &method, &headers).await
}

/// `GET /v1/brdfs`.
pub(super) async fn list(
    State(api): State<Api>,
    QueryOf(parameters): QueryOf<ListParameters>,
) -> Result<Json<PageView<FileRow>>, Problem> {
    let ListParameters { cursor, limit } = parameters;
    let page = api.read(move |service| service.brdfs(cursor.as_ref(), limit.0)).await?;
    Ok(Json(PageView::new(page, Ok)?))
}

/// `DELETE /v1/brdfs/{digest}`.
pub(super) async fn delete(
    State(api): State<Api>,
    _: QueryOf<NoParameters>,
    PathOf(digest): PathOf<Digest>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let tag = EntityTag::strong(digest);
    tag.check_if_match(&headers)?;
    api.read(move |service| service.delete_brdf(digest)).await?;
    Ok((StatusCode::NO_CONTENT, [(header::ETAG, tag.as_str())]).into_response())
}
