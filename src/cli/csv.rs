//! Reads CSV lines from a file or standard input, and prints a row for each.

use std::{
    io::{self, BufRead, BufReader, BufWriter, Write},
    path::Path,
};

use serde_json::{Value, json};

use super::{Clamped, CommandFailure, Context, Exit, file_failure, out_of_range::OutOfRangeCount, shown, usage};
use ltcforge_files::bounded::{open_named, read_line};

/// Maximum length of a line. Four numbers take about 100 bytes, a light with eight vertices about 700.
const LINE_LIMIT_BYTES: u64 = 4096;

/// Some editors write this mark at the start of a file.
pub(super) const BYTE_ORDER_MARK: char = '\u{feff}';

/// The lines of a file or of standard input.
pub(super) struct CsvLines {
    name: String,
    stream: Box<dyn BufRead>,
}

impl CsvLines {
    /// Opens the CSV file at `path`, or standard input for `-`. Messages call its content `what`.
    ///
    /// # Errors
    /// When the file cannot be opened or is a folder.
    pub(super) fn open(path: &Path, what: &str) -> Result<Self, CommandFailure> {
        if path.as_os_str() == "-" {
            return Ok(Self { name: "standard input".to_owned(), stream: Box::new(io::stdin().lock()) });
        }
        if path.is_dir() {
            let message = format!("{}: this is a folder, not a CSV file of {what}", path.display());
            return Err(usage(message));
        }
        let file = open_named(path).map_err(|error| file_failure(path, &error))?;
        Ok(Self { name: shown(path), stream: Box::new(BufReader::new(file)) })
    }

    /// Calls `take` with each line. A header in the first line is skipped.
    ///
    /// # Errors
    /// When a line is too long, not UTF-8, or rejected by `take`. The message has the line number. Other failures of
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
            let text = str::from_utf8(&line).map_err(|_| refuse("the line is not UTF-8".to_owned()))?;
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

/// Why a line ends the command.
pub(super) enum LineFailure {
    /// The line is invalid.
    Line(String),
    /// The command cannot continue.
    Command(CommandFailure),
}

impl From<CommandFailure> for LineFailure {
    fn from(failure: CommandFailure) -> Self {
        Self::Command(failure)
    }
}

/// Rows on standard output: CSV with a header, or one JSON document per line.
pub(super) struct Rows<'a> {
    out: BufWriter<&'a mut dyn Write>,
    /// The header, until it is printed. An error in the first line leaves the output empty.
    header: Option<String>,
    json: bool,
    out_of_range: OutOfRangeCount,
}

impl<'a> Rows<'a> {
    /// Rows with these columns. JSON has no header.
    pub(super) fn new(context: &'a mut Context<'_>, columns: &[String]) -> Self {
        Self {
            out: BufWriter::new(&mut *context.stdout as &mut dyn Write),
            header: (!context.json).then(|| columns.join(",")),
            json: context.json,
            out_of_range: OutOfRangeCount::default(),
        }
    }

    fn print_header(&mut self) -> Result<(), CommandFailure> {
        match self.header.take() {
            Some(header) => writeln!(self.out, "{header}").map_err(|error| CommandFailure::stdout(&error)),
            None => Ok(()),
        }
    }

    /// Prints a row. `clamped` lists the coordinates of its point that were outside the table's range.
    pub(super) fn print(
        &mut self,
        clamped: Option<&[Clamped]>,
        row: impl FnOnce() -> String,
        value: impl FnOnce() -> Value,
    ) -> Result<(), LineFailure> {
        self.print_header()?;
        self.out_of_range.count(clamped.unwrap_or_default());
        let written = if self.json {
            let mut value = value();
            if let Some(clamped) = clamped {
                value["clamped"] = clamped.iter().map(|clamped| (clamped.axis.to_owned(), json!(clamped.to))).collect();
            }
            writeln!(self.out, "{value}")
        } else {
            writeln!(self.out, "{}", row())
        };
        Ok(written.map_err(|error| CommandFailure::stdout(&error))?)
    }

    /// Finishes the output. CSV cannot show clamped points, so a summary of them goes to standard error.
    pub(super) fn end(mut self) -> Result<Exit, CommandFailure> {
        self.print_header()?;
        self.out.flush().map_err(|error| CommandFailure::stdout(&error))?;
        if !self.json && !self.out_of_range.is_empty() {
            eprintln!("{}", self.out_of_range);
        }
        Ok(Exit::Ok)
    }
}
