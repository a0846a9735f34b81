//! Pictures: `GET /v1/preview` and the plots of a table.

use std::sync::Arc;

use axum::{
    body::{Body, Bytes},
    extract::State,
    http::{HeaderMap, HeaderValue, Response as HttpResponse, StatusCode, header, response::Builder},
    response::Response,
};

use super::{
    absent::absent,
    api::Api,
    conditional::EntityTag,
    error::{self, bad_parameters},
    extract::{PathOf, QueryPairs},
    kind::ProblemKind,
    problem::Problem,
};
use crate::service::{PictureError, PictureReply, Subject};
use ltcforge_files::digest::Digest;
use ltcforge_view::{
    parameters::{ParameterFault, read_pairs},
    plots::{ErrorSlice, Plot},
    preview::{Choices, Scene},
};

/// The picture of a named table, or of none, changes only with the adapter or the version of the service.
const ONE_DAY: &str = "public, max-age=86400";
/// The best stored table may change as tables are added.
const REVALIDATE: &str = "no-cache";

/// `GET /v1/preview`. When the client disconnects, this future is dropped, and its request with it.
pub(super) async fn preview(
    State(api): State<Api>,
    query: QueryPairs,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let (table, scene) = read_preview(&query).map_err(|faults| bad_parameters(ProblemKind::BadScene, faults))?;
    answer(&api, table, Subject::Scene(Box::new(scene)), headers).await
}

/// `GET /v1/tables/{digest}/plots/error.png`.
pub(super) async fn error_plot(
    State(api): State<Api>,
    PathOf(digest): PathOf<Digest>,
    query: QueryPairs,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    plot(&api, digest, Plot::error_from(query.iter()), headers).await
}

/// `GET /v1/tables/{digest}/plots/error.json`: what the picture shows, as numbers.
pub(super) async fn error_numbers(
    State(api): State<Api>,
    PathOf(digest): PathOf<Digest>,
    query: QueryPairs,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let slice = ErrorSlice::from_pairs(query.iter()).map_err(|faults| bad_parameters(ProblemKind::BadPlot, faults))?;
    answer(&api, Some(digest), Subject::Errors(slice), headers).await
}

/// `GET /v1/tables/{digest}/plots/matrix.png`.
pub(super) async fn matrix_plot(
    State(api): State<Api>,
    PathOf(digest): PathOf<Digest>,
    query: QueryPairs,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    plot(&api, digest, Plot::matrix_from(query.iter()), headers).await
}

async fn plot(
    api: &Api,
    table: Digest,
    plot: Result<Plot, Vec<ParameterFault>>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let plot = plot.map_err(|faults| bad_parameters(ProblemKind::BadPlot, faults))?;
    answer(api, Some(table), Subject::Plot(plot), headers).await
}

/// The picture, or 304 if the client has it.
async fn answer(api: &Api, table: Option<Digest>, subject: Subject, headers: HeaderMap) -> Result<Response, Problem> {
    let caching = if table.is_none() && subject.needs_table() { REVALIDATE } else { ONE_DAY };
    let media_type = subject.media_type();
    let conditions = headers.clone();
    let is_known = move |tag: Digest| EntityTag::strong(tag).is_known_to(&conditions);
    let asked = api.call(move |service| match service.picture(table, subject, is_known) {
        Err(PictureError::UnknownTable(table)) => Ok(Err(table)),
        asked => asked.map(Ok),
    });
    let asked = match asked.await? {
        Ok(asked) => asked,
        Err(table) => return Err(absent(api, table).await),
    };
    let file = match asked {
        PictureReply::Known { tag, adapter } => {
            EntityTag::strong(tag).check_if_match(&headers)?;
            return unchanged(tag, &adapter, caching);
        }
        PictureReply::Ready(file) => file,
        PictureReply::Pending(pending) => {
            let mut stopping = api.stopping.clone();
            tokio::select! {
                file = pending.file() => file?,
                _ = stopping.wait_for(|stopping| *stopping) => return Err(error::stopping()),
            }
        }
    };
    let entity_tag = EntityTag::strong(file.tag);
    entity_tag.check_if_match(&headers)?;
    if entity_tag.is_known_to(&headers) {
        return unchanged(file.tag, &file.adapter, caching);
    }
    let head = head(StatusCode::OK, file.tag, &file.adapter, caching).header(header::CONTENT_TYPE, media_type);
    finish(head, Body::from(Bytes::from_owner(Shared(file.bytes))))
}

/// Table and scene of a preview's query, or all its faults.
fn read_preview(query: &QueryPairs) -> Result<(Option<Digest>, Scene), Vec<ParameterFault>> {
    let (tables, others): (Vec<_>, Vec<_>) = query.iter().partition(|(name, _)| *name == "table");
    let mut table = None;
    let mut faults = read_pairs(tables, |_, text| {
        table = Some(text.parse::<Digest>().map_err(|error| error.to_string())?);
        Ok(())
    });
    match Choices::read(others) {
        Ok(scene) if faults.is_empty() => Ok((table, scene)),
        Ok(_) => Err(faults),
        Err(others) => {
            faults.extend(others);
            Err(faults)
        }
    }
}

fn unchanged(tag: Digest, adapter: &str, caching: &'static str) -> Result<Response, Problem> {
    finish(head(StatusCode::NOT_MODIFIED, tag, adapter, caching), Body::empty())
}

fn head(status: StatusCode, tag: Digest, adapter: &str, caching: &'static str) -> Builder {
    // A driver's name may hold any characters; a header field may not.
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
struct Shared(Arc<Vec<u8>>);

impl AsRef<[u8]> for Shared {
    fn as_ref(&self) -> &[u8] {
        &self.0
    }
}
