//! The HTTP interface: routes, conditional downloads, event streams, problem documents.
//!
//! Invariant: `http` only translates; all other logic is in [`crate::service`]. Calls into the service run on blocking
//! threads, except [`crate::service::Service::cached_file`], which does not block.

mod access;
mod api;
mod brdfs;
mod doors;
mod error;
mod etag;
mod events;
mod exports;
mod extract;
mod file;
mod jobs;
mod kind;
mod operations;
mod origins;
mod page;
mod pictures;
mod plans;
mod problem;
mod recipes;
mod routes;
mod serve;
mod tables;
mod tls;
mod tokens;
mod views;
mod watched;

pub use origins::{AllowedHost, AllowedOrigin, Origins};
pub use routes::{ROUTES, Route};
pub use serve::{Options, serve};
pub use tls::Certificate;
pub use tokens::{Scope, TOKEN_BYTES, Token, TokenFile, Tokens};
