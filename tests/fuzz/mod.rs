//! Everything that reads bytes from elsewhere, with mutated inputs: an error or a result, never a panic or a long wait.
//!
//! `LTCFORGE_TEST_FUZZ_SECONDS=60 cargo test --test core fuzz` takes a minute for each target. An input that fails is written into
//! `corpus/`, where every run begins. With `LTCFORGE_TEST_FUZZ_KEEP=1` so is each that is told a fault which none was told before, as
//! short as it may be for that: the corpus was made so, and grows so with a target or a reader.

mod answer;
mod commands;
mod corpus;
mod files;
mod lights;
mod requests;
mod target;
mod texts;
mod watch;
