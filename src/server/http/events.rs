//! A job's news as Server-Sent Events.
//!
//! The first event is the job as it is, unless `Last-Event-ID` says that the client has seen it. An event is named
//! `state` when the state changed and `progress` otherwise; its id is the news' sequence, its data the job. The stream
//! ends after a final state, and when the server stops. A client that has seen the final state is told 204, which is
//! how an `EventSource` is told to stay away.

use std::{convert::Infallible, time::Duration};

use axum::{
    extract::State,
    http::{HeaderMap, StatusCode},
    response::{
        IntoResponse, Response,
        sse::{Event, KeepAlive, Sse},
    },
};
use futures_util::{Stream, stream};
use tokio::{
    sync::watch,
    time::{Instant, sleep_until},
};

use super::{
    Api,
    extract::{NoParameters, PathOf, QueryOf},
    jobs,
    problem::Problem,
    views::{JobView, is_final, state_name},
};
use crate::server::{
    queue::{JobId, StateName},
    service::JobNews,
};

/// How often a comment tells proxies that the stream is alive.
const HEARTBEAT: Duration = Duration::from_secs(15);

/// The shortest time between two events of one stream: news that come faster are told as one, the latest.
const PACE: Duration = Duration::from_millis(100);

/// `GET /v1/jobs/{id}/events`.
pub(super) async fn follow(
    State(api): State<Api>,
    _: QueryOf<NoParameters>,
    PathOf(id): PathOf<JobId>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let news = api.call(move |service| service.watch(id)).await?.ok_or_else(|| jobs::unknown(id))?;
    // The HTML standard lets a server ignore an id that it cannot read.
    let seen = headers.get("last-event-id").and_then(|value| value.to_str().ok()?.parse().ok());
    let follower = Follower { news, stopping: api.stopping.clone(), seen, state: None, told: None };
    if follower.is_over() {
        return Ok(StatusCode::NO_CONTENT.into_response());
    }
    let keep_alive = KeepAlive::new().interval(HEARTBEAT).text("heartbeat");
    Ok(Sse::new(follower.events()).keep_alive(keep_alive).into_response())
}

/// One client's place in a job's history.
struct Follower {
    news: watch::Receiver<JobNews>,
    stopping: watch::Receiver<bool>,
    /// Sequence of the last news that the client has.
    seen: Option<u64>,
    /// State in the last news that was sent on this connection.
    state: Option<StateName>,
    /// When that was.
    told: Option<Instant>,
}

impl Follower {
    /// Whether the client has seen the job's final state.
    fn is_over(&self) -> bool {
        let news = self.news.borrow();
        self.seen == Some(news.sequence) && is_final(&news.job.state)
    }

    fn events(self) -> impl Stream<Item = Result<Event, Infallible>> {
        stream::unfold(self, async |mut follower| {
            let news = follower.next().await?;
            let event = follower.event(&news)?;
            Some((Ok(event), follower))
        })
    }

    /// The next news that the client has not seen; `None` when there will be none.
    async fn next(&mut self) -> Option<JobNews> {
        if let Some(told) = self.told {
            sleep_until(told + PACE).await;
        }
        loop {
            if *self.stopping.borrow() || self.is_over() {
                return None;
            }
            let news = self.news.borrow_and_update().clone();
            // Another sequence, not only a later one: after a restart of the service the count starts anew.
            if self.seen != Some(news.sequence) {
                self.seen = Some(news.sequence);
                self.told = Some(Instant::now());
                return Some(news);
            }
            tokio::select! {
                changed = self.news.changed() => changed.ok()?,
                changed = self.stopping.changed() => changed.ok()?,
            }
        }
    }

    fn event(&mut self, news: &JobNews) -> Option<Event> {
        let state = state_name(&news.job.state);
        let name = if self.state.replace(state) == Some(state) { "progress" } else { "state" };
        let event = Event::default().event(name).id(news.sequence.to_string());
        event.json_data(JobView::of_news(news).ok()?).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        files::digest::Digest,
        server::{http::views::samples, queue::JobState},
    };

    fn news(sequence: u64, state: JobState) -> JobNews {
        JobNews { sequence, job: samples::job(state), seconds_left: None, expected: None }
    }

    fn follower(first: JobNews, seen: Option<u64>) -> (watch::Sender<JobNews>, watch::Sender<bool>, Follower) {
        let (tell, news) = watch::channel(first);
        let (stop, stopping) = watch::channel(false);
        (tell, stop, Follower { news, stopping, seen, state: None, told: None })
    }

    #[tokio::test]
    async fn a_new_client_gets_the_present_then_each_change_then_the_end() {
        let (tell, _stop, mut follower) = follower(news(7, JobState::Running), None);
        assert_eq!(follower.next().await.map(|news| news.sequence), Some(7));
        tell.send_replace(news(9, JobState::Done { table: Digest::of(b"") }));
        assert_eq!(follower.next().await.map(|news| news.sequence), Some(9));
        assert!(follower.is_over());
        assert!(follower.next().await.is_none());
    }

    #[tokio::test]
    async fn a_client_that_resumes_waits_for_what_it_has_not_seen() {
        let (tell, _stop, mut follower) = follower(news(7, JobState::Running), Some(7));
        let (next, ()) = tokio::join!(follower.next(), async {
            tokio::task::yield_now().await;
            tell.send_replace(news(8, JobState::Running));
        });
        assert_eq!(next.map(|news| news.sequence), Some(8));
    }

    #[tokio::test]
    async fn an_id_from_before_a_restart_gets_the_present_at_once() {
        let (_tell, _stop, mut follower) = follower(news(2, JobState::Running), Some(70));
        assert_eq!(follower.next().await.map(|news| news.sequence), Some(2));
    }

    #[tokio::test]
    async fn a_stopping_server_ends_the_stream() {
        let (_tell, stop, mut follower) = follower(news(7, JobState::Running), Some(7));
        let (next, ()) = tokio::join!(follower.next(), async {
            tokio::task::yield_now().await;
            stop.send_replace(true);
        });
        assert!(next.is_none());
    }

    #[test]
    fn only_a_change_of_state_is_called_state() {
        let (_tell, _stop, mut follower) = follower(news(1, JobState::Running), None);
        let mut name = |sequence, state| format!("{:?}", follower.event(&news(sequence, state)).expect("an event"));
        assert!(name(1, JobState::Running).contains("event: state"));
        assert!(name(2, JobState::Running).contains("event: progress"));
        assert!(name(3, JobState::Cancelled).contains("event: state"));
    }
}
