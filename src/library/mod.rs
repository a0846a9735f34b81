//! What a Rust program calls: fits on all cores, tables kept in a folder, and one error for all of it.
//!
//! Invariant: nothing here decides anything about a table; it only calls the layers below.

mod error;
mod fitting;
mod tables;

pub use error::Error;
pub use fitting::{Fit, fit};
pub use tables::{cached, write_table};
