//! The operations of [`Queue`]; the longer ones are in other files of this folder.

use std::{cmp::Reverse, collections::BTreeSet, num::NonZeroUsize, sync::PoisonError, time::Duration};

use jiff::Timestamp;

use super::{active::ActiveJob, record::JobRecord, state::EmbeddedQueue};
use crate::{
    queue::{
        Demand, Failure, Job, JobId, JobPage, JobState, Lease, LeaseError, NewJob, Offer, Queue, QueueError,
        StaleLease, StateName, Submitted,
    },
    store::{Batch, StoreError},
};
use ltcforge_files::digest::Digest;

impl Queue for EmbeddedQueue {
    fn submit(&self, new: NewJob, has_table: &dyn Fn(Digest) -> bool) -> Result<Submitted, QueueError> {
        self.submit_job(new, has_table)
    }

    fn adopt(&self, done: Job) -> Result<Job, StoreError> {
        self.adopt_job(done)
    }

    fn cancel(&self, id: JobId, by: Option<&str>) -> Result<Option<Job>, StoreError> {
        let mut state = self.lock();
        let Some(active) = state.active_job(id) else { return Ok(state.job(id)) };
        let mut record = active.concluded(JobState::Cancelled, self.now());
        record.job.cancelled_by = by.map(str::to_owned);
        self.conclude(&mut state, record, Batch::default())?;
        Ok(state.job(id))
    }

    fn lease(&self, demand: Demand, most: NonZeroUsize) -> Offer {
        self.lease_tasks(demand, most)
    }

    fn progress(&self, lease: &Lease, entries_done: u64) -> Result<(), StaleLease> {
        self.record_progress(lease, entries_done)
    }

    fn complete(&self, done: &[(Lease, &[u8])]) -> Result<Vec<Result<(), StaleLease>>, StoreError> {
        self.complete_shards(done)
    }

    fn results(&self, lease: &Lease, take: &mut dyn FnMut(&[u8])) -> Result<bool, LeaseError> {
        self.all_results(lease, take)
    }

    fn finish(&self, lease: &Lease, table: Digest, with: Batch) -> Result<(), LeaseError> {
        let mut state = self.lock();
        let (active, _) = state.current(lease)?;
        if lease.task != active.assembly() {
            return Err(StaleLease.into());
        }
        let record = active.concluded(JobState::Done { table }, self.now());
        Ok(self.conclude(&mut state, record, with)?)
    }

    fn give_back(&self, lease: &Lease) -> Result<(), StaleLease> {
        let mut state = self.lock();
        let (_, task) = state.current(lease)?;
        self.put_back(&mut state, lease, task, None);
        Ok(())
    }

    fn fail(&self, lease: &Lease, error: &str) -> Result<(), StaleLease> {
        self.fail_task(&mut self.lock(), lease, error)
    }

    fn abort(&self, lease: &Lease, error: Failure) -> Result<(), StaleLease> {
        let mut state = self.lock();
        state.current(lease)?;
        self.fail_job(&mut state, lease.submission, error);
        Ok(())
    }

    fn job(&self, id: JobId) -> Result<Option<Job>, StoreError> {
        Ok(self.lock().job(id))
    }

    fn list(&self, wanted: Option<StateName>, before: Option<u64>, limit: usize) -> Result<JobPage, StoreError> {
        let state = self.lock();
        let earlier = ..before.unwrap_or(u64::MAX);
        let is_wanted = |record: &JobRecord| wanted.is_none_or(|wanted| record.job.state.name() == wanted);
        let active = state.active.range(earlier).rev().filter(|(_, active)| is_wanted(&active.record));
        let ended = state.ended.range(earlier).rev().filter(|(_, record)| is_wanted(record));
        let ended = ended.take(limit + 1).map(|(submission, record)| (*submission, record.job.clone()));
        let mut jobs: Vec<(u64, Job)> =
            active.map(|(submission, active)| (*submission, active.job())).chain(ended).collect();
        jobs.sort_unstable_by_key(|(submission, _)| Reverse(*submission));
        let has_more = jobs.len() > limit;
        jobs.truncate(limit);
        let next = jobs.last().map(|(submission, _)| *submission).filter(|_| has_more);
        Ok((jobs.into_iter().map(|(_, job)| job).collect(), next))
    }

    fn counts(&self) -> Result<Vec<(StateName, u64)>, StoreError> {
        let state = self.lock();
        let records = || state.active.values().map(|active| &active.record).chain(state.ended.values());
        let count = |name| records().filter(|record| record.job.state.name() == name).count() as u64;
        Ok(StateName::ALL.iter().map(|name| (*name, count(*name))).collect())
    }

    fn first_unfinished(&self) -> Result<Option<Job>, StoreError> {
        Ok(self.lock().active.values().next().map(ActiveJob::job))
    }

    fn failures(&self) -> (u64, u64) {
        let state = self.lock();
        (state.leases_expired, state.failures)
    }

    fn wait(&self, seen: u64) {
        self.wait_for_change(seen);
    }

    fn pause(&self, time: Duration) {
        let state = self.lock();
        let waited = self.changed.wait_timeout_while(state, time, |state| !state.closed);
        drop(waited.unwrap_or_else(PoisonError::into_inner));
    }

    fn close(&self) {
        let mut state = self.lock();
        state.closed = true;
        self.changed.notify_all();
    }

    fn take_changed(&self) -> BTreeSet<JobId> {
        std::mem::take(&mut self.lock().changed_jobs)
    }

    fn now(&self) -> Timestamp {
        (self.clock.wall)()
    }

    fn is_active(&self, id: JobId) -> Result<bool, StoreError> {
        Ok(self.lock().active_job(id).is_some())
    }
}
