//! The same recipe gives the same bytes in the command and in the service.

use crate::common::{LARGE, command::run_with_stdin, server::Server};

/// A table with every kind of entry: views from above, isotropic surfaces, folds, grazing views, and others.
const PINNED_RECIPE: &str =
    r#"{"preset":"draft","resolution":{"alpha":3,"ratio":3,"theta":4,"phi":3},"fit":{"samples":128,"seed":1}}"#;

/// Its digest on any machine and processor. When it changes on purpose, raise `FITTER_VERSION` and state the reason in
/// `CHANGELOG.md`.
const PINNED_DIGEST: &str = "sha256:2c3d0be191fa318bae02c01a19581ccfd5ffe169f39cf14adc6ab35065d221d3";

/// The same recipe with Gaussians instead of Linearly Transformed Cosines, and the digests.
const PINNED_GAUSSIANS: [(&str, &str); 2] = [
    ("sg", "sha256:3f719fc926b56fa7c427aa842ea95aee574242605683c00d634ed8b246fbf74b"),
    ("asg", "sha256:82ca1d11e86d7361f151d7fed723c6f913bb8d1e8405bb61b556b9c5c6a7dc37"),
];

fn fitted(recipe: &str) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    run_with_stdin(folder.path(), ["fit", "-"], recipe).exited(0).last_line().to_owned()
}

#[test]
fn the_bytes_of_a_small_table_are_pinned() {
    assert_eq!(fitted(PINNED_RECIPE), PINNED_DIGEST);
}

#[test]
fn the_bytes_of_small_tables_of_gaussians_are_pinned() {
    for (lobe, digest) in PINNED_GAUSSIANS {
        let recipe = PINNED_RECIPE.replacen('{', &format!(r#"{{"lobe":"{lobe}","#), 1);
        assert_eq!(fitted(&recipe), digest, "{lobe}");
    }
}

#[test]
fn threads_and_workers_do_not_change_the_bytes() {
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
