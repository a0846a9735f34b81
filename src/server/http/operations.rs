//! Calls for operators: health, readiness, metrics, version, `openapi.yaml`.

use std::fmt::Write as _;

use axum::{
    Json,
    extract::State,
    http::header,
    response::{IntoResponse, Response},
};
use serde_json::{Value, json};

use super::{api::Api, error, extract::NoQuery, problem::Problem};
use crate::service::{Metrics, PictureCounts, ServiceError};
use ltcforge_fit::FITTER_VERSION;

const OPENAPI: &str = include_str!("../openapi.yaml");

/// `GET /healthz`: the process is alive.
pub(super) async fn healthz(_: NoQuery) -> Json<Value> {
    Json(json!({ "status": "ok" }))
}

/// `GET /readyz`: the service accepts jobs and works on them.
pub(super) async fn readyz(State(api): State<Api>, _: NoQuery) -> Result<Json<Value>, Problem> {
    let fault = api.call(|service| Ok::<_, ServiceError>(service.fault())).await?;
    match fault {
        _ if *api.stopping.borrow() || api.service.is_stopping() => Err(error::stopping()),
        Some(fault) => Err(error::unavailable(fault)),
        None => Ok(Json(json!({ "status": "ready" }))),
    }
}

/// `GET /metrics`.
pub(super) async fn metrics(State(api): State<Api>, _: NoQuery) -> Result<Response, Problem> {
    let metrics = api.call(crate::service::Service::metrics).await?;
    Ok(([(header::CONTENT_TYPE, "text/plain; version=0.0.4; charset=utf-8")], exposition(&metrics)).into_response())
}

/// `GET /version`. `fitter` increases when a new version fits different bytes from the same recipe.
pub(super) async fn version(_: NoQuery) -> Json<Value> {
    Json(json!({ "name": "ltcforge", "version": env!("CARGO_PKG_VERSION"), "fitter": FITTER_VERSION }))
}

/// `GET /openapi.yaml`.
pub(super) async fn openapi(_: NoQuery) -> Response {
    ([(header::CONTENT_TYPE, "application/yaml")], OPENAPI).into_response()
}

/// The metrics in Prometheus' text format 0.0.4.
fn exposition(metrics: &Metrics) -> String {
    let mut text = String::new();
    let mut add = |name: &str, kind: &str, help: &str, samples: &[(String, f64)]| {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "# HELP ltcforge_{name} {help}\n# TYPE ltcforge_{name} {kind}");
        for (labels, value) in samples {
            let _ = writeln!(text, "ltcforge_{name}{labels} {value}");
        }
    };
    let label = |name: &str, value: &str, count: u64| (format!("{{{name}=\"{value}\"}}"), count as f64);
    let jobs: Vec<_> = metrics.jobs.iter().map(|(state, count)| label("state", state.text(), *count)).collect();
    add("jobs", "gauge", "Jobs by state.", &jobs);
    let shards = [label("state", "waiting", metrics.shards.waiting), label("state", "leased", metrics.shards.leased)];
    add("queue_shards", "gauge", "Shards of unfinished jobs, for all processes that share the queue.", &shards);
    let PictureCounts { done, failed, given_up, refused } = metrics.pictures;
    let pictures = [("done", done), ("failed", failed), ("given_up", given_up), ("refused", refused)];
    let pictures = pictures.map(|(outcome, count)| label("outcome", outcome, count));
    add("pictures_total", "counter", "Pictures since the start, except those served from memory.", &pictures);
    let milli = |seconds: f64| (seconds * 1000.0).round() / 1000.0;
    for (name, kind, help, value) in [
        ("queue_core_seconds", "gauge", "Predicted core-seconds of the queued work.", milli(metrics.core_seconds)),
        (
            "queue_oldest_seconds",
            "gauge",
            "Seconds since the oldest unfinished job was submitted.",
            milli(metrics.oldest_seconds),
        ),
        ("entries_fitted_total", "counter", "Entries fitted since the start.", metrics.entries_fitted as f64),
        ("shard_failures_total", "counter", "Shards that failed since the start.", metrics.shard_failures as f64),
        ("leases_expired_total", "counter", "Leases that expired since the start.", metrics.leases_expired as f64),
        ("exports_total", "counter", "Exports made since the start.", metrics.exports_made as f64),
        ("files_removed_total", "counter", "Tables evicted since the start.", metrics.files_removed as f64),
        ("blobs_corrupt_total", "counter", "Stored files found damaged since the start.", metrics.blobs_corrupt as f64),
        ("tables", "gauge", "Tables in the catalogue.", metrics.tables as f64),
        ("table_bytes", "gauge", "Bytes of all tables.", metrics.table_bytes as f64),
    ] {
        add(name, kind, help, &[(String::new(), value)]);
    }
    text
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::queue::{Depth, StateName};

    #[test]
    fn every_metric_has_its_line() {
        let metrics = Metrics {
            jobs: vec![(StateName::Done, 3), (StateName::Queued, 0)],
            shards: Depth { waiting: 6, leased: 2 },
            core_seconds: 1.5,
            oldest_seconds: 0.25,
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
            r#"ltcforge_queue_shards{state="waiting"} 6"#,
            r#"ltcforge_queue_shards{state="leased"} 2"#,
            "ltcforge_queue_core_seconds 1.5",
            "# TYPE ltcforge_queue_oldest_seconds gauge",
            "ltcforge_queue_oldest_seconds 0.25",
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

    /// A graph or an alert with a wrong metric name is silently empty.
    #[test]
    fn dashboard_rules_and_autoscaler_name_metrics_that_there_are() {
        let text = exposition(&Metrics { jobs: vec![(StateName::Done, 3)], ..Metrics::default() });
        let there: BTreeSet<&str> =
            text.lines().filter_map(|line| line.strip_prefix("# TYPE ")?.split(' ').next()).collect();
        for file in ["grafana/ltcforge.json", "prometheus/ltcforge.rules.yaml", "kubernetes/autoscale.yaml"] {
            let path = format!("{}/../../deploy/{file}", env!("CARGO_MANIFEST_DIR"));
            let text = std::fs::read_to_string(path).expect("a file of the project");
            let is_of_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
            let named: BTreeSet<&str> =
                text.split(|c| !is_of_name(c)).filter(|word| word.starts_with("ltcforge_")).collect();
            assert!(!named.is_empty(), "{file}");
            assert!(named.is_subset(&there), "{file}: {:?}", named.difference(&there));
        }
    }
}
