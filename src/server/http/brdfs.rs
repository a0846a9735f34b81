//! Files of tabulated BRDFs: store, list, download by digest, delete.

use axum::{
    Json,
    extract::{Request, State},
    http::{StatusCode, header},
    response::IntoResponse,
};

use super::{
    api::Api,
    etag::check_untagged,
    extract::{Asked, NoQuery, PathOf, QueryOf, check_type, other_type, read_upload},
    file,
    problem::{Answer, Problem},
    tables::ListParameters,
};
use crate::service::{FileKind, FileRow, Page};
use ltcforge_files::{digest::Digest, tabulated::TABULATED_LIMIT_BYTES};

const MEDIA_TYPE: &str = "application/octet-stream";

/// `POST /v1/brdfs`.
pub(super) async fn store(State(api): State<Api>, _: NoQuery, request: Request) -> Answer {
    check_type(request.headers(), MEDIA_TYPE).map_err(|given| other_type(&given, MEDIA_TYPE))?;
    let untagged = check_untagged(request.headers());
    let (bytes, place) = read_upload(request, &api, "a BRDF file", TABULATED_LIMIT_BYTES).await?;
    untagged?;
    let store = move |service: &crate::service::Service| {
        let stored = service.store_brdf(&bytes);
        drop((bytes, place));
        stored
    };
    let (stored, was_there) = api.call(store).await?;
    let status = if was_there { StatusCode::OK } else { StatusCode::CREATED };
    let location = [(header::LOCATION, format!("/v1/brdfs/{}", stored.digest))];
    Ok((status, location, Json(stored)).into_response())
}

/// `GET` and `HEAD /v1/brdfs/{digest}`.
pub(super) async fn download(State(api): State<Api>, asked: Asked, PathOf(digest): PathOf<Digest>) -> Answer {
    file::stored(&api, FileKind::Brdf, digest, &asked).await
}

/// `GET /v1/brdfs`.
pub(super) async fn list(
    State(api): State<Api>,
    QueryOf(ListParameters { cursor, limit }): QueryOf<ListParameters>,
) -> Result<Json<Page<FileRow>>, Problem> {
    let page = api.read(move |service| service.brdfs(cursor.as_ref(), limit.0)).await?;
    Ok(Json(page))
}

/// `DELETE /v1/brdfs/{digest}`.
pub(super) async fn delete(State(api): State<Api>, asked: Asked, PathOf(digest): PathOf<Digest>) -> Answer {
    file::delete(&api, digest, &asked.headers, move |service| service.delete_brdf(digest)).await
}
