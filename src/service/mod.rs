//! The use cases: submit, work, download.

mod api;

pub use api::*;
