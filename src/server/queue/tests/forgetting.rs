//! Jobs that ended long ago.

use std::{num::NonZeroU32, time::Duration};

use super::world::{World, complete, submit, task};
use crate::queue::{Failure, FailureKind, JobId, JobState, Limits, Queue, StateName};

const DAY: Duration = Duration::from_secs(86_400);

fn keeping(keep_ended: Option<Duration>) -> Limits {
    Limits { jobs: 9, lease_ttl: 2000 * DAY, max_attempts: NonZeroU32::MIN, keep_ended, most_ended: None }
}

/// Jobs that were cancelled, failed with one finished shard, and are running.
fn one_of_each(queue: &dyn Queue) -> [JobId; 3] {
    let cancelled = submit(queue, "cancelled", 2);
    queue.cancel(cancelled, None).unwrap();
    let failed = submit(queue, "failed", 2);
    complete(queue, &task(queue));
    let error = Failure { kind: FailureKind::Attempts, detail: "no luck".to_owned() };
    queue.abort(&task(queue).lease, error).unwrap();
    let running = submit(queue, "running", 2);
    task(queue);
    [cancelled, failed, running]
}

pub(super) fn jobs_that_ended_long_ago_are_forgotten_with_all_their_rows<W: World>() {
    let Some(mut world) = W::new(keeping(Some(DAY))) else { return };
    let [cancelled, failed, running] = one_of_each(world.queue());
    assert_eq!(world.results(), 1, "a failed job keeps its results");
    world.pass(DAY);
    let young = submit(world.queue(), "young", 2);
    assert!(world.queue().job(cancelled).unwrap().is_some(), "a day is not over a day");
    world.pass(Duration::from_secs(3600));
    submit(world.queue(), "another", 2);
    let queue = world.queue();
    assert_eq!([cancelled, failed].map(|id| queue.job(id).unwrap()), [None, None]);
    assert!([running, young].iter().all(|id| queue.job(*id).unwrap().is_some()));
    for (state, count) in queue.counts().unwrap() {
        let expected = match state {
            StateName::Queued => 2,
            StateName::Running => 1,
            _ => 0,
        };
        assert_eq!(count, expected, "{state:?}");
    }
    assert_eq!(queue.list(None, None, 9).unwrap().0.len(), 3);
    assert_eq!(world.results(), 0);
    // It is simply a new job.
    submit(queue, "cancelled", 2);
    assert_eq!(queue.job(cancelled).unwrap().unwrap().state, JobState::Queued);
}

pub(super) fn of_too_many_jobs_those_that_ended_first_are_forgotten<W: World>() {
    let limits = Limits { most_ended: Some(2), ..keeping(None) };
    let Some(mut world) = W::new(limits) else { return };
    let first = submit(world.queue(), "first", 2);
    let ended = ["a", "b", "c"].map(|name| submit(world.queue(), name, 2));
    // The one that was submitted first ends last.
    for id in ended.into_iter().chain([first]) {
        world.queue().cancel(id, None).unwrap();
        world.pass(Duration::from_secs(1));
    }
    let running = submit(world.queue(), "running", 2);
    let is_there = |id: &JobId| world.queue().job(*id).unwrap().is_some();
    assert_eq!(ended.map(|id| is_there(&id)), [false, false, true]);
    assert!(is_there(&first) && is_there(&running), "those that have not ended do not count");
}

pub(super) fn a_start_forgets_too_and_without_a_limit_nothing_is_forgotten<W: World>() {
    let Some(mut world) = W::new(keeping(None)) else { return };
    let [cancelled, failed, running] = one_of_each(world.queue());
    world.pass(1000 * DAY);
    submit(world.queue(), "young", 2);
    world.reopen(keeping(None));
    assert!([cancelled, failed, running].iter().all(|id| world.queue().job(*id).unwrap().is_some()));
    world.reopen(keeping(Some(DAY)));
    assert_eq!(world.queue().job(cancelled).unwrap(), None);
    // It is running, or failed just now because the process ended while it was leased.
    assert!(world.queue().job(running).unwrap().is_some());
}
