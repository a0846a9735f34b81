//! Pictures: `GET /v1/preview` and the plots of a table.

use axum::{
    extract::State,
    http::{HeaderMap, StatusCode, header},
    response::IntoResponse,
};

use super::{
    api::Api,
    error::{self, bad_parameters},
    etag::EntityTag,
    extract::{PathOf, QueryOf},
    file::{ONE_DAY, REVALIDATE, absent},
    kind::ProblemKind,
    problem::Answer,
};
use crate::service::{PictureError, Subject};
use ltcforge_files::digest::Digest;
use ltcforge_view::{
    parameters::{ParameterFault, read_pairs},
    plots::{ErrorSlice, Plot},
    preview::{Choices, Scene},
};

/// The name-value pairs of a query string, in order. Their parsers report all faults at once.
type Pairs = Vec<(String, String)>;

fn texts(pairs: &Pairs) -> impl Iterator<Item = (&str, &str)> {
    pairs.iter().map(|(name, text)| (name.as_str(), text.as_str()))
}

/// `GET /v1/preview`. If the client disconnects, this future is dropped, and the render request is withdrawn.
pub(super) async fn preview(State(api): State<Api>, QueryOf(query): QueryOf<Pairs>, headers: HeaderMap) -> Answer {
    let (table, scene) = read_preview(&query).map_err(|faults| bad_parameters(ProblemKind::BadScene, faults))?;
    answer(&api, table, Subject::Scene(Box::new(scene)), headers).await
}

/// `GET /v1/tables/{digest}/plots/error.png`.
pub(super) async fn error_plot(
    State(api): State<Api>,
    PathOf(digest): PathOf<Digest>,
    QueryOf(query): QueryOf<Pairs>,
    headers: HeaderMap,
) -> Answer {
    plot(&api, digest, Plot::error_from(texts(&query)), headers).await
}

/// `GET /v1/tables/{digest}/plots/error.json`: the numbers that the picture shows.
pub(super) async fn error_numbers(
    State(api): State<Api>,
    PathOf(digest): PathOf<Digest>,
    QueryOf(query): QueryOf<Pairs>,
    headers: HeaderMap,
) -> Answer {
    let slice = ErrorSlice::from_pairs(texts(&query)).map_err(|faults| bad_parameters(ProblemKind::BadPlot, faults))?;
    answer(&api, Some(digest), Subject::Errors(slice), headers).await
}

/// `GET /v1/tables/{digest}/plots/matrix.png`.
pub(super) async fn matrix_plot(
    State(api): State<Api>,
    PathOf(digest): PathOf<Digest>,
    QueryOf(query): QueryOf<Pairs>,
    headers: HeaderMap,
) -> Answer {
    plot(&api, digest, Plot::matrix_from(texts(&query)), headers).await
}

async fn plot(api: &Api, table: Digest, plot: Result<Plot, Vec<ParameterFault>>, headers: HeaderMap) -> Answer {
    let plot = plot.map_err(|faults| bad_parameters(ProblemKind::BadPlot, faults))?;
    answer(api, Some(table), Subject::Plot(plot), headers).await
}

/// The picture, or 304 if the client has it.
async fn answer(api: &Api, table: Option<Digest>, subject: Subject, headers: HeaderMap) -> Answer {
    let caching = if table.is_none() && subject.needs_table() { REVALIDATE } else { ONE_DAY };
    let media_type = subject.media_type();
    let mut stopping = api.stopping.clone();
    let asked = tokio::select! {
        asked = api.service.picture(table, subject) => asked,
        _ = stopping.wait_for(|stopping| *stopping) => return Err(error::stopping()),
    };
    let file = match asked {
        Err(PictureError::UnknownTable(table)) => return Err(absent(api, table).await),
        asked => asked?,
    };
    let tag = EntityTag::strong(file.digest);
    tag.check_if_match(&headers)?;
    // The name of a driver can contain characters that are not allowed in a header field.
    let adapter: String =
        file.adapter.chars().map(|c| if c.is_ascii_graphic() || c == ' ' { c } else { '?' }).collect();
    let fields = [(header::ETAG, tag.as_str()), (header::CACHE_CONTROL, caching)];
    let adapter = [("preview-adapter", adapter.trim())];
    if tag.is_known_to(&headers) {
        return Ok((StatusCode::NOT_MODIFIED, fields, adapter).into_response());
    }
    Ok((fields, adapter, [(header::CONTENT_TYPE, media_type)], file.bytes).into_response())
}

/// The table and the scene of a preview's query, or all faults of the query.
fn read_preview(query: &Pairs) -> Result<(Option<Digest>, Scene), Vec<ParameterFault>> {
    let (tables, others): (Vec<_>, Vec<_>) = texts(query).partition(|(name, _)| *name == "table");
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
