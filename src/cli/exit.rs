//! Exit codes, and the errors that lead to each.

use std::{fmt::Write as _, io, path::Path};

use ltcforge_client::{ClientError, LockFileError, PullError, SourcesError};
use ltcforge_files::recipe_document::{Fault, RecipeError};

/// The exit code of the process.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Exit {
    /// Done.
    Ok = 0,
    /// The command failed.
    Failed = 1,
    /// The command line, a recipe or a configuration is invalid.
    Usage = 2,
    /// A file's bytes do not have the expected digest, or are not a table.
    Mismatch = 3,
    /// No server answers.
    Unavailable = 4,
    /// The job ended without a table.
    JobFailed = 5,
    /// The user stopped the command.
    Interrupted = 130,
}

/// The failure of a command. Its message goes to standard error, as lines or as JSON. An empty message is not printed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CommandFailure {
    /// The exit code.
    pub exit: Exit,
    /// One or more lines for people.
    pub message: String,
}

impl From<Exit> for std::process::ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}

impl CommandFailure {
    /// A failure with its message.
    #[must_use]
    pub fn new(exit: Exit, message: impl Into<String>) -> Self {
        Self { exit, message: message.into() }
    }

    /// The document for standard error under `--json`, on one line.
    #[must_use]
    pub fn json(&self) -> String {
        serde_json::json!({ "error": self.message, "exit": self.exit as u8 }).to_string()
    }

    /// The user stopped the command.
    #[must_use]
    pub fn interrupted() -> Self {
        Self::new(Exit::Interrupted, "interrupted")
    }

    /// A failed write to standard output. If a reader such as `head` closed the pipe, the command has not failed.
    #[must_use]
    pub fn stdout(error: &io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::BrokenPipe => Self::new(Exit::Ok, ""),
            _ => Self::new(Exit::Failed, format!("standard output: {error}")),
        }
    }
}

/// An invalid command line, recipe or configuration.
pub(super) fn usage<E: std::fmt::Display>(reason: E) -> CommandFailure {
    CommandFailure::new(Exit::Usage, reason.to_string())
}

/// The command failed.
pub(super) fn failed(reason: impl std::fmt::Display) -> CommandFailure {
    CommandFailure::new(Exit::Failed, reason.to_string())
}

/// The file at `path` does not have the expected bytes.
pub(super) fn mismatch(path: &Path, reason: impl std::fmt::Display) -> CommandFailure {
    CommandFailure::new(Exit::Mismatch, format!("{}: {reason}", path.display()))
}

/// An error about the file at `path`, on one line.
pub(super) fn file_failure(path: &Path, error: &dyn std::fmt::Display) -> CommandFailure {
    CommandFailure::new(Exit::Failed, format!("{}: {error}", path.display()))
}

/// A failure that lists every fault of a recipe, one per line.
pub(super) fn bad_recipe(name: &Path, error: RecipeError) -> CommandFailure {
    let name = if name == Path::new("-") { "standard input".into() } else { name.to_string_lossy() };
    let message = match error {
        RecipeError::Json(detail) => format!("{name}: not JSON: {detail}"),
        RecipeError::Faults(faults) => {
            let place = |at: &Fault| if at.pointer.is_empty() { String::new() } else { format!("{}: ", at.pointer) };
            let lines = faults.iter().map(|fault| format!("{name}: {}{}", place(fault), fault.detail));
            lines.collect::<Vec<String>>().join("\n")
        }
    };
    CommandFailure::new(Exit::Usage, message)
}

impl From<ClientError> for CommandFailure {
    fn from(error: ClientError) -> Self {
        let mut message = error.to_string();
        let exit = match error {
            ClientError::BadUrl { .. } => Exit::Usage,
            ClientError::Unavailable { .. } | ClientError::Proxy { .. } => Exit::Unavailable,
            ClientError::Mismatch { .. } | ClientError::TooShort { .. } | ClientError::LongerThanStated { .. } => {
                Exit::Mismatch
            }
            ClientError::Refused { faults, .. } if !faults.is_empty() => {
                for fault in faults {
                    // Writing to a String cannot fail.
                    let _ = write!(message, "\n{}: {}", fault.pointer, fault.detail);
                }
                Exit::Usage
            }
            _ => Exit::Failed,
        };
        Self::new(exit, message)
    }
}

impl From<PullError> for CommandFailure {
    fn from(error: PullError) -> Self {
        match error {
            PullError::Sources(error) => error.into(),
            PullError::File { .. } => failed(error),
            PullError::Size { .. } | PullError::Drift { .. } => Self::new(Exit::Mismatch, error.to_string()),
            PullError::Place { .. } => usage(error),
        }
    }
}

