//! All jobs and tasks in memory. This module does not write to the database.

use std::{
    collections::{BTreeMap, BTreeSet, HashMap, VecDeque},
    hash::{BuildHasher as _, RandomState},
    time::Duration,
};

use jiff::Timestamp;

use super::record::{Entry, Task, TaskState};
use crate::queue::{
    Depth, Failure, Job, JobId, JobPage, JobState, Lease, LeasedTask, Limits, MOST_FAILURES, MOST_LEASES, StaleLease,
    StateName, Statistics, TaskKind, failed_often, leased_often, order,
};
use ltcforge_files::digest::Digest;

/// Maximum number of ended jobs that one write removes.
const MOST_FORGOTTEN: usize = 256;

/// A job that is marked to fail with the next write, and the failure.
pub(super) type Doomed = (u64, Failure);

#[derive(Debug, Default)]
pub(super) struct State {
    /// Jobs by submission.
    pub(super) jobs: BTreeMap<u64, Entry>,
    pub(super) by_id: HashMap<JobId, u64>,
    by_table: HashMap<Digest, u64>,
    /// Unfinished jobs.
    pub(super) active: BTreeSet<u64>,
    /// Ended jobs by the time of their end.
    ended: BTreeSet<(Timestamp, u64)>,
    /// Waiting tasks: tag, submission, task.
    waiting: BTreeSet<(i64, u64, u32)>,
    /// Leased tasks: submission, task.
    leased: BTreeSet<(u64, u32)>,
    /// Jobs that fail with the next write.
    pub(super) doomed: VecDeque<Doomed>,
    pub(super) last_submission: u64,
    last_lease: u64,
    pub(super) is_closed: bool,
    /// Number of expired leases, and of reported failures.
    pub(super) failures: (u64, u64),
}

impl State {
    /// A state without jobs. Lease numbers start at a random number, so leases of an earlier process are not valid.
    pub(super) fn new() -> Self {
        Self { last_lease: RandomState::new().hash_one(()) >> 1, ..Self::default() }
    }

    /// The job with this id.
    pub(super) fn find(&self, id: JobId) -> Option<&Entry> {
        self.by_id.get(&id).and_then(|submission| self.jobs.get(submission))
    }

    /// The virtual time of the [order], in microseconds; `None` if there are no unfinished jobs.
    pub(super) fn virtual_time(&self) -> Option<i64> {
        let start = |(submission, number): (u64, u32)| {
            let entry = self.jobs.get(&submission)?;
            let microseconds = entry.record.shards.get(number as usize).map_or(0, order::microseconds);
            Some(entry.tasks.get(number as usize)?.tag - microseconds)
        };
        let first = || self.waiting.first().and_then(|(_, submission, number)| start((*submission, *number)));
        let bases =
            self.active.iter().filter_map(|submission| self.jobs.get(submission)).map(|entry| entry.record.base);
        self.leased.iter().copied().filter_map(start).max().or_else(first).max(bases.max())
    }

    /// Whether no task waits.
    pub(super) fn is_idle(&self) -> bool {
        self.waiting.is_empty()
    }

    /// Adds a job, or replaces it.
    pub(super) fn insert(&mut self, entry: Entry) {
        let (submission, job) = (entry.record.submission, &entry.record.job);
        if let Some(old) = self.by_id.get(&job.id).copied() {
            self.remove(old);
        }
        self.by_id.insert(job.id, submission);
        self.last_submission = self.last_submission.max(submission);
        if let JobState::Done { table } = job.state {
            self.by_table.insert(table, submission);
        }
        if job.state.name().is_final() {
            self.ended.insert((job.finished_at.unwrap_or(job.created_at), submission));
        } else {
            self.active.insert(submission);
            let waiting = (0..).zip(&entry.tasks).filter(|(_, task)| task.state == TaskState::Waiting);
            self.waiting.extend(waiting.map(|(number, task)| (task.tag, submission, number)));
        }
        self.jobs.insert(submission, entry);
    }

