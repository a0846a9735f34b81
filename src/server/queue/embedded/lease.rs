//! Leasing tasks, renewing leases, giving tasks back.

use std::{num::NonZeroUsize, sync::TryLockError, time::Duration};

use super::{
    record,
    state::{EmbeddedQueue, QueueState},
    task::{Task, TaskState},
};
use crate::{
    queue::{Demand, JobState, Lease, LeasedTask, Offer, StaleLease, TaskKind},
    store::Batch,
};

impl EmbeddedQueue {
    pub(super) fn lease_tasks(&self, demand: Demand, most: NonZeroUsize) -> Offer {
        let mut state = self.lock();
        if state.closed {
            return Offer::Closed;
        }
        self.remove_leftovers(&mut state);
        let tasks: Vec<LeasedTask> = (0..most.get()).map_while(|_| self.lease_next(&mut state, demand)).collect();
        if tasks.is_empty() { Offer::Nothing { seen: state.generation } } else { Offer::Tasks(tasks) }
    }

    fn lease_next(&self, state: &mut QueueState, demand: Demand) -> Option<LeasedTask> {
        let until = self.expiry();
        let (submission, number) = state.teams.next_task(&state.active, demand)?;
        let active = state.active.get_mut(&submission)?;
        let task = *active.tasks.get(number as usize)?;
        state.leases += 1;
        let name = self.first_name.wrapping_add(state.leases);
        let task = Task { attempt: task.attempt + 1, state: TaskState::Leased { until, name }, ..task };
        active.last_served = state.leases;
        active.set(number, task);
        let job = &mut active.record.job;
        let first = job.state == JobState::Queued;
        if first {
            job.state = JobState::Running;
            job.started_at = Some((self.clock.wall)());
        }
        let id = job.id;
        // A lease ends with the process. Its row only serves to count that, so the disk is waited for only while a
        // task may have ended the last process: within moments of its lease, and again and again.
        let is_careful = state.careful_until.is_some_and(|until| (self.clock.steady)() < until);
        let mut batch = Batch::default();
        let mut stored = record::put_task(&mut batch, id, number, &task);
        if first {
            stored = stored.and_then(|()| record::put_job(&mut batch, &active.record));
        }
        let write =
            |batch: &Batch| if is_careful { self.rows.commit(batch) } else { self.rows.stage(batch).map(|_| ()) };
        if let Err(error) = stored.and_then(|()| write(&batch)) {
            tracing::warn!(job = %id, task = number, %error, "the lease could not be recorded");
        }
        let leased = LeasedTask {
            lease: Lease { submission, task: number, name },
            kind: if number == active.assembly() { TaskKind::Assemble } else { TaskKind::Shard(number) },
            job: id,
            recipe: active.record.job.recipe.clone(),
            recipe_digest: active.record.job.recipe_digest,
            entries_total: active.record.job.entries_total,
        };
        let team = active.claim().team.clone();
        state.teams.pass_turn(&team);
        state.next_expiry = Some(state.next_expiry.map_or(until, |expiry| expiry.min(until)));
        state.changed_jobs.insert(id);
        Some(leased)
    }

    pub(super) fn record_progress(&self, lease: &Lease, entries_done: u64) -> Result<(), StaleLease> {
        let until = self.expiry();
        // While a change is written, work goes on: the next report comes soon.
        let mut state = match self.state.try_lock() {
            Ok(state) => state,
            Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner(),
            Err(TryLockError::WouldBlock) => return Ok(()),
        };
        self.take_back_expired(&mut state);
        state.renew(lease, until)?.report(lease.task, entries_done);
        Ok(())
    }

    /// When a lease expires that is given or renewed now.
    pub(super) fn expiry(&self) -> Duration {
        (self.clock.steady)().saturating_add(self.limits.lease_ttl)
    }
}
