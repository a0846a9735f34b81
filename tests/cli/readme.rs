//! Runs the commands of the README, as written and in their order.

use std::{os::unix::fs::symlink, path::Path};

use crate::common::{
    browser::starts,
    documents::{commands, shell},
    report_skipped,
    server::Server,
};

/// Commands that do not run here, by their first words. They build the program, run all tests, or start the service,
/// which is already running.
const EXCEPT: [&str; 3] = ["make ", "cargo ", "ltcforge serve"];

/// The address of the service in the README. The service of this test has a free port instead.
const ADDRESS: &str = "http://127.0.0.1:8317";

/// At least one file that each section writes.
const FILES: [&str; 8] = [
    "sphere.png",
    "engine/ltc.js",
    "textures/ltc_terms.ktx2",
    "ltc.glsl",
    "plan/recipe.json",
    "assets/ltc/ltc_terms.ktx2",
    "ltcforge.lock",
    "ltc_formula.glsl",
];

#[test]
fn the_commands_of_the_readme_run() {
    for program in ["curl", "jq"] {
        if !starts(program) {
            return report_skipped(&format!("there is no {program}"));
        }
    }
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    // The README uses a scene from the tests.
    symlink(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests"), here.join("tests")).expect("a link");
    let server = Server::start(&here.join("ltcforge-data"), &[]);
    let commands = commands("README.md", &EXCEPT);
    assert!(commands.contains(ADDRESS), "{commands}");
    let printed = shell(here, &commands.replace(ADDRESS, &server.url));
    assert!(printed.contains(r#""state":"done""#), "the last event of the job: {printed}");
    for file in FILES {
        assert!(here.join(file).is_file(), "{file}: {printed}");
    }
}
