//! The common part of the end-to-end tests. They use the real binary and real HTTP, and check every response against
//! `openapi.yaml`.
#![allow(dead_code, reason = "each test file uses its own part")]

pub(crate) mod browser;
pub(crate) mod command;
pub(crate) mod documents;
pub(crate) mod folder;
pub(crate) mod openapi;
pub(crate) mod server;
pub(crate) mod soak;

use std::{
    io::{Write as _, stderr},
    time::{Duration, Instant},
};

/// A recipe with sixteen entries. They take milliseconds.
pub(crate) const SMALL: &str = r#"{"preset":"draft","resolution":{"alpha":2,"ratio":2,"theta":2,"phi":2},
    "fit":{"samples":64,"directions":4,"steps":5}}"#;

/// [`SMALL`] with another seed.
pub(crate) fn seeded(seed: u32) -> String {
    SMALL.replace(r#""steps":5"#, &format!(r#""steps":5,"seed":{seed}"#))
}

/// A recipe with several shards. It takes a few seconds.
pub(crate) const LARGE: &str = r#"{"preset":"draft","resolution":{"alpha":8,"ratio":8,"theta":8,"phi":4},
    "fit":{"samples":128,"directions":8,"steps":8}}"#;

/// A recipe with so many entries that no test waits for it.
pub(crate) const ENDLESS: &str = r#"{"preset":"best","resolution":{"alpha":16,"ratio":16,"theta":16,"phi":16}}"#;

/// The longest wait for a condition. It only ends tests that hang, and does not measure time.
pub(crate) const DEADLINE: Duration = Duration::from_secs(400);

/// Reports that the current test skips something, with the reason. It writes directly to standard error, because the
/// harness would capture a print.
pub(crate) fn report_skipped(reason: &str) {
    let name = std::thread::current().name().unwrap_or_default().to_owned();
    // A failed print should not fail the test.
    let _ = stderr().write_all(format!("\n*** SKIPPED: {name}: {reason}\n\n").as_bytes());
}

/// Calls `look` again and again until it returns a value.
pub(crate) fn eventually<T>(what: &str, mut look: impl FnMut() -> Option<T>) -> T {
    let start = Instant::now();
    loop {
        if let Some(found) = look() {
            return found;
        }
        assert!(start.elapsed() < DEADLINE, "timed out waiting for {what}");
        std::thread::sleep(Duration::from_millis(10));
    }
}
