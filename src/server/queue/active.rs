//! A job that waits or runs, in memory: what is leased from.

use std::collections::{BTreeMap, BTreeSet};

use jiff::Timestamp;

use super::{Job, JobState, record::JobRecord, step::StepState};

/// A job with its steps. Step `n` below the number of shards is shard `n`; the last step assembles the table and is
/// waiting only while every shard is finished.
#[derive(Debug)]
pub(super) struct Active {
    pub(super) record: JobRecord,
    pub(super) steps: Vec<StepState>,
    waiting: BTreeSet<u32>,
    /// Leased steps and the entries that each has reported.
    leased: BTreeMap<u32, u64>,
    shards_unfinished: usize,
    entries_finished: u64,
}

impl Active {
    /// The job of `record`; `steps` has one state for each shard, and one for the assembling.
    pub(super) fn new(record: JobRecord, steps: Vec<StepState>) -> Self {
        let mut active = Self {
            shards_unfinished: record.shard_entries.len(),
            record,
            waiting: BTreeSet::new(),
            leased: BTreeMap::new(),
            entries_finished: 0,
            steps: vec![],
        };
        active.steps = vec![StepState::new(); steps.len()];
        for (step, state) in (0..).zip(steps) {
            active.set(step, state);
        }
        active.wake_assembly();
        active
    }

    /// The step that assembles.
    pub(super) fn assembly(&self) -> u32 {
        self.record.shards()
    }

    /// Sets the state of a step and keeps the sums right.
    pub(super) fn set(&mut self, step: u32, state: StepState) {
        let Some(slot) = self.steps.get_mut(step as usize) else { return };
        let was_finished = matches!(slot, StepState::Finished { .. });
        self.record.job.attempts = self.record.job.attempts.max(state.attempt());
        self.waiting.remove(&step);
        self.leased.remove(&step);
        let is_shard = (step as usize) < self.record.shard_entries.len();
        match &state {
            StepState::Waiting { .. } if is_shard => drop(self.waiting.insert(step)),
            StepState::Leased { .. } => drop(self.leased.insert(step, 0)),
            StepState::Waiting { .. } | StepState::Finished { .. } => {}
        }
        let is_finished = matches!(state, StepState::Finished { .. });
        *slot = state;
        if is_shard && is_finished != was_finished {
            let entries = u64::from(self.record.shard_entries[step as usize]);
            if is_finished {
                self.shards_unfinished -= 1;
                self.entries_finished += entries;
            } else {
                self.shards_unfinished += 1;
                self.entries_finished -= entries;
            }
        }
        self.wake_assembly();
    }

    fn wake_assembly(&mut self) {
        let step = self.assembly();
        let ready =
            self.shards_unfinished == 0 && matches!(self.steps.get(step as usize), Some(StepState::Waiting { .. }));
        if ready {
            self.waiting.insert(step);
        } else {
            self.waiting.remove(&step);
        }
    }

    /// The step to lease next.
    pub(super) fn next_waiting(&self) -> Option<u32> {
        self.waiting.first().copied()
    }

    /// Notes how many entries a leased shard has done.
    pub(super) fn report(&mut self, step: u32, entries: u64) {
        let most = self.record.shard_entries.get(step as usize).copied().map_or(0, u64::from);
        if let Some(done) = self.leased.get_mut(&step) {
            *done = entries.min(most);
        }
    }

    /// Leased steps with their attempts, expiry and worker.
    pub(super) fn leases(&self) -> impl Iterator<Item = (u32, u32, Timestamp)> + '_ {
        self.leased.keys().filter_map(|step| match self.steps.get(*step as usize)? {
            StepState::Leased { attempt, lease_until, .. } => Some((*step, *attempt, *lease_until)),
            StepState::Waiting { .. } | StepState::Finished { .. } => None,
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
