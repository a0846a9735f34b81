//! A queued or running job in memory, from which tasks are leased.

use std::{
    collections::{BTreeMap, BTreeSet},
    time::Duration,
};

use jiff::Timestamp;

use super::{
    record::JobRecord,
    task::{Task, TaskState},
};
use crate::queue::{Claim, Depth, Job, JobState, Lease};

/// A job with its tasks. Task `n` fits shard `n`; the last task assembles the table, and can be leased only once every
/// shard is finished.
#[derive(Debug)]
pub(super) struct ActiveJob {
    pub(super) record: JobRecord,
    pub(super) tasks: Vec<Task>,
    waiting: BTreeSet<u32>,
    /// Leased tasks and the number of entries that each has reported.
    leased: BTreeMap<u32, u64>,
    entries_finished: u64,
    /// Number of the last lease of one of its tasks, of all that the queue gave; 0 before the first.
    pub(super) last_served: u64,
}

impl ActiveJob {
    /// The job of `record`; `tasks` has one state for each shard and one for the assembly.
    pub(super) fn new(record: JobRecord, tasks: Vec<Task>) -> Self {
        let mut active = Self {
            record,
            tasks: vec![Task::default(); tasks.len()],
            waiting: BTreeSet::new(),
            leased: BTreeMap::new(),
            entries_finished: 0,
            last_served: 0,
        };
        for (number, task) in (0..).zip(tasks) {
            active.set(number, task);
        }
        active
    }

    /// What it may have of the workers.
    pub(super) fn claim(&self) -> &Claim {
        &self.record.job.claim
    }

    /// Number of the assembly task.
    pub(super) fn assembly(&self) -> u32 {
        self.record.shards()
    }

    /// Sets a task and updates the counts.
    pub(super) fn set(&mut self, number: u32, task: Task) {
        let Some(slot) = self.tasks.get_mut(number as usize) else { return };
        let entries = self.record.shard_entries.get(number as usize).copied().map_or(0, u64::from);
        if slot.state == TaskState::Finished {
            self.entries_finished -= entries;
        }
        *slot = task;
        self.record.job.attempts = self.record.job.attempts.max(task.attempt);
        self.waiting.remove(&number);
        self.leased.remove(&number);
        match task.state {
            TaskState::Waiting => drop(self.waiting.insert(number)),
            TaskState::Leased { .. } => drop(self.leased.insert(number, 0)),
            TaskState::Finished => self.entries_finished += entries,
        }
    }

    /// The task to lease next, which may be a suspect one only if `with_suspects`. The assembly is last.
    pub(super) fn next_waiting(&self, with_suspects: bool) -> Option<u32> {
        let next = self.waiting.iter().copied().find(|task| with_suspects || !self.is_suspect(*task))?;
        let may_begin = next != self.assembly() || (self.waiting.len() == 1 && self.leased.is_empty());
        may_begin.then_some(next)
    }

    /// Whether one of its suspect tasks is leased.
    pub(super) fn has_suspect_leased(&self) -> bool {
        self.leased.keys().any(|task| self.is_suspect(*task))
    }

    fn is_suspect(&self, task: u32) -> bool {
        self.tasks.get(task as usize).is_some_and(Task::is_suspect)
    }

    /// How many of its tasks are leased.
    pub(super) fn tasks_leased(&self) -> usize {
        self.leased.len()
    }

    /// Its shards that wait and that are leased.
    pub(super) fn depth(&self) -> Depth {
        let (waiting, leased) =
            (self.waiting.range(..self.assembly()).count(), self.leased.range(..self.assembly()).count());
        Depth { waiting: waiting as u64, leased: leased as u64 }
    }

    /// Records how many entries of a leased shard are done.
    pub(super) fn report(&mut self, task: u32, entries: u64) {
        let most = self.record.shard_entries.get(task as usize).copied().map_or(0, u64::from);
        if let Some(done) = self.leased.get_mut(&task) {
            *done = entries.min(most);
        }
    }

    /// The current leases and the expiry of each.
    pub(super) fn leases(&self) -> impl Iterator<Item = (Lease, Duration)> + '_ {
        self.leased.keys().filter_map(|number| match *self.tasks.get(*number as usize)? {
            Task { state: TaskState::Leased { until, name }, .. } => {
                Some((Lease { submission: self.record.submission, task: *number, name }, until))
            }
            _ => None,
        })
    }

    /// The job as it is now.
    pub(super) fn job(&self) -> Job {
        let entries_done = self.entries_finished + self.leased.values().sum::<u64>();
        Job { entries_done, ..self.record.job.clone() }
    }

    /// The record of the job in a final state.
    pub(super) fn concluded(&self, state: JobState, now: Timestamp) -> JobRecord {
        let entries_done = self.entries_finished;
        let job = Job { state, entries_done, finished_at: Some(now), ..self.record.job.clone() };
        JobRecord { job, ..self.record.clone() }
    }
}
