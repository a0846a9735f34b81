//! Tests all readers of foreign bytes with mutated inputs. Each input must give an error or a result, without a panic
//! or a long wait.
//!
//! `LTCFORGE_TEST_FUZZ_SECONDS=60 cargo test --test core fuzz` takes a minute per target. A failing input is written to
//! `corpus/`, and every run starts with the corpus. With `LTCFORGE_TEST_FUZZ_KEEP=1`, each input that triggers a new
//! error is also shortened and written. Use it after adding a target or changing a reader.

mod answer;
mod commands;
mod corpus;
mod files;
mod lights;
mod requests;
mod target;
mod texts;
mod watch;
