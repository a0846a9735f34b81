//! The queue of one process, with its jobs in [`crate::store::Rows`].
//!
//! Invariant: leases are not durable; they end with the process.

mod active;
mod deliver;
mod export;
mod forget;
mod jobs;
mod lease;
mod lookup;
mod queue;
mod reconcile;
mod record;
mod remains;
mod remove;
mod resume;
mod submit;
mod task;

pub use export::{StoredJob, stored_jobs, stored_results};
pub use jobs::{Clock, EmbeddedQueue};
pub use reconcile::{ReconciledJobs, reconcile};
