//! The operations of [`Queue`], which are spread over the files of this folder.

use std::{collections::BTreeSet, num::NonZeroUsize, sync::atomic::Ordering, time::Duration};

use jiff::Timestamp;

use super::{failing, open::PostgresQueue};
use crate::{
    queue::{
        Demand, Failure, Job, JobId, JobPage, Lease, LeaseError, NewJob, Offer, Queue, QueueError, StaleLease,
        StateName, Submitted,
    },
    store::{Batch, StoreError},
};
use ltcforge_files::digest::Digest;

impl Queue for PostgresQueue {
    fn submit(&self, new: NewJob, has_table: &dyn Fn(Digest) -> bool) -> Result<Submitted, QueueError> {
        self.shared.submit(&new, has_table)
    }

    fn adopt(&self, done: Job) -> Result<Job, StoreError> {
        self.shared.adopt(&done)
    }

    fn cancel(&self, id: JobId) -> Result<Option<Job>, StoreError> {
        self.shared.cancel(id)
    }

    fn lease(&self, worker: u32, demand: Demand, most: NonZeroUsize) -> Offer {
        self.shared.lease(worker, demand, most)
    }

    fn progress(&self, lease: &Lease, entries_done: u64) -> Result<(), StaleLease> {
        self.shared.record_progress(lease, entries_done)
    }

    fn complete(&self, done: &[(Lease, &[u8])]) -> Result<Vec<Result<(), StaleLease>>, StoreError> {
        self.shared.complete(done)
    }

    fn results(&self, lease: &Lease, take: &mut dyn FnMut(&[u8])) -> Result<bool, LeaseError> {
        self.shared.results(lease, take)
    }

    fn finish(&self, lease: &Lease, table: Digest, with: Batch) -> Result<(), LeaseError> {
        self.shared.finish(lease, table, &with)
    }

    fn give_back(&self, lease: &Lease) -> Result<(), StaleLease> {
        self.shared.give_back(lease)
    }

    fn fail(&self, lease: &Lease, error: &str) -> Result<(), StaleLease> {
        failing::fail_task(&self.shared, lease, error)
    }

    fn abort(&self, lease: &Lease, error: Failure) -> Result<(), StaleLease> {
        failing::abort(&self.shared, lease, &error)
    }

    fn job(&self, id: JobId) -> Result<Option<Job>, StoreError> {
        self.shared.job(id)
    }

    fn job_now(&self, id: JobId) -> Result<Option<(Job, Timestamp)>, StoreError> {
        self.shared.job_now(id)
    }

    fn list(&self, wanted: Option<StateName>, before: Option<u64>, limit: usize) -> Result<JobPage, StoreError> {
        self.shared.list(wanted, before, limit)
    }

    fn counts(&self) -> Result<Vec<(StateName, u64)>, StoreError> {
        self.shared.counts()
    }

    fn first_unfinished(&self) -> Result<Option<Job>, StoreError> {
        self.shared.first_unfinished()
    }

    fn failures(&self) -> (u64, u64) {
        let shared = &self.shared;
        (shared.leases_expired.load(Ordering::Relaxed), shared.failures.load(Ordering::Relaxed))
    }

    fn wait(&self, seen: u64) {
        self.shared.wait(seen);
    }

    fn pause(&self, time: Duration) {
        self.shared.pause(time);
    }

    fn close(&self) {
        self.shared.close();
    }

    fn now(&self) -> Timestamp {
        self.shared.now()
    }

    fn is_local(&self) -> bool {
        false
    }

    fn is_reachable(&self) -> bool {
        self.shared.database.is_reachable()
    }

    fn take_changed(&self) -> BTreeSet<JobId> {
        self.shared.take_changed()
    }
}
