//! Runs Node.js scripts, with or without a browser. `make test` installs Node.js and the browser. Without them, the
//! tests report that they are skipped.

use std::{
    env,
    path::Path,
    process::{Command, Stdio},
};

use serde::de::DeserializeOwned;

use super::report_skipped;

/// Whether a program can be started.
pub(crate) fn starts(program: &str) -> bool {
    let mut command = Command::new(program);
    command.arg("--version").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}

/// The JSON output of a script in `folder` that needs a browser. `None` if it cannot run.
pub(crate) fn script<T: DeserializeOwned>(folder: &Path, file: &str, args: &[&str]) -> Option<T> {
    let chromium = env::var("CHROMIUM").unwrap_or_else(|_| "chromium-headless-shell".to_owned());
    if !starts(&chromium) {
        report_skipped(&format!("{chromium} is missing (Debian: chromium-headless-shell)"));
        return None;
    }
    // playwright-core needs an absolute path.
    let words = ["--ltcforge", env!("CARGO_BIN_EXE_ltcforge"), "--chromium", &which(&chromium)];
    node(folder, file, &[&words, args].concat())
}

/// The JSON output of a script in `folder` that needs no browser. `None` if it cannot run.
pub(crate) fn node<T: DeserializeOwned>(folder: &Path, file: &str, args: &[&str]) -> Option<T> {
    if !starts("node") {
        report_skipped("node is missing (Debian: nodejs)");
        return None;
    }
    if !folder.join("node_modules/.package-lock.json").exists() {
        report_skipped(&format!("packages are missing (run npm ci in {})", folder.display()));
        return None;
    }
    let mut command = Command::new("node");
    command.current_dir(folder).arg(file).args(args).stdin(Stdio::null());
    let output = command.output().expect("node runs");
    let complaints = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{file}: {complaints}");
    Some(serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{file}: {error}: {complaints}")))
}

/// The path of a program in `PATH`.
fn which(program: &str) -> String {
    let folders = env::var_os("PATH").unwrap_or_default();
    let found = env::split_paths(&folders).map(|folder| folder.join(program)).find(|path| path.is_file());
    found.map_or_else(|| program.to_owned(), |path| path.to_string_lossy().into_owned())
}
