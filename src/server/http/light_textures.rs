//! Prefiltered pictures of lights: make and store, list, download by digest, delete.

use axum::{
    Json,
    extract::State,
    http::{HeaderMap, Method, StatusCode, header},
    response::{IntoResponse, Response},
};
use serde::Deserialize;

use super::{
    api::Api,
    conditional::{EntityTag, check_untagged},
    download::stored_file,
    extract::{NoParameters, PathOf, PictureBody, QueryOf},
    problem::Problem,
    tables::ListParameters,
    views::PageView,
};
use crate::service::{FileKind, FileRow, LightTextureRequest};
use ltcforge_files::digest::Digest;
use ltcforge_textures::{LightSize, LightTexels, TransferFunction};

/// What to make of the picture.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StoreParameters {
    light: Option<LightSize>,
    transfer: Option<TransferFunction>,
    #[serde(rename = "as", default)]
    form: Ktx2Form,
    texels: Option<LightTexels>,
}

/// The forms of KTX2, by the names of the containers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
enum Ktx2Form {
    #[default]
    #[serde(rename = "ktx2")]
    Plain,
    #[serde(rename = "ktx2-zstd")]
    Zstd,
}

/// `POST /v1/light-textures`.
pub(super) async fn store(
    State(api): State<Api>,
    QueryOf(parameters): QueryOf<StoreParameters>,
    headers: HeaderMap,
    PictureBody(bytes, room): PictureBody,
) -> Result<Response, Problem> {
    check_untagged(&headers)?;
    let StoreParameters { light, transfer, form, texels } = parameters;
    let texels = texels.unwrap_or(LightTexels::ALL[0]);
    let request = LightTextureRequest { light, transfer, texels, zstd: form == Ktx2Form::Zstd };
    let (stored, was_there) = api
        .call(move |service| {
            let stored = service.store_light_texture(&bytes, request);
            drop((bytes, room));
            stored
        })
        .await?;
    let status = if was_there { StatusCode::OK } else { StatusCode::CREATED };
    let location = [(header::LOCATION, format!("/v1/light-textures/{}", stored.digest))];
    Ok((status, location, Json(stored)).into_response())
}

/// `GET` and `HEAD /v1/light-textures/{digest}`.
pub(super) async fn download(
    State(api): State<Api>,
    _: QueryOf<NoParameters>,
    PathOf(digest): PathOf<Digest>,
    method: Method,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    stored_file(api, FileKind::LightTexture, digest, &method, &headers).await
}

/// `GET /v1/light-textures`.
pub(super) async fn list(
    State(api): State<Api>,
    QueryOf(parameters): QueryOf<ListParameters>,
) -> Result<Json<PageView<FileRow>>, Problem> {
    let ListParameters { cursor, limit } = parameters;
    let page = api.read(move |service| service.light_textures(cursor.as_ref(), limit.0)).await?;
    Ok(Json(PageView::new(page, Ok)?))
}

/// `DELETE /v1/light-textures/{digest}`.
pub(super) async fn delete(
    State(api): State<Api>,
    _: QueryOf<NoParameters>,
    PathOf(digest): PathOf<Digest>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let tag = EntityTag::strong(digest);
    tag.check_if_match(&headers)?;
    api.read(move |service| service.delete_light_texture(digest)).await?;
    Ok((StatusCode::NO_CONTENT, [(header::ETAG, tag.as_str())]).into_response())
}
