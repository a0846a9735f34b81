//! The operations of [`Queue`], which are spread over the files of this folder.

use std::{collections::BTreeSet, num::NonZeroUsize, time::Duration};

use jiff::Timestamp;

use super::jobs::EmbeddedQueue;
use crate::{
    queue::{
        Demand, Failure, Job, JobId, JobPage, Lease, LeaseError, NewJob, Offer, Queue, QueueError, StaleLease,
        StateName, Submitted,
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

    fn cancel(&self, id: JobId) -> Result<Option<Job>, StoreError> {
        self.cancel_job(id)
    }

    fn lease(&self, worker: u32, demand: Demand, most: NonZeroUsize) -> Offer {
        self.lease_tasks(worker, demand, most)
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
        self.finish_job(lease, table, with)
    }

    fn give_back(&self, lease: &Lease) -> Result<(), StaleLease> {
        self.give_task_back(lease)
    }

    fn fail(&self, lease: &Lease, error: &str) -> Result<(), StaleLease> {
        let mut state = self.lock();
        self.fail_task(&mut state, lease.submission, lease.task, lease.attempt, error)
    }

    fn abort(&self, lease: &Lease, error: Failure) -> Result<(), StaleLease> {
        self.abort_job(lease, error)
    }

    fn job(&self, id: JobId) -> Result<Option<Job>, StoreError> {
        self.find(&self.lock(), id)
    }

    fn list(&self, wanted: Option<StateName>, before: Option<u64>, limit: usize) -> Result<JobPage, StoreError> {
        self.list_jobs(wanted, before, limit)
    }

    fn counts(&self) -> Result<Vec<(StateName, u64)>, StoreError> {
        Ok(self.count_jobs())
    }

    fn first_unfinished(&self) -> Result<Option<Job>, StoreError> {
        Ok(self.lock().active.values().next().map(super::active::ActiveJob::job))
    }

    fn failures(&self) -> (u64, u64) {
        let state = self.lock();
        (state.leases_expired, state.failures)
    }

    fn wait(&self, seen: u64) {
        self.wait_for_change(seen);
    }

    fn pause(&self, time: Duration) {
        self.pause_for(time);
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
        (self.clock)()
    }

    fn is_active(&self, id: JobId) -> Result<bool, StoreError> {
        Ok(self.lock().by_id.contains_key(&id))
    }
}
