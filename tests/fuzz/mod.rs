//! Tests of all readers of foreign bytes with mutated inputs. Each input gives an error or a result, never a panic or a
//! long wait.
//!
//! `LTCFORGE_TEST_FUZZ_SECONDS=60 cargo test --test core fuzz` takes a minute for each target. An input that fails is
//! written into `corpus/`, and every run begins with the corpus. With `LTCFORGE_TEST_FUZZ_KEEP=1` each input that
//! triggers a new error is also shortened and written. Run it after adding a target or changing a reader.

mod answer;
mod commands;
mod corpus;
mod files;
mod lights;
mod requests;
mod target;
mod texts;
mod watch;
