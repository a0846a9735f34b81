//! The queue of any number of processes, in PostgreSQL.
//!
//! Invariant: leases expire by the database's clock alone, and nothing is written under a lease that is not the
//! current one, whatever the processes believe. A notification may be lost without harm: each process also asks now and
//! then.
//!
//! Transactions that change a job lock its row first and its tasks after that.

mod blocks;
mod changes;
mod deliver;
mod failing;
mod fence;
mod held;
mod import;
mod jobs;
mod lease;
mod listen;
mod queue;
mod stuck;
mod submit;
#[cfg(test)]
mod tests;

pub use queue::{PostgresQueue, Process};
