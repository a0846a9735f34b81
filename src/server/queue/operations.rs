//! The operations of a queue, whatever it is built on.

use std::{collections::BTreeSet, fmt::Debug, num::NonZeroUsize, time::Duration};

use jiff::Timestamp;

use super::{
    Demand, Failure, Job, JobId, Lease, LeaseError, NewJob, Offer, QueueError, StaleLease, StateName, Submitted,
};
use crate::store::{Batch, StoreError};
use ltcforge_files::digest::Digest;

/// A page of jobs, last submitted first, and the submission to pass as `before` to get the next one.
pub type JobPage = (Vec<Job>, Option<u64>);

/// Shards of unfinished jobs that are not finished. Assemblies do not count.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Depth {
    /// Those that no worker has.
    pub waiting: u64,
    /// Those that a worker has.
    pub leased: u64,
}

/// Durable jobs, which share the workers. All methods block.
pub trait Queue: Send + Sync + Debug {
    /// Submits a job, which is durable when this returns. A queued or running job is joined; from then on it is served as
    /// that submission's if that one's priority is higher. A job that has failed or
    /// was cancelled, or whose table `has_table` says is gone, is queued again: its attempts are counted anew, and its
    /// finished shards are kept as far as they are still stored.
    ///
    /// # Errors
    /// When the queue is full, or the job cannot be stored; then nothing has changed.
    fn submit(&self, new: NewJob, has_table: &dyn Fn(Digest) -> bool) -> Result<Submitted, QueueError>;

    /// Records a done job whose table was found in the store although the queue did not know the job. A job that is
    /// queued, running or done already stays as it is.
    ///
    /// # Errors
    /// When it cannot be stored.
    fn adopt(&self, done: Job) -> Result<Job, StoreError>;

    /// Cancels a job, durably when this returns, and voids its leases. A job in a final state stays as it is. Returns
    /// the job as it is afterwards. `by` is who cancels it.
    ///
    /// # Errors
    /// When it cannot be stored; then nothing has changed.
    fn cancel(&self, id: JobId, by: Option<&str>) -> Result<Option<Job>, StoreError>;

    /// Leases up to `most` waiting tasks. Each is of the highest priority that there is; of the team that has the fewest
    /// leased, counted in whole shares, and of such teams the one whose turn it is; of its job that has the fewest leased,
    /// and of such jobs the one that was served longest ago. So teams share the workers by their shares, a team's jobs share
    /// evenly, and a new one is served next. A team's turn passes with each lease by as much less as its share is
    /// greater. Of the tasks during which process after process ended one is leased at a time.
    fn lease(&self, demand: Demand, most: NonZeroUsize) -> Offer;

    /// Records the entries done so far and renews the lease, which need not be durable. Nothing waits for it: while the
    /// queue is writing, this may do nothing.
    ///
    /// # Errors
    /// When the lease is not the current one; the worker then stops.
    fn progress(&self, lease: &Lease, entries_done: u64) -> Result<(), StaleLease>;

    /// Stores the results of shards; those that are accepted are durable when this returns. Each has an answer of its
    /// own, in order.
    ///
    /// # Errors
    /// When they cannot be stored; then none is, and the leases are still held.
    fn complete(&self, done: &[(Lease, &[u8])]) -> Result<Vec<Result<(), StaleLease>>, StoreError>;

    /// Hands the results of all shards to `take`, in order and few at a time, for the worker that assembles. If results
    /// are lost or damaged, their shards are queued again, the assembly counts as failed, and the answer is `false`:
    /// not all were handed over.
    ///
    /// # Errors
    /// When the lease is not the current one, or the database fails.
    fn results(&self, lease: &Lease, take: &mut dyn FnMut(&[u8])) -> Result<bool, LeaseError>;

    /// Concludes a job whose table is stored; `with` is committed in the same transaction.
    ///
    /// # Errors
    /// When the lease is not the current one, or this cannot be stored.
    fn finish(&self, lease: &Lease, table: Digest, with: Batch) -> Result<(), LeaseError>;

    /// Gives a task back unfinished. This does not count as a failure.
    ///
    /// # Errors
    /// When the lease is not the current one.
    fn give_back(&self, lease: &Lease) -> Result<(), StaleLease>;

    /// Reports that a task failed. It is tried again until it has failed too often.
    ///
    /// # Errors
    /// When the lease is not the current one.
    fn fail(&self, lease: &Lease, error: &str) -> Result<(), StaleLease>;

    /// Fails the whole job of a lease, where another attempt would not help.
    ///
    /// # Errors
    /// When the lease is not the current one.
    fn abort(&self, lease: &Lease, error: Failure) -> Result<(), StaleLease>;

    /// A job by its id.
    ///
    /// # Errors
    /// When the database fails.
    fn job(&self, id: JobId) -> Result<Option<Job>, StoreError>;

    /// A job by its id, and a time by the queue's own clock at which it was so or became so later. Later calls, of any
    /// process, give later times.
    ///
    /// # Errors
    /// When the database fails.
    fn job_now(&self, id: JobId) -> Result<Option<(Job, Timestamp)>, StoreError> {
        // The time is read first, so that a job that ends in between ended later.
        let now = self.now();
        Ok(self.job(id)?.map(|job| (job, now)))
    }

    /// Up to `limit` jobs before the submission `before`, last submitted first; and the submission to pass as `before`
    /// to get the next ones.
    ///
    /// # Errors
    /// When the database fails.
    fn list(&self, wanted: Option<StateName>, before: Option<u64>, limit: usize) -> Result<JobPage, StoreError>;

    /// Number of jobs in each state.
    ///
    /// # Errors
    /// When the database fails.
    fn counts(&self) -> Result<Vec<(StateName, u64)>, StoreError>;

    /// Shards that wait and that are leased.
    ///
    /// # Errors
    /// When the database fails.
    fn depth(&self) -> Result<Depth, StoreError>;

    /// The queued or running job that was submitted first.
    ///
    /// # Errors
    /// When the database fails.
    fn first_unfinished(&self) -> Result<Option<Job>, StoreError>;

    /// Number of leases that expired and of tasks that failed, expired ones included, since the queue was opened.
    fn failures(&self) -> (u64, u64);

    /// Waits until a task may have become available since the generation `seen`, a lease expires, or the queue is
    /// closed.
    fn wait(&self, seen: u64);

    /// Waits for `time`, or until the queue is closed.
    fn pause(&self, time: Duration);

    /// Leases no more tasks and wakes all workers that wait for one. Tasks may still be completed or given back.
    fn close(&self);

    /// The jobs whose state or progress has changed since the last call.
    fn take_changed(&self) -> BTreeSet<JobId>;

    /// The time by the queue's own clock.
    fn now(&self) -> Timestamp;

    /// Whether a job is looked up in this process's own memory or files. Otherwise other processes change jobs too, and
    /// a look takes longer than a step of a fit.
    fn is_local(&self) -> bool {
        true
    }

    /// Why the queue cannot be used now, in words; `None` if it can.
    fn fault(&self) -> Option<String> {
        None
    }

    /// Whether a job is queued or running.
    ///
    /// # Errors
    /// When the database fails.
    fn is_active(&self, id: JobId) -> Result<bool, StoreError> {
        Ok(self.job(id)?.is_some_and(|job| !job.state.name().is_final()))
    }
}
