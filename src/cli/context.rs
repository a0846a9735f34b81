//! What `main` hands to a command, and how a command prints.

use std::{io::Write, path::Path};

use tokio::runtime::Handle;

use super::{CommandFailure, Interrupt};

/// What a command is given by `main`.
pub struct Context<'a> {
    /// Standard output.
    pub stdout: &'a mut dyn Write,
    /// Whether that is a terminal: then nothing binary goes there.
    pub stdout_is_terminal: bool,
    /// Whether standard error is a terminal: then progress is drawn there.
    pub draws_progress: bool,
    /// Told when the user wants to stop.
    pub interrupt: Interrupt,
    /// Runs the HTTP server.
    pub runtime: Handle,
}

/// A path as text for people and JSON. What is not UTF-8 in it is replaced: JSON has no other text.
pub(super) fn shown(path: &Path) -> String {
    path.display().to_string()
}

/// Prints `value` as one line of JSON, or `text` as it is.
pub(super) fn print(
    stdout: &mut dyn Write,
    json: bool,
    value: &serde_json::Value,
    text: &str,
) -> Result<(), CommandFailure> {
    let written = if json { writeln!(stdout, "{value}") } else { writeln!(stdout, "{text}") };
    written.and_then(|()| stdout.flush()).map_err(|error| CommandFailure::stdout(&error))
}
