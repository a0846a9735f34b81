//! Files of tabulated BRDFs: store, and download by digest.

use axum::{
    Json,
    extract::State,
    http::{HeaderMap, Method, StatusCode, header},
    response::{IntoResponse, Response},
};

use super::{
    api::Api,
    conditional::check_untagged,
    extract::{BrdfBody, NoParameters, PathOf, QueryOf},
    file::{FOREVER, File},
    kind::ProblemKind,
    problem::Problem,
};
use ltcforge_files::{digest::Digest, tabulated::kept_name};

/// `POST /v1/brdfs`.
pub(super) async fn store(
    State(api): State<Api>,
    _: QueryOf<NoParameters>,
    headers: HeaderMap,
    BrdfBody(bytes): BrdfBody,
) -> Result<Response, Problem> {
    check_untagged(&headers)?;
    let (stored, was_there) = api.call(move |service| service.store_brdf(&bytes)).await?;
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
    let unknown = || Problem::new(ProblemKind::UnknownBrdf, format!("no BRDF with the digest {digest} is stored"));
    let bytes = api.call(move |service| service.brdf(digest)).await?.ok_or_else(unknown)?;
    let name = Some(kept_name(digest.as_bytes()));
    let file = File { digest, bytes, media_type: "application/octet-stream", caching: FOREVER, name };
    file.respond(&method, &headers)
}
