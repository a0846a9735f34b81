//! Pictures: `GET /v1/preview` and the plots of a table.

use std::sync::Arc;

use axum::{
    body::{Body, Bytes},
    extract::{Query, State},
    http::{HeaderMap, HeaderValue, Response as HttpResponse, StatusCode, Uri, header, response::Builder},
    response::Response,
};
use serde::Deserialize;

use super::{
    Api,
    conditional::EntityTag,
    error::{self, Kind},
    extract::{NoParameters, PathOf, QueryOf},
    problem::Problem,
};
use crate::{
    files::digest::Digest,
    server::service::{Ordered, PictureError, PictureFile, Subject},
    view::{
        plots::{Azimuth, Plot, Ratio, Slice},
        preview::{Choices, ParameterFault, Scene},
    },
};

/// The picture of a named table changes with the adapter or the version of the service alone.
const A_DAY: &str = "public, max-age=86400";
/// The best table of today is not that of tomorrow.
const ASK_AGAIN: &str = "no-cache";

/// `GET /v1/preview`. A client that goes takes this future with it, and with it the order.
pub(super) async fn preview(State(api): State<Api>, uri: Uri, headers: HeaderMap) -> Result<Response, Problem> {
    let (table, scene) = read(&uri)?;
    answer(&api, table, Subject::Scene(Box::new(scene)), headers).await
}

/// `GET /v1/tables/{digest}/plots/error.png`.
pub(super) async fn error_plot(
    State(api): State<Api>,
    QueryOf(SliceParameters { ratio, phi }): QueryOf<SliceParameters>,
    PathOf(digest): PathOf<Digest>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    answer(&api, Some(digest), Subject::Plot(Plot::Error(Slice::new(ratio, phi))), headers).await
}

/// `GET /v1/tables/{digest}/plots/matrix.png`.
pub(super) async fn matrix_plot(
    State(api): State<Api>,
    _: QueryOf<NoParameters>,
    PathOf(digest): PathOf<Digest>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    answer(&api, Some(digest), Subject::Plot(Plot::Matrix), headers).await
}

/// Where a plot cuts the domain.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SliceParameters {
    ratio: Option<Ratio>,
    phi: Option<Azimuth>,
}

/// The picture, or word that the client has it.
async fn answer(api: &Api, table: Option<Digest>, subject: Subject, headers: HeaderMap) -> Result<Response, Problem> {
    let caching = if table.is_some() { A_DAY } else { ASK_AGAIN };
    let asked = headers.clone();
    let is_known = move |tag: Digest| EntityTag::strong(tag).is_known_to(&asked);
    let wait = match api.call(move |service| service.picture(table, subject, is_known)).await? {
        Ordered::Known { tag, adapter } => return unchanged(tag, &adapter, caching),
        Ordered::Ready(file) => return whole(file, caching),
        Ordered::Waiting(wait) => wait,
    };
    let mut stopping = api.stopping.clone();
    let file = tokio::select! {
        file = wait.file() => file?,
        _ = stopping.wait_for(|stopping| *stopping) => return Err(error::stopping()),
    };
    // What renders was not known when the picture was ordered.
    if EntityTag::strong(file.tag).is_known_to(&headers) {
        return unchanged(file.tag, &file.adapter, caching);
    }
    whole(file, caching)
}

/// Table and scene of a query string.
fn read(uri: &Uri) -> Result<(Option<Digest>, Scene), Problem> {
    let Query(pairs) = Query::<Vec<(String, String)>>::try_from_uri(uri)
        .map_err(|rejection| Problem::new(Kind::BadParameter, rejection.body_text()))?;
    let (tables, others): (Vec<_>, Vec<_>) = pairs.iter().partition(|(name, _)| name == "table");
    let mut faults = Vec::new();
    let mut table = None;
    for (name, text) in tables {
        match text.parse::<Digest>() {
            Ok(_) if table.is_some() => faults.push(ParameterFault::new(name, "stands twice")),
            Ok(digest) => table = Some(digest),
            Err(error) => faults.push(ParameterFault::new(name, error.to_string())),
        }
    }
    match Choices::read(others.iter().map(|(name, text)| (name.as_str(), text.as_str()))) {
        Ok(scene) if faults.is_empty() => Ok((table, scene)),
        Ok(_) => Err(PictureError::Parameters(faults).into()),
        Err(others) => {
            faults.extend(others);
            Err(PictureError::Parameters(faults).into())
        }
    }
}

fn whole(file: PictureFile, caching: &'static str) -> Result<Response, Problem> {
    let head = head(StatusCode::OK, file.tag, &file.adapter, caching).header(header::CONTENT_TYPE, "image/png");
    finish(head, Body::from(Bytes::from_owner(Png(file.png))))
}

fn unchanged(tag: Digest, adapter: &str, caching: &'static str) -> Result<Response, Problem> {
    finish(head(StatusCode::NOT_MODIFIED, tag, adapter, caching), Body::empty())
}

fn head(status: StatusCode, tag: Digest, adapter: &str, caching: &'static str) -> Builder {
    // A driver may name itself in any characters.
    let plain: String = adapter.chars().map(|c| if c.is_ascii_graphic() || c == ' ' { c } else { '?' }).collect();
    HttpResponse::builder()
        .status(status)
        .header(header::ETAG, EntityTag::strong(tag).as_str())
        .header(header::CACHE_CONTROL, HeaderValue::from_static(caching))
        .header("preview-adapter", plain.trim())
}

fn finish(head: Builder, body: Body) -> Result<Response, Problem> {
    head.body(body).map_err(|error| error::internal(&error))
}

/// Shares the service's copy of a picture with the response.
struct Png(Arc<Vec<u8>>);

impl AsRef<[u8]> for Png {
    fn as_ref(&self) -> &[u8] {
        &self.0
    }
}