impl From<SourcesError> for CommandFailure {
    /// The most serious error decides the exit code: wrong bytes first, then a server that is unavailable.
    fn from(error: SourcesError) -> Self {
        let message = error.to_string();
        match error {
            SourcesError::NoneHasIt(errors) => {
                let exits: Vec<Exit> = errors.into_iter().map(|error| Self::from(error).exit).collect();
                let mut gravest = [Exit::Mismatch, Exit::Unavailable, Exit::Usage].into_iter();
                Self::new(gravest.find(|exit| exits.contains(exit)).unwrap_or(Exit::Failed), message)
            }
            SourcesError::Write(_) => failed(message),
            SourcesError::Stopped => Self::interrupted(),
        }
    }
}

/// An error about the lock file at `path`.
pub(super) fn lock_failure(path: &Path, error: &LockFileError) -> CommandFailure {
    let exit = match error {
        LockFileError::Read { .. } => Exit::Failed,
        LockFileError::RecipeDigest { .. } => Exit::Mismatch,
        _ => Exit::Usage,
    };
    CommandFailure::new(exit, format!("{}: {error}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use ltcforge_files::{digest::Digest, recipe_document::Fault};

    #[test]
    fn each_client_error_has_its_exit_code() {
        let url = || "http://h".to_owned();
        let fault = Fault { pointer: "/x".into(), detail: "unknown field".into() };
        let refused = |status, faults| ClientError::Refused { url: url(), status, detail: "no".into(), faults };
        let digest = Digest::of(b"");
        let cases = [
            (ClientError::Unavailable { url: url(), reason: "x".into() }, 4),
            (ClientError::Proxy { url: url(), proxy: "p:80".into(), reason: "x".into() }, 4),
            (ClientError::Mismatch { url: url(), expected: digest, actual: digest }, 3),
            (refused(422, vec![fault]), 2),
            (refused(404, vec![]), 1),
            (ClientError::Unexpected { url: url(), reason: "x".into() }, 1),
            (ClientError::TooLong { url: url(), limit_bytes: 1 }, 1),
            (ClientError::LongerThanStated { url: url(), stated_bytes: 1 }, 3),
            (ClientError::TooShort { url: url(), bytes: 1, stated_bytes: 2 }, 3),
            (ClientError::BadUrl { text: url(), reason: "x" }, 2),
            (ClientError::Unreadable { place: "p".into(), reason: "x".into() }, 1),
        ];
        for (error, code) in cases {
            let shown = error.to_string();
            assert_eq!(CommandFailure::from(error).exit as u8, code, "{shown}");
        }
    }

    #[test]
    fn wrong_bytes_decide_the_exit_code_of_several_sources() {
        let unavailable = || ClientError::Unavailable { url: "a".into(), reason: "x".into() };
        let unreadable = || ClientError::Unreadable { place: "b".into(), reason: "y".into() };
        let digest = Digest::of(b"");
        let wrong = || ClientError::Mismatch { url: "c".into(), expected: digest, actual: digest };
        let exit = |errors| CommandFailure::from(SourcesError::NoneHasIt(errors)).exit as u8;
        assert_eq!(exit(vec![unavailable(), unreadable(), wrong()]), 3);
        assert_eq!(exit(vec![unreadable(), unavailable()]), 4);
        assert_eq!(exit(vec![unreadable()]), 1);
        let message = CommandFailure::from(SourcesError::NoneHasIt(vec![unavailable(), unreadable()])).message;
        assert!(message.starts_with("a: ") && message.ends_with("; b: y"), "{message}");
        assert_eq!(exit(vec![]), 1);
    }

    #[test]
    fn every_fault_of_a_recipe_is_reported() {
        let fault = |pointer: &str| Fault { pointer: pointer.into(), detail: "bad".into() };
        let refused = bad_recipe(Path::new("r.json"), RecipeError::Faults(vec![fault("/a"), fault("/b")]));
        assert_eq!(refused.message, "r.json: /a: bad\nr.json: /b: bad");
        assert_eq!(refused.exit, Exit::Usage);
    }

    #[test]
    fn every_fault_has_its_own_line() {
        let fault = |pointer: &str| Fault { pointer: pointer.into(), detail: "bad".into() };
        let faults = vec![fault("/a"), fault("/b")];
        let error = ClientError::Refused { url: "u".into(), status: 422, detail: "2 faults".into(), faults };
        assert_eq!(CommandFailure::from(error).message, "u: 2 faults (422)\n/a: bad\n/b: bad");
    }

    #[test]
    fn a_failure_is_one_line_of_json() {
        let failure = CommandFailure::new(Exit::Usage, "a\n«b»");
        assert_eq!(failure.json(), r#"{"error":"a\n«b»","exit":2}"#);
    }

    #[test]
    fn a_reader_that_closes_the_pipe_is_not_a_failure() {
        assert_eq!(CommandFailure::stdout(&io::ErrorKind::BrokenPipe.into()).exit, Exit::Ok);
        assert_eq!(CommandFailure::stdout(&io::ErrorKind::StorageFull.into()).exit, Exit::Failed);
    }
}
