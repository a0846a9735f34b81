//! The command line, by its output and its exit codes.

#[path = "../common/mod.rs"]
mod common;

mod pictures;
mod service;
mod tables;
