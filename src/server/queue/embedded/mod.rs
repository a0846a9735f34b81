//! The queue of one process.
//!
//! Its jobs are in memory, and a change of one is durable before it can be seen. The rows of [`crate::store::Rows`]
//! are read when the queue is opened, but for the results of shards.
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

pub use record::{JobRecord, stored_jobs, stored_results};
pub use state::{Clock, EmbeddedQueue};
