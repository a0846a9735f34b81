//! Runs the binary to its end.

use std::{
    ffi::OsStr,
    io::Write as _,
    path::Path,
    process::{Child, Command, ExitStatus, Output, Stdio},
};

/// The result of a run of the binary.
#[derive(Debug)]
pub(crate) struct Run {
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Run {
    /// The last line of stdout.
    pub(crate) fn last_line(&self) -> &str {
        self.stdout.lines().last().unwrap_or_default()
    }

    /// The error lines of the command, without log lines.
    pub(crate) fn complaints(&self) -> Vec<&str> {
        self.stderr.lines().filter_map(|line| line.strip_prefix("ltcforge: ")).collect()
    }

    /// Checks that the run ended with `code`, and returns it.
    #[track_caller]
    pub(crate) fn exited(self, code: i32) -> Self {
        assert_eq!(self.code, Some(code), "{self:#?}");
        self
    }
}

impl From<Output> for Run {
    fn from(output: Output) -> Self {
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("the binary prints UTF-8");
        Self { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
    }
}

/// The binary in `folder`. Its environment has no ltcforge variables and no proxy.
pub(crate) fn ltcforge<A: AsRef<OsStr>>(folder: &Path, args: impl IntoIterator<Item = A>) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_ltcforge"));
    for (name, _) in std::env::vars_os() {
        let text = name.to_string_lossy().to_ascii_lowercase();
        if text.starts_with("ltcforge_") || text.ends_with("_proxy") {
            command.env_remove(name);
        }
    }
    command.current_dir(folder).args(args).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// Runs the binary in `folder` to its end.
pub(crate) fn run<A: AsRef<OsStr>>(folder: &Path, args: impl IntoIterator<Item = A>) -> Run {
    ltcforge(folder, args).output().expect("the binary runs").into()
}

/// Runs the binary with `input` on stdin.
pub(crate) fn run_with_stdin<A: AsRef<OsStr>>(folder: &Path, args: impl IntoIterator<Item = A>, input: &str) -> Run {
    let mut child = ltcforge(folder, args).stdin(Stdio::piped()).spawn().expect("the binary runs");
    // A command that rejects its arguments does not read stdin.
    let _ = child.stdin.take().expect("a pipe").write_all(input.as_bytes());
    child.wait_with_output().expect("the binary ends").into()
}

/// Sends a signal to `child`. The name is, for example, `TERM`.
pub(crate) fn signal(child: &Child, name: &str) {
    let sent: ExitStatus =
        Command::new("sh").args(["-c", &format!("kill -{name} {}", child.id())]).status().expect("a shell");
    assert!(sent.success(), "kill -{name}");
}
