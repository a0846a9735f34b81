//! The HTTP interface: routes, conditional downloads, event streams, problem documents.
//!
//! Invariant: `http` translates and has no logic that [`crate::service`] could have. Every call into the
//! service runs on a blocking thread, so that a slow disk does not delay other connections; but for one that looks at the
//! metadata of a file, [`crate::service::Service::known`].

mod absent;
mod access;
mod api;
mod brdfs;
mod certificates;
mod coding;
mod conditional;
mod connection;
mod download;
mod error;
mod events;
mod exports;
mod extract;
mod file;
mod jobs;
mod kind;
mod light_textures;
mod limits;
mod operations;
mod origin_policy;
mod page;
mod pictures;
mod pins;
mod plans;
mod problem;
mod recipes;
mod request_id;
mod routes;
mod security_fields;
mod seen;
mod serve;
mod tables;
mod views;

pub use access::{KeptToken, Scope, Standing, TOKEN_BYTES, TokenFileError, Tokens, WatchedTokens};
pub use certificates::{CertificateError, Certificates};
pub use extract::BODY_LIMIT_BYTES;
pub use limits::ConnectionLimits;
pub use origin_policy::{AllowedHost, AllowedOrigin, OriginPolicy};
pub use routes::{ROUTES, Route};
pub use serve::{Options, serve};
