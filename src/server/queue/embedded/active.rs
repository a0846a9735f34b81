//! A queued or running job in memory, from which tasks are leased.

use std::collections::{BTreeMap, BTreeSet};

use jiff::Timestamp;

use super::{record::JobRecord, task::TaskState};
use crate::queue::{Job, JobState};

/// A job with its tasks. Task `n` fits shard `n`; the last task assembles the table, and can be leased only once every
/// shard is finished.
#[derive(Debug)]
pub(super) struct ActiveJob {
    pub(super) record: JobRecord,
    pub(super) tasks: Vec<TaskState>,
    waiting: BTreeSet<u32>,
    /// Leased tasks and the number of entries that each has reported.
    leased: BTreeMap<u32, u64>,
    shards_unfinished: usize,
    entries_finished: u64,
    /// Number of the last lease of one of its tasks, of all that the queue gave; 0 before the first.
    pub(super) last_served: u64,
}

impl ActiveJob {
    /// The job of `record`; `tasks` has one state for each shard and one for the assembly.
    pub(super) fn new(record: JobRecord, tasks: Vec<TaskState>) -> Self {
        let mut active = Self {
            shards_unfinished: record.shard_entries.len(),
            record,
            waiting: BTreeSet::new(),
            leased: BTreeMap::new(),
            entries_finished: 0,
            last_served: 0,
            tasks: vec![],
        };
        active.tasks = vec![TaskState::new(); tasks.len()];
        for (task, state) in (0..).zip(tasks) {
            active.set(task, state);
        }
        active.update_assembly();
        active
    }

    /// Number of the assembly task.
    pub(super) fn assembly(&self) -> u32 {
        self.record.shards()
    }

    /// Sets the state of a task and updates the counts.
    pub(super) fn set(&mut self, task: u32, state: TaskState) {
        let Some(slot) = self.tasks.get_mut(task as usize) else { return };
        let was_finished = matches!(slot, TaskState::Finished { .. });
        self.record.job.attempts = self.record.job.attempts.max(state.attempt());
        self.waiting.remove(&task);
        self.leased.remove(&task);
        let is_shard = (task as usize) < self.record.shard_entries.len();
        match &state {
            TaskState::Waiting { .. } if is_shard => drop(self.waiting.insert(task)),
            TaskState::Leased { .. } => drop(self.leased.insert(task, 0)),
            TaskState::Waiting { .. } | TaskState::Finished { .. } => {}
        }
        let is_finished = matches!(state, TaskState::Finished { .. });
        *slot = state;
        if is_shard && is_finished != was_finished {
            let entries = u64::from(self.record.shard_entries[task as usize]);
            if is_finished {
                self.shards_unfinished -= 1;
                self.entries_finished += entries;
            } else {
                self.shards_unfinished += 1;
                self.entries_finished -= entries;
            }
        }
        self.update_assembly();
    }

    fn update_assembly(&mut self) {
        let task = self.assembly();
        let ready =
            self.shards_unfinished == 0 && matches!(self.tasks.get(task as usize), Some(TaskState::Waiting { .. }));
        if ready {
            self.waiting.insert(task);
        } else {
            self.waiting.remove(&task);
        }
    }

    /// The task to lease next, which may be a suspect one only if `with_suspects`.
    pub(super) fn next_waiting(&self, with_suspects: bool) -> Option<u32> {
        self.waiting.iter().copied().find(|task| with_suspects || !self.is_suspect(*task))
    }

    /// Whether one of its suspect tasks is leased.
    pub(super) fn has_suspect_leased(&self) -> bool {
        self.leased.keys().any(|task| self.is_suspect(*task))
    }

    fn is_suspect(&self, task: u32) -> bool {
        self.tasks.get(task as usize).is_some_and(TaskState::is_suspect)
    }

    /// How many of its tasks are leased.
    pub(super) fn tasks_leased(&self) -> usize {
        self.leased.len()
    }

    /// Records how many entries of a leased shard are done.
    pub(super) fn report(&mut self, task: u32, entries: u64) {
        let most = self.record.shard_entries.get(task as usize).copied().map_or(0, u64::from);
        if let Some(done) = self.leased.get_mut(&task) {
            *done = entries.min(most);
        }
    }

    /// Leased tasks with the attempt and the expiry of each.
    pub(super) fn leases(&self) -> impl Iterator<Item = (u32, u32, Timestamp)> + '_ {
        self.leased.keys().filter_map(|task| match self.tasks.get(*task as usize)? {
            TaskState::Leased { attempt, lease_until, .. } => Some((*task, *attempt, *lease_until)),
            TaskState::Waiting { .. } | TaskState::Finished { .. } => None,
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
