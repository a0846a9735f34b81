//! `schemathesis` compares the service with `openapi.yaml`. It sends allowed and forbidden requests and sequences of
//! calls, and checks every response. It uses [`EXAMPLES`] or `LTCFORGE_TEST_EXAMPLES` examples per operation.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use super::brdfs::OCTETS;
use crate::common::{SMALL, command::run, report_skipped, server::Server, soak::rounds};

/// Number of examples in a short run. A short run omits sequences of calls and the bounds of ranges, which take
/// minutes.
const EXAMPLES: usize = 1;

/// The programs that `make schemathesis` installs.
fn programs() -> PathBuf {
    let target = Path::new(env!("CARGO_BIN_EXE_ltcforge")).ancestors().nth(2).expect("a folder of the build");
    target.join("schemathesis/bin")
}

#[test]
fn the_service_agrees_with_openapi() {
    let schemathesis = programs().join("schemathesis");
    if !schemathesis.exists() {
        report_skipped("there is no schemathesis of PyPI here; `make schemathesis` installs it");
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let limits = ["--adapter", "cpu", "--entry-limit", "4096", "--job-seconds", "5"];
    let server = Server::start(&folder.path().join("data"), &limits);
    let table = server.fit(SMALL);
    let made = run(folder.path(), ["tabulate", "oren_nayar", "--alpha", "0.2,1", "-o", "eon.safetensors"]).exited(0);
    let brdf = fs::read(folder.path().join("eon.safetensors")).expect("a file");
    server.request("POST", "/v1/brdfs", &[OCTETS], Some(&brdf)).with_status(201);

    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut command = Command::new(schemathesis.canonicalize().expect("a program"));
    command
        .arg("--config-file")
        .arg(here.join("tests/service/schemathesis.toml"))
        .arg("run")
        .arg(here.join("openapi.yaml"));
    command.args(["--url", &server.url, "--seed", "1", "--continue-on-failure", "--request-timeout", "60"]);
    let examples = rounds("LTCFORGE_TEST_EXAMPLES", 0);
    if examples == 0 {
        command.args(["--phases", "examples,fuzzing", "--no-shrink"]);
    }
    command.args(["--max-examples", &if examples == 0 { EXAMPLES } else { examples }.to_string()]);
    command.env("LTCFORGE_TABLE", table).env("LTCFORGE_BRDF", made.last_line()).current_dir(folder.path());
    let output = command.output().expect("it runs");
    // A failure contains the call to repeat, which can be long.
    let lines: Vec<String> =
        String::from_utf8_lossy(&output.stdout).lines().map(|line| line.chars().take(300).collect()).collect();
    assert!(output.status.success(), "{}\n{}", lines.join("\n"), String::from_utf8_lossy(&output.stderr));
    server.get("/healthz").with_status(200);
    let log = server.stop("TERM").exited(0).stderr;
    assert!(!log.contains("ERROR") && !log.contains("panicked"), "{log}");
}
