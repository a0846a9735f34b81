//! The command line, by its output and its exit codes.

#[path = "../common/mod.rs"]
mod common;

mod answers;
mod outputs;
mod pictures;
mod service;
mod tables;
