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
    file::{Contents, FOREVER, File},
    kind::ProblemKind,
    problem::Problem,
};
use ltcforge_files::{digest::Digest, tabulated::kept_name};

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
    let unknown = || Problem::new(ProblemKind::UnknownBrdf, format!("no BRDF with the digest {digest} is stored"));
    let length = api.call(move |service| service.brdf_length(digest)).await?.ok_or_else(unknown)?;
    let name = Some(kept_name(digest.as_bytes()));
    let contents = Contents::Stored { api, length };
    let file = File { digest, contents, media_type: "application/octet-stream", caching: FOREVER, name };
    file.respond(&method, &headers)
}
