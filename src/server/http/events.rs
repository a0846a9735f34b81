//! A job's changes as Server-Sent Events.
//!
//! The first event is the current job, unless `Last-Event-ID` says that the client has it. The name of an event is
//! `state` if the state changed, otherwise `progress`. Its id is the snapshot's sequence number. Its data is the job.
//! The stream ends after a final state, when the server stops, and when the client's token is revoked. A client that
//! has the final state gets 204, after which an `EventSource` does not reconnect.

use std::{convert::Infallible, sync::Arc, time::Duration};

use axum::{
    Extension,
    extract::State,
    http::{HeaderMap, StatusCode},
    response::{
        IntoResponse, Response,
        sse::{Event, KeepAlive, Sse},
    },
};
use futures_util::{Stream, stream};
use tokio::{
    sync::{OwnedSemaphorePermit, watch},
    time::{Instant, sleep, sleep_until},
};

use super::{
    access::Caller,
    api::{Api, EVENT_STREAMS},
    extract::{NoQuery, PathOf},
    jobs,
    kind::ProblemKind,
    problem::Problem,
    tokens::TokenFile,
    views::JobView,
};
use crate::{
    queue::{JobId, StateName},
    service::JobSnapshot,
};

/// Interval of the comments that keep the stream alive in proxies.
const HEARTBEAT: Duration = Duration::from_secs(15);

/// The shortest time between two events of one stream. If changes come faster, only the latest is sent.
const MIN_INTERVAL: Duration = Duration::from_millis(100);

/// How often a stream without events checks that its token is still valid.
const CHECK: Duration = Duration::from_secs(2);

/// `Retry-After` if too many streams are open.
const RETRY: Duration = Duration::from_secs(10);

/// `GET /v1/jobs/{id}/events`.
pub(super) async fn follow(
    State(api): State<Api>,
    _: NoQuery,
    PathOf(id): PathOf<JobId>,
    caller: Option<Extension<Caller>>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let latest = api.call(move |service| service.watch(id)).await?.ok_or_else(|| jobs::unknown(id))?;
    // The HTML standard lets a server ignore an unreadable id.
    let last = headers.get("last-event-id").and_then(|value| value.to_str().ok()?.parse().ok());
    let caller = caller.map(|Extension(caller)| caller);
    let (tokens, stopping) = (Arc::clone(&api.tokens), api.stopping.clone());
    let follower = Follower { latest, stopping, tokens, caller, last, state: None, sent_at: None };
    if follower.is_over() {
        return Ok(StatusCode::NO_CONTENT.into_response());
    }
    let place = Arc::clone(&api.streams).try_acquire_owned().map_err(|_| {
        let detail = format!("{EVENT_STREAMS} event streams are open; poll the job instead");
        Problem::new(ProblemKind::Busy, detail).with_retry_after(RETRY)
    })?;
    let keep_alive = KeepAlive::new().interval(HEARTBEAT).text("heartbeat");
    Ok(Sse::new(follower.events(place)).keep_alive(keep_alive).into_response())
}

/// One client's position in the history of a job.
struct Follower {
    latest: watch::Receiver<JobSnapshot>,
    stopping: watch::Receiver<bool>,
    tokens: Arc<TokenFile>,
    /// `None` if the service needs no token.
    caller: Option<Caller>,
    /// Sequence number of the last snapshot that the client has.
    last: Option<u64>,
    /// State in the last snapshot that was sent on this connection.
    state: Option<StateName>,
    /// When the last snapshot was sent.
    sent_at: Option<Instant>,
}

impl Follower {
    /// Whether the client has the job's final state.
    fn is_over(&self) -> bool {
        let latest = self.latest.borrow();
        self.last == Some(latest.sequence) && latest.job.state.name().is_final()
    }

    fn is_revoked(&self) -> bool {
        self.caller.as_ref().is_some_and(|Caller(token)| !self.tokens.current().contains(token))
    }

    /// The stream of events. It holds a permit until it ends.
    fn events(self, place: OwnedSemaphorePermit) -> impl Stream<Item = Result<Event, Infallible>> {
        stream::unfold((self, place), async |(mut follower, place)| {
            let snapshot = follower.next().await?;
            let event = follower.event(&snapshot)?;
            Some((Ok(event), (follower, place)))
        })
    }