    /// Removes a job and its leases.
    pub(super) fn remove(&mut self, submission: u64) {
        let Some(entry) = self.jobs.remove(&submission) else { return };
        let job = &entry.record.job;
        self.by_id.remove(&job.id);
        self.active.remove(&submission);
        self.ended.remove(&(job.finished_at.unwrap_or(job.created_at), submission));
        if let JobState::Done { table } = job.state
            && self.by_table.get(&table) == Some(&submission)
        {
            self.by_table.remove(&table);
        }
        for (number, task) in (0..).zip(&entry.tasks) {
            self.waiting.remove(&(task.tag, submission, number));
            self.leased.remove(&(submission, number));
        }
    }

    /// Sets the state of a task, and updates the sets of waiting and leased tasks.
    pub(super) fn set(&mut self, submission: u64, number: u32, state: TaskState) {
        let Some(task) = self.jobs.get_mut(&submission).and_then(|entry| entry.tasks.get_mut(number as usize)) else {
            return;
        };
        task.state = state;
        let waiting = (task.tag, submission, number);
        self.waiting.remove(&waiting);
        self.leased.remove(&(submission, number));
        match state {
            TaskState::Waiting => drop(self.waiting.insert(waiting)),
            TaskState::Leased { .. } => drop(self.leased.insert((submission, number))),
            TaskState::Blocked | TaskState::Finished => {}
        }
    }

    /// The task of a lease and its kind, if the lease is current.
    pub(super) fn current(&mut self, lease: &Lease) -> Result<(TaskKind, &mut Task), StaleLease> {
        let entry = self.jobs.get_mut(&lease.submission).ok_or(StaleLease)?;
        let kind = entry.kind(lease.task);
        let task = entry.tasks.get_mut(lease.task as usize).ok_or(StaleLease)?;
        match task.state {
            TaskState::Leased { number, .. } if number == lease.number => Ok((kind, task)),
            _ => Err(StaleLease),
        }
    }

    /// Leases up to `most` waiting tasks.
    pub(super) fn lease(&mut self, most: usize, until: Duration, now: Timestamp) -> Vec<LeasedTask> {
        let first: Vec<_> = self.waiting.iter().take(most).copied().collect();
        let mut leased = Vec::with_capacity(first.len());
        for (_, submission, task) in first {
            self.last_lease += 1;
            let number = self.last_lease;
            self.set(submission, task, TaskState::Leased { number, until, entries: 0 });
            let Some(entry) = self.jobs.get_mut(&submission) else { continue };
            entry.tasks[task as usize].leases += 1;
            let kind = entry.kind(task);
            let job = &mut entry.record.job;
            if job.state == JobState::Queued {
                job.state = JobState::Running;
                job.started_at = Some(now);
            }
            leased.push(LeasedTask {
                lease: Lease { submission, task, number },
                kind,
                job: job.id,
                recipe: job.recipe.clone(),
                recipe_digest: job.recipe_digest,
            });
        }
        leased
    }

    /// Sets tasks whose lease has expired at `now` back to waiting.
    pub(super) fn put_back_expired(&mut self, now: Duration) {
        let leased: Vec<_> = self.leased.iter().copied().collect();
        for (submission, number) in leased {
            let Some(entry) = self.jobs.get(&submission) else { continue };
            let task = entry.tasks[number as usize];
            if matches!(task.state, TaskState::Leased { until, .. } if until <= now) {
                tracing::warn!(job = %entry.record.job.id, task = number, "a lease expired");
                self.failures.0 += 1;
                self.put_back(submission, number, None);
            }
        }
    }

    /// Sets a leased task back to waiting, with the error that its worker reported. After too many leases or failures,
    /// the job is doomed.
    pub(super) fn put_back(&mut self, submission: u64, number: u32, error: Option<&str>) {
        let Some(entry) = self.jobs.get_mut(&submission) else { return };
        let kind = entry.kind(number);
        let task = &mut entry.tasks[number as usize];
        task.failures += u32::from(error.is_some());
        let failure = match error {
            Some(error) if task.failures >= MOST_FAILURES => Some(failed_often(kind, task.failures, error)),
            _ if task.leases >= MOST_LEASES => Some(leased_often(kind, task.leases)),
            _ => None,
        };
        match failure {
            Some(failure) => self.doom(submission, number, failure),
            None => self.set(submission, number, TaskState::Waiting),
        }
    }

