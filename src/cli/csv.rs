//! Lines of CSV, from a file or standard input, one after another.

use std::{
    fs::File,
    io::{self, BufRead, BufReader},
    path::Path,
};

use super::{CommandFailure, Exit, file_failure, shown};
use ltcforge_files::bounded::read_line;

/// The longest line that is read. Four numbers take a hundred bytes, a light of eight vertices seven hundred.
const LINE_LIMIT_BYTES: u64 = 4096;

/// Some editors put this before the first line.
const BYTE_ORDER_MARK: char = '\u{feff}';

/// A file of lines, or standard input.
pub(super) struct CsvLines {
    name: String,
    stream: Box<dyn BufRead>,
}

impl CsvLines {
    /// Opens the file at `path`, which holds `what`; `-` is standard input.
    ///
    /// # Errors
    /// When it cannot be opened or is a folder.
    pub(super) fn open(path: &Path, what: &str) -> Result<Self, CommandFailure> {
        if path.as_os_str() == "-" {
            return Ok(Self { name: "standard input".to_owned(), stream: Box::new(io::stdin().lock()) });
        }
        let refuse = |error: io::Error| file_failure(path, &error);
        let file = File::open(path).map_err(refuse)?;
        if file.metadata().map_err(refuse)?.is_dir() {
            let message = format!("{}: this is a folder, not a CSV file of {what}", path.display());
            return Err(CommandFailure::new(Exit::Usage, message));
        }
        Ok(Self { name: shown(path), stream: Box::new(BufReader::new(file)) })
    }

    /// Reads all lines except a header in the first, and calls `take` with each.
    ///
    /// # Errors
    /// When a line is refused by `take`, too long or not UTF-8; the message has the line's number. Other failures of
    /// `take` are returned unchanged.
    pub(super) fn each(
        mut self,
        is_header: impl Fn(&str) -> bool,
        mut take: impl FnMut(&str) -> Result<(), LineFailure>,
    ) -> Result<(), CommandFailure> {
        let mut line = Vec::new();
        for index in 0_u64.. {
            let name = &self.name;
            let at_line =
                |exit, reason: String| CommandFailure::new(exit, format!("{name}, line {}: {reason}", index + 1));
            let refuse = |reason: String| at_line(Exit::Usage, reason);
            match read_line(&mut self.stream, &mut line, LINE_LIMIT_BYTES) {
                Ok(true) => {}
                Ok(false) => break,
                Err(error) if error.kind() == io::ErrorKind::FileTooLarge => return Err(refuse(error.to_string())),
                Err(error) => return Err(at_line(Exit::Failed, error.to_string())),
            }
            let text = str::from_utf8(&line).map_err(|_| refuse("this is not UTF-8".to_owned()))?;
            let text = if index == 0 { text.trim_start_matches(BYTE_ORDER_MARK) } else { text };
            if index == 0 && is_header(text) {
                continue;
            }
            take(text).map_err(|failure| match failure {
                LineFailure::Line(reason) => refuse(reason),
                LineFailure::Command(failure) => failure,
            })?;
        }
        Ok(())
    }
}

/// The reason that a line ends the command.
pub(super) enum LineFailure {
    /// The line is wrong.
    Line(String),
    /// The command cannot go on.
    Command(CommandFailure),
}

impl LineFailure {
    /// Standard output cannot be written.
    pub(super) fn stdout(error: &io::Error) -> Self {
        Self::Command(CommandFailure::stdout(error))
    }
}