    /// The next snapshot that the client does not have; `None` when the stream ends.
    async fn next(&mut self) -> Option<JobSnapshot> {
        if let Some(sent) = self.sent_at {
            sleep_until(sent + MIN_INTERVAL).await;
        }
        loop {
            if *self.stopping.borrow() || self.is_over() || self.is_revoked() {
                return None;
            }
            let snapshot = self.latest.borrow_and_update().clone();
            // A smaller number can be new too, because the clock may have been set back before the last start.
            if self.last != Some(snapshot.sequence) {
                self.last = Some(snapshot.sequence);
                self.sent_at = Some(Instant::now());
                return Some(snapshot);
            }
            tokio::select! {
                changed = self.latest.changed() => changed.ok()?,
                changed = self.stopping.changed() => changed.ok()?,
                () = sleep(CHECK) => {}
            }
        }
    }

    fn event(&mut self, snapshot: &JobSnapshot) -> Option<Event> {
        let state = snapshot.job.state.name();
        let name = if self.state.replace(state) == Some(state) { "progress" } else { "state" };
        let event = Event::default().event(name).id(snapshot.sequence.to_string());
        event.json_data(JobView::of_snapshot(snapshot).ok()?).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        http::{
            tokens::{Scope, TOKEN_BYTES, Token},
            views::samples,
        },
        queue::JobState,
    };
    use ltcforge_files::digest::Digest;

    fn snapshot(sequence: u64, state: JobState) -> JobSnapshot {
        JobSnapshot { sequence, job: samples::job(state), seconds_left: None, expected: None }
    }

    fn follower(first: JobSnapshot, last: Option<u64>) -> (watch::Sender<JobSnapshot>, watch::Sender<bool>, Follower) {
        let (publish, latest) = watch::channel(first);
        let (stop, stopping) = watch::channel(false);
        let tokens = Arc::default();
        (publish, stop, Follower { latest, stopping, tokens, caller: None, last, state: None, sent_at: None })
    }

    #[tokio::test]
    async fn a_new_client_gets_the_job_as_it_is_then_each_change_then_the_end() {
        let (publish, _stop, mut follower) = follower(snapshot(7, JobState::Running), None);
        assert_eq!(follower.next().await.map(|snapshot| snapshot.sequence), Some(7));
        publish.send_replace(snapshot(9, JobState::Done { table: Digest::of(b"") }));
        assert_eq!(follower.next().await.map(|snapshot| snapshot.sequence), Some(9));
        assert!(follower.is_over());
        assert!(follower.next().await.is_none());
    }

    #[tokio::test]
    async fn a_client_that_resumes_waits_for_what_it_has_not_seen() {
        let (publish, _stop, mut follower) = follower(snapshot(7, JobState::Running), Some(7));
        let (next, ()) = tokio::join!(follower.next(), async {
            tokio::task::yield_now().await;
            publish.send_replace(snapshot(8, JobState::Running));
        });
        assert_eq!(next.map(|snapshot| snapshot.sequence), Some(8));
    }

    #[tokio::test]
    async fn an_unknown_id_gets_the_job_as_it_is_at_once() {
        let (_publish, _stop, mut follower) = follower(snapshot(2, JobState::Running), Some(70));
        assert_eq!(follower.next().await.map(|snapshot| snapshot.sequence), Some(2));
    }

    #[tokio::test]
    async fn a_stopping_server_ends_the_stream() {
        let (_publish, stop, mut follower) = follower(snapshot(7, JobState::Running), Some(7));
        let (next, ()) = tokio::join!(follower.next(), async {
            tokio::task::yield_now().await;
            stop.send_replace(true);
        });
        assert!(next.is_none());
    }

    #[tokio::test]
    async fn a_revoked_token_ends_the_stream() {
        let (_publish, _stop, mut follower) = follower(snapshot(7, JobState::Running), Some(7));
        let (_, token) = Token::new("farm", Scope::Read, &[1; TOKEN_BYTES]).expect("a name");
        let tokens = TokenFile::open(Some(token.to_string()), None).expect("a token");
        follower = Follower { tokens: Arc::new(tokens), caller: Some(Caller(Arc::new(token.clone()))), ..follower };
        assert!(!follower.is_revoked());
        follower.tokens = Arc::default();
        assert!(follower.next().await.is_none());
    }

    #[test]
    fn only_a_change_of_state_is_named_state() {
        let (_publish, _stop, mut follower) = follower(snapshot(1, JobState::Running), None);
        let mut name = |sequence, state| format!("{:?}", follower.event(&snapshot(sequence, state)).expect("an event"));
        assert!(name(1, JobState::Running).contains("event: state"));
        assert!(name(2, JobState::Running).contains("event: progress"));
        assert!(name(3, JobState::Cancelled).contains("event: state"));
    }
}