    /// Marks the job of a task so that it fails with the next write.
    pub(super) fn doom(&mut self, submission: u64, task: u32, failure: Failure) {
        self.set(submission, task, TaskState::Blocked);
        self.doomed.push_back((submission, failure));
    }

    /// Sets a shard to finished. The last shard sets the assembly to waiting.
    pub(super) fn finish_shard(&mut self, submission: u64, shard: u32) {
        self.set(submission, shard, TaskState::Finished);
        let Some(entry) = self.jobs.get_mut(&submission) else { return };
        entry.unfinished -= 1;
        if entry.unfinished == 0 {
            let assembly = entry.record.shards.len() as u32;
            self.set(submission, assembly, TaskState::Waiting);
        }
    }

    /// Sets shards with lost results back to waiting, and the assembly to blocked.
    pub(super) fn lose(&mut self, submission: u64, shards: &[u32]) {
        for shard in shards {
            self.set(submission, *shard, TaskState::Waiting);
        }
        let Some(entry) = self.jobs.get_mut(&submission) else { return };
        entry.unfinished += shards.len();
        let assembly = entry.record.shards.len() as u32;
        self.set(submission, assembly, TaskState::Blocked);
    }

    /// Up to [`MOST_FORGOTTEN`] ended jobs that exceed the limits and should be removed.
    pub(super) fn forgettable(&self, limits: &Limits, now: Timestamp) -> Vec<u64> {
        let too_many = self.ended.len().saturating_sub(limits.most_ended.unwrap_or(usize::MAX));
        let is_old = |ended: Timestamp| {
            limits.keep_ended.is_some_and(|keep| now.duration_since(ended).unsigned_abs() > keep && ended < now)
        };
        let ended = self.ended.iter().enumerate();
        let old = ended.take_while(|(n, (ended, _))| *n < too_many || is_old(*ended));
        old.map(|(_, (_, submission))| *submission).take(MOST_FORGOTTEN).collect()
    }

    /// The job that made a table.
    pub(super) fn job_of_table(&self, table: Digest) -> Option<Job> {
        self.by_table.get(&table).and_then(|submission| self.jobs.get(submission)).map(Entry::job)
    }

    /// A page of jobs.
    pub(super) fn list(&self, wanted: Option<StateName>, before: Option<u64>, limit: usize) -> JobPage {
        let jobs = self.jobs.range(..before.unwrap_or(u64::MAX)).rev();
        let mut jobs = jobs.filter(|(_, entry)| wanted.is_none_or(|name| name == entry.record.job.state.name()));
        let page: Vec<_> = jobs.by_ref().take(limit).collect();
        let next = page.last().map(|(submission, _)| **submission).filter(|_| jobs.next().is_some());
        (page.into_iter().map(|(_, entry)| entry.job()).collect(), next)
    }

    /// The load of the queue.
    pub(super) fn statistics(&self) -> Statistics {
        let mut jobs = StateName::ALL.map(|name| (name, 0));
        for entry in self.jobs.values() {
            let name = entry.record.job.state.name();
            jobs.iter_mut().filter(|(of, _)| *of == name).for_each(|(_, count)| *count += 1);
        }
        let (mut depth, mut core_seconds) = (Depth::default(), 0.0);
        let active = || self.active.iter().filter_map(|submission| self.jobs.get(submission));
        for (task, shard) in active().flat_map(|entry| entry.tasks.iter().zip(&entry.record.shards)) {
            match task.state {
                TaskState::Finished => continue,
                TaskState::Leased { .. } => depth.leased += 1,
                TaskState::Blocked | TaskState::Waiting => depth.waiting += 1,
            }
            core_seconds += order::microseconds(shard) as f64 * 1e-6;
        }
        let oldest = active().next().map(|entry| entry.record.job.created_at);
        Statistics { jobs: jobs.to_vec(), depth, core_seconds, oldest }
    }
}
