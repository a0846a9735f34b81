//! The same recipe gives the same bytes, whoever fits it.

use crate::common::{LARGE, command::run_with_stdin, server::Server};

/// A table with every kind of entry: seen from above, isotropic, on the folds, grazing, and in between.
const PINNED_RECIPE: &str =
    r#"{"preset":"draft","resolution":{"alpha":3,"ratio":3,"theta":4,"phi":3},"fit":{"samples":128,"seed":1}}"#;

/// Its digest, on any machine and for any processor. When it changes on purpose, raise `FITTER_VERSION` and say why
/// in `CHANGELOG.md`.
const PINNED_DIGEST: &str = "sha256:2c3d0be191fa318bae02c01a19581ccfd5ffe169f39cf14adc6ab35065d221d3";

#[test]
fn the_bytes_of_a_small_table_are_pinned() {
    let folder = tempfile::tempdir().expect("a folder");
    let fitted = run_with_stdin(folder.path(), ["fit", "-"], PINNED_RECIPE).exited(0);
    assert_eq!(fitted.last_line(), PINNED_DIGEST);
}

#[test]
fn threads_and_workers_change_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let fit = |threads: &str| {
        let run = run_with_stdin(folder.path(), ["fit", "-", "-o", threads, "--threads", threads], LARGE).exited(0);
        run.last_line().to_owned()
    };
    let one = fit("1");
    assert_eq!(fit("2"), one);
    for workers in ["1", "2", "3"] {
        let server = Server::start(&folder.path().join("data").join(workers), &["--workers", workers]);
        assert_eq!(server.fit(LARGE), one, "{workers} workers");
    }
}
