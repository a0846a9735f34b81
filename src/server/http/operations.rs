//! Calls for operators: health, readiness, metrics, version, `openapi.yaml`.

use std::fmt::Write as _;

use axum::{
    Json,
    extract::State,
    http::header,
    response::{IntoResponse, Response},
};
use serde::Serialize;

use super::{
    api::Api,
    error,
    extract::{NoParameters, QueryOf},
    problem::Problem,
};
use crate::service::{Metrics, PictureCounts, ServiceError};
use ltcforge_fit::FITTER_VERSION;

const OPENAPI: &str = include_str!("../openapi.yaml");

#[derive(Debug, Serialize)]
pub(super) struct Status {
    status: &'static str,
}

#[derive(Debug, Serialize)]
pub(super) struct Build {
    name: &'static str,
    version: &'static str,
    /// Raised whenever the same recipe gives other bytes.
    fitter: u32,
}

/// `GET /healthz`: the process answers.
pub(super) async fn healthz(_: QueryOf<NoParameters>) -> Json<Status> {
    Json(Status { status: "ok" })
}

/// `GET /readyz`: the service accepts jobs and works on them.
pub(super) async fn readyz(State(api): State<Api>, _: QueryOf<NoParameters>) -> Result<Json<Status>, Problem> {
    let fault = api.call(|service| Ok::<_, ServiceError>(service.fault())).await?;
    match fault {
        _ if *api.stopping.borrow() || api.service.is_stopping() => Err(error::stopping()),
        Some(fault) => Err(error::unavailable(fault)),
        None => Ok(Json(Status { status: "ready" })),
    }
}

/// `GET /metrics`.
pub(super) async fn metrics(State(api): State<Api>, _: QueryOf<NoParameters>) -> Result<Response, Problem> {
    let metrics = api.call(crate::service::Service::metrics).await?;
    Ok(([(header::CONTENT_TYPE, "text/plain; version=0.0.4; charset=utf-8")], exposition(&metrics)).into_response())
}

/// `GET /version`.
pub(super) async fn version(_: QueryOf<NoParameters>) -> Json<Build> {
    Json(Build { name: "ltcforge", version: env!("CARGO_PKG_VERSION"), fitter: FITTER_VERSION })
}

/// `GET /openapi.yaml`.
pub(super) async fn openapi(_: QueryOf<NoParameters>) -> Response {
    ([(header::CONTENT_TYPE, "application/yaml")], OPENAPI).into_response()
}

/// The metrics in Prometheus' text format 0.0.4.
fn exposition(metrics: &Metrics) -> String {
    let mut text = String::from("# HELP ltcforge_jobs Jobs by state.\n# TYPE ltcforge_jobs gauge\n");
    for (state, count) in &metrics.jobs {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "ltcforge_jobs{{state=\"{}\"}} {count}", state.text());
    }
    text.push_str("# HELP ltcforge_pictures_total Pictures since the start, except those served from memory.\n");
    text.push_str("# TYPE ltcforge_pictures_total counter\n");
    let PictureCounts { done, failed, given_up, refused } = metrics.pictures;
    for (outcome, count) in [("done", done), ("failed", failed), ("given_up", given_up), ("refused", refused)] {
        let _ = writeln!(text, "ltcforge_pictures_total{{outcome=\"{outcome}\"}} {count}");
    }
    let others = [
        ("entries_fitted_total", "counter", "Entries fitted since the start.", metrics.entries_fitted),
        ("shard_failures_total", "counter", "Shards that failed since the start.", metrics.shard_failures),
        ("leases_expired_total", "counter", "Leases that expired since the start.", metrics.leases_expired),
        (
            "exports_total",
            "counter",
            "Exports made since the start, except those served from memory.",
            metrics.exports_made,
        ),
        ("blobs_corrupt_total", "counter", "Blobs found damaged or missing since the start.", metrics.blobs_corrupt),
        ("tables", "gauge", "Tables in the catalogue.", metrics.tables),
        ("table_bytes", "gauge", "Bytes of all tables.", metrics.table_bytes),
    ];
    for (name, kind, help, value) in others {
        let name = format!("ltcforge_{name}");
        let _ = writeln!(text, "# HELP {name} {help}\n# TYPE {name} {kind}\n{name} {value}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::queue::StateName;

    #[test]
    fn every_metric_has_its_line() {
        let metrics = Metrics {
            jobs: vec![(StateName::Done, 3), (StateName::Queued, 0)],
            entries_fitted: 41,
            table_bytes: 176_000,
            exports_made: 7,
            pictures: PictureCounts { done: 5, refused: 2, ..PictureCounts::default() },
            ..Metrics::default()
        };
        let text = exposition(&metrics);
        for line in [
            r#"ltcforge_jobs{state="done"} 3"#,
            r#"ltcforge_jobs{state="queued"} 0"#,
            "ltcforge_entries_fitted_total 41",
            "# TYPE ltcforge_entries_fitted_total counter",
            "ltcforge_exports_total 7",
            r#"ltcforge_pictures_total{outcome="done"} 5"#,
            r#"ltcforge_pictures_total{outcome="given_up"} 0"#,
            r#"ltcforge_pictures_total{outcome="refused"} 2"#,
            "ltcforge_table_bytes 176000",
            "# TYPE ltcforge_table_bytes gauge",
        ] {
            assert!(text.lines().any(|other| other == line), "{line} is missing in\n{text}");
        }
        assert!(text.ends_with('\n'));
    }
}
