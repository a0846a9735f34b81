//! Tasks that fail, leases that expire, processes that end.

use super::{
    record,
    state::{EmbeddedQueue, QueueState},
    task::{Task, TaskState},
};
use crate::{
    queue::{Failure, FailureKind, JobState, Lease, MOST_DEATHS, StaleLease},
    store::Batch,
};

impl EmbeddedQueue {
    pub(super) fn take_back_expired(&self, state: &mut QueueState) {
        let now = (self.clock.steady)();
        if state.next_expiry.is_none_or(|expiry| now < expiry) {
            return;
        }
        let leases: Vec<_> = state.active.values().flat_map(super::active::ActiveJob::leases).collect();
        state.next_expiry = leases.iter().map(|(_, until)| *until).filter(|until| now < *until).min();
        for (lease, _) in leases.into_iter().filter(|(_, until)| *until <= now) {
            state.leases_expired += 1;
            // An error means that the job has just failed through another of its leases.
            let _ = self.fail_task(state, &lease, "the lease expired without being renewed");
        }
    }

    /// Counts a failure of a leased task. Too many failures fail the job.
    pub(super) fn fail_task(&self, state: &mut QueueState, lease: &Lease, error: &str) -> Result<(), StaleLease> {
        let (active, task) = state.current(lease)?;
        let failures = task.failures + 1;
        let (number, attempt) = (lease.task, task.attempt);
        tracing::warn!(job = %active.record.job.id, task = number, attempt, failures, error, "a task failed");
        state.failures += 1;
        let is_last = failures >= self.limits.max_attempts.get();
        let reason = is_last.then(|| format!("failed {failures} times; the last error: {error}"));
        self.put_back(state, lease, Task { failures, ..task }, reason);
        Ok(())
    }

    /// Counts the end of the process that held a lease. Too many of them fail the job.
    pub(super) fn count_death(&self, state: &mut QueueState, lease: &Lease) -> Result<(), StaleLease> {
        let (active, task) = state.current(lease)?;
        let deaths = task.deaths + 1;
        let (number, attempt) = (lease.task, task.attempt);
        let id = active.record.job.id;
        tracing::warn!(job = %id, task = number, attempt, deaths, "the process ended while the task was leased");
        let is_last = deaths >= MOST_DEATHS;
        let reason =
            is_last.then(|| format!("was being worked on each of the {deaths} times that the service's process ended"));
        self.put_back(state, lease, Task { deaths, ..task }, reason);
        Ok(())
    }

    /// Has a task wait again, or fails its job for a `reason`.
    pub(super) fn put_back(&self, state: &mut QueueState, lease: &Lease, task: Task, reason: Option<String>) {
        let Some(active) = state.active.get(&lease.submission) else { return };
        let (id, is_assembly) = (active.record.job.id, lease.task == active.assembly());
        let waiting = Task { state: TaskState::Waiting, ..task };
        self.set(state, lease, waiting);
        if let Some(reason) = reason {
            let task = if is_assembly { "the assembly".to_owned() } else { format!("shard {}", lease.task) };
            let error = Failure { kind: FailureKind::Attempts, detail: format!("{task} {reason}") };
            return self.fail_job(state, lease.submission, error);
        }
        let mut batch = Batch::default();
        let stored = record::put_task(&mut batch, id, lease.task, &waiting).and_then(|()| self.rows.stage(&batch));
        if let Err(error) = stored {
            tracing::warn!(job = %id, task = lease.task, %error, "the end of the lease could not be recorded");
        }
    }

