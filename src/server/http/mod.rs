//! The HTTP interface: routes, conditional downloads, event streams, problem documents.
//!
//! Invariant: `http` translates and has no logic that [`crate::server::service`] could have. Every call into the
//! service runs on a blocking thread, so that a slow disk does not delay other connections.

mod api;
mod conditional;
mod error;
mod events;
mod extract;
mod jobs;
mod kind;
mod operations;
mod pictures;
mod problem;
mod range;
mod routes;
mod serve;
mod tables;
mod views;

pub use extract::BODY_LIMIT_BYTES;
pub use routes::{ROUTES, Route};
pub use serve::serve;
