//! Everything that reads bytes from elsewhere, with mutated inputs: an error or a result, never a panic or a long wait.
//!
//! `LTCFORGE_TEST_FUZZ_SECONDS=60 cargo test --test fuzz` takes a minute for each target. An input that fails is written into
//! `corpus/`, where every run begins.

#[path = "../common/mod.rs"]
mod common;

mod commands;
mod files;
mod requests;
mod target;
