//! Jobs: submit, list, show, cancel.

use std::time::Duration;

use axum::{
    Json,
    extract::State,
    http::{HeaderValue, StatusCode, header},
    response::IntoResponse,
};
use serde::Deserialize;

use super::{
    api::Api,
    etag::check_untagged,
    extract::{Asked, NoQuery, PageLimit, PathOf, QueryOf, RecipeBody},
    kind::ProblemKind,
    problem::{Answer, Problem, whole_seconds},
    views::JobView,
};
use crate::{
    queue::{JobId, StateName},
    service::{JobCursor, JobSnapshot, Page, Service, SubmitError, SubmitReply},
};

/// Maximum of `Retry-After` for a job.
const LONGEST_RETRY: Duration = Duration::from_secs(30);

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ListParameters {
    state: Option<StateName>,
    cursor: Option<JobCursor>,
    #[serde(default)]
    limit: PageLimit,
}

/// `POST /v1/jobs`.
pub(super) async fn submit(State(api): State<Api>, asked: Asked, RecipeBody(document): RecipeBody) -> Answer {
    check_untagged(&asked.headers)?;
    let submit = move |service: &Service| {
        let (status, job) = match service.submit(&document, asked.by.as_deref())? {
            SubmitReply::InFlight { job, .. } => (StatusCode::ACCEPTED, job),
            SubmitReply::Ready { job, .. } => (StatusCode::OK, job),
        };
        let expected = service.expected(&job);
        Ok::<_, SubmitError>((status, job, expected))
    };
    let (status, job, expected) = api.call(submit).await?;
    let location = [(header::LOCATION, format!("/v1/jobs/{}", job.id))];
    let retry_after = (status == StatusCode::ACCEPTED).then(|| [(header::RETRY_AFTER, retry_after(None))]);
    Ok((status, location, retry_after, Json(JobView::new(&job, None, expected)?)).into_response())
}

/// `GET /v1/jobs`.
pub(super) async fn list(
    State(api): State<Api>,
    QueryOf(ListParameters { state, cursor, limit }): QueryOf<ListParameters>,
) -> Result<Json<Page<JobView>>, Problem> {
    let Page { items, next } = api.call(move |service| service.jobs(state, cursor, limit.0)).await?;
    let items = items.iter().map(JobView::of_snapshot).collect::<Result<_, _>>()?;
    Ok(Json(Page { items, next }))
}

/// `GET /v1/jobs/{id}`.
pub(super) async fn show(State(api): State<Api>, _: NoQuery, PathOf(id): PathOf<JobId>) -> Answer {
    let snapshot = api.call(move |service| service.job(id)).await?.ok_or_else(|| unknown(id))?;
    answer(&snapshot)
}

/// `DELETE /v1/jobs/{id}`.
pub(super) async fn cancel(State(api): State<Api>, asked: Asked, PathOf(id): PathOf<JobId>) -> Answer {
    if let Err(problem) = check_untagged(&asked.headers) {
        // If the job does not exist, the response is 404 even if the condition fails.
        return Err(api.call(move |service| service.job(id)).await?.map_or_else(|| unknown(id), |_| problem));
    }
    let snapshot = api.call(move |service| service.cancel(id, asked.by.as_deref())).await?;
    answer(&snapshot.ok_or_else(|| unknown(id))?)
}

/// The problem for an unknown job id.
pub(super) fn unknown(id: JobId) -> Problem {
    Problem::new(ProblemKind::UnknownJob, format!("no job has the id {id}"))
}

/// The response for a job: not cached, and with `Retry-After` while the job may change.
fn answer(snapshot: &JobSnapshot) -> Answer {
    let may_change = !snapshot.job.state.name().is_final();
    let retry_after = may_change.then(|| [(header::RETRY_AFTER, retry_after(snapshot.seconds_left))]);
    let caching = [(header::CACHE_CONTROL, "no-store")];
    Ok((caching, retry_after, Json(JobView::of_snapshot(snapshot)?)).into_response())
}

fn retry_after(seconds_left: Option<f64>) -> HeaderValue {
    let expected = seconds_left.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok()).unwrap_or_default();
    HeaderValue::from(whole_seconds(expected.min(LONGEST_RETRY)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{http::views::samples, queue::JobState};
    use ltcforge_files::digest::Digest;

    #[test]
    fn clients_are_asked_to_poll_again_in_one_to_thirty_seconds() {
        let cases =
            [(None, "1"), (Some(0.2), "1"), (Some(4.1), "5"), (Some(1e300), "1"), (Some(-1.0), "1"), (Some(9e3), "30")];
        for (seconds, expected) in cases {
            assert_eq!(retry_after(seconds), expected, "{seconds:?}");
        }
    }

    #[test]
    fn only_a_job_that_may_change_has_a_retry_after() {
        let field = |state| {
            let snapshot =
                JobSnapshot { sequence: 1, job: samples::job(state), seconds_left: Some(2.0), expected: None };
            answer(&snapshot).expect("the recipe is JSON").headers().get(header::RETRY_AFTER).cloned()
        };
        assert_eq!(field(JobState::Running), Some(HeaderValue::from(2)));
        assert_eq!(field(JobState::Done { table: Digest::of(b"") }), None);
    }
}