    /// Fails a job. If that cannot be written, it is kept in memory and written with a later change.
    pub(super) fn fail_job(&self, state: &mut QueueState, submission: u64, error: Failure) {
        let Some(active) = state.active.get(&submission) else { return };
        let record = active.concluded(JobState::Failed { error }, (self.clock.wall)());
        let id = record.job.id;
        tracing::error!(job = %id, state = ?record.job.state, "the job failed");
        let mut batch = Batch::default();
        let stored = record::put_job(&mut batch, &record).and_then(|()| self.commit(state, batch));
        self.end(state, record);
        if let Err(error) = stored {
            tracing::warn!(job = %id, %error, "the failure of the job could not be written yet");
            state.unsaved.insert(submission);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::{
        num::{NonZeroU32, NonZeroUsize},
        sync::{
            Arc,
            atomic::{AtomicI64, Ordering},
        },
        time::Duration,
    };

    use super::{super::state::Clock, *};
    use crate::{
        queue::{Demand, JobId, LeasedTask, Limits, NewJob, Offer, Queue as _},
        store::memory::MemoryRows,
    };
    use ltcforge_files::digest::Digest;

    fn lease(queue: &EmbeddedQueue) -> LeasedTask {
        match queue.lease(Demand::Any, NonZeroUsize::MIN) {
            Offer::Tasks(mut tasks) => tasks.remove(0),
            other => panic!("{other:?}"),
        }
    }

    /// Somebody sets the clock of the day, or the machine is suspended, in which the steady clock stands still.
    #[test]
    fn a_wall_clock_that_is_set_ends_no_lease_and_keeps_none() {
        let (wall, steady) = (Arc::new(AtomicI64::new(1_700_000_000)), Arc::new(AtomicI64::new(0)));
        let clock = Clock { steady: Clock::at(&steady).steady, ..Clock::at(&wall) };
        let limits = Limits {
            jobs: 1,
            lease_ttl: Duration::from_secs(60),
            max_attempts: NonZeroU32::MIN,
            keep_ended: None,
            most_ended: None,
        };
        let queue = EmbeddedQueue::open(Arc::new(MemoryRows::default()), limits, clock).unwrap();
        let recipe_digest = Digest::of(b"recipe");
        let new = NewJob { recipe: "recipe".to_owned(), recipe_digest, shard_entries: vec![1, 1], by: None };
        queue.submit(new, &|_| false).unwrap();
        let [first, second] = [lease(&queue).lease, lease(&queue).lease];
        for seconds in [1_700_000_120, 1_700_000_240, 1_700_000_360, 4_000_000_000, -4_000_000_000, 0] {
            wall.store(seconds, Ordering::Relaxed);
            assert!(matches!(queue.lease(Demand::Any, NonZeroUsize::MIN), Offer::Nothing { .. }), "{seconds}");
        }
        steady.fetch_add(59, Ordering::Relaxed);
        assert_eq!((queue.progress(&first, 1), queue.failures()), (Ok(()), (0, 0)));
        steady.fetch_add(1, Ordering::Relaxed);
        assert_eq!((queue.progress(&second, 1), queue.failures()), (Err(StaleLease), (1, 1)));
    }

    #[test]
    fn only_the_current_lease_changes_a_task_and_giving_back_is_no_failure() {
        let max_attempts = NonZeroU32::new(2).unwrap();
        let limits =
            Limits { jobs: 1, lease_ttl: Duration::from_secs(60), max_attempts, keep_ended: None, most_ended: None };
        let queue = EmbeddedQueue::open(Arc::new(MemoryRows::default()), limits, Clock::system()).unwrap();
        let recipe_digest = Digest::of(b"recipe");
        let new = NewJob { recipe: "recipe".to_owned(), recipe_digest, shard_entries: vec![1], by: None };
        queue.submit(new, &|_| false).unwrap();
        let first = lease(&queue).lease;
        queue.fail(&first, "no luck").unwrap();
        let second = lease(&queue).lease;
        let stale: [Result<(), StaleLease>; 4] = [
            queue.fail(&first, "late"),
            queue.give_back(&first),
            queue.progress(&first, 1),
            queue.complete(&[(first, b"late")]).unwrap()[0],
        ];
        assert_eq!(stale, [Err(StaleLease); 4]);
        queue.give_back(&second).unwrap();
        let third = lease(&queue).lease;
        assert_eq!(queue.give_back(&second), Err(StaleLease));
        queue.fail(&third, "no luck again").unwrap();
        let job = queue.job(JobId::of_recipe(&recipe_digest)).unwrap().unwrap();
        let detail = "shard 0 failed 2 times; the last error: no luck again".to_owned();
        assert_eq!(job.state, JobState::Failed { error: Failure { kind: FailureKind::Attempts, detail } });
        assert_eq!((job.attempts, queue.failures()), (3, (0, 2)));
    }
}
