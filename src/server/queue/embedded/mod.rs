//! The queue of one process.
//!
//! All jobs are in memory. [`crate::store::Rows`] has them on the disk, with the states and results of tasks; a
//! change of a job is durable before it can be seen.
//!
//! Invariant: leases are not durable; they end with the process.

mod active;
mod deliver;
mod failing;
mod forget;
mod lease;
mod queue;
mod record;
mod resume;
mod state;
mod submit;
mod task;
mod teams;

pub use record::{JobRecord, stored_jobs, stored_results};
pub use state::{Clock, EmbeddedQueue};
