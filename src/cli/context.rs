//! The context that `main` passes to a command, and printing.

use std::{io::Write, path::Path};

use tokio::runtime::Handle;

use super::{CommandFailure, Exit, Interrupt};

/// The context of a command, created by `main`.
pub struct Context<'a> {
    /// Standard output.
    pub stdout: &'a mut dyn Write,
    /// Whether to print JSON, one document per line.
    pub json: bool,
    /// Whether standard output is a terminal. Commands never write binary data to a terminal.
    pub stdout_is_terminal: bool,
    /// Whether standard error is a terminal. Progress is drawn only there.
    pub draws_progress: bool,
    /// Set when the user wants to stop.
    pub interrupt: Interrupt,
    /// Runs the HTTP server.
    pub runtime: Handle,
}

impl Context<'_> {
    /// Prints `value` as one line of JSON, or `text` as it is.
    pub(super) fn print(&mut self, value: &serde_json::Value, text: &str) -> Result<Exit, CommandFailure> {
        let written = if self.json { writeln!(self.stdout, "{value}") } else { writeln!(self.stdout, "{text}") };
        written.and_then(|()| self.stdout.flush()).map_err(|error| CommandFailure::stdout(&error))?;
        Ok(Exit::Ok)
    }
}

/// A path as text for people and JSON. Bytes that are not UTF-8 are replaced, because JSON is always UTF-8.
pub(super) fn shown(path: &Path) -> String {
    path.display().to_string()
}
