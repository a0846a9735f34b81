//! Where the next page of a list begins, as clients are given it.

use std::{fmt, str::FromStr};

use serde::Deserialize;

use ltcforge_files::hex::{from_hex, to_hex};

/// Longest key of a table in the order of age.
const LONGEST_KEY: usize = 64;

/// A place in the list of jobs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(try_from = "String")]
pub struct JobCursor(pub(super) u64);

/// A place in the list of tables.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(try_from = "String")]
pub struct TableCursor(pub(super) Vec<u8>);

/// A text that no page has given as its `next`.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("«{0}» is not a cursor: a cursor is the `next` of the page before")]
pub struct CursorError(String);

impl FromStr for JobCursor {
    type Err = CursorError;

    fn from_str(text: &str) -> Result<Self, CursorError> {
        let submission = text.parse().ok().map(Self);
        // A number has one way to be written.
        submission.filter(|cursor| cursor.to_string() == text).ok_or_else(|| CursorError(text.to_owned()))
    }
}

impl fmt::Display for JobCursor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl FromStr for TableCursor {
    type Err = CursorError;

    fn from_str(text: &str) -> Result<Self, CursorError> {
        let key = from_hex(text).filter(|key| (1..=LONGEST_KEY).contains(&key.len()));
        key.map(Self).ok_or_else(|| CursorError(text.to_owned()))
    }
}

impl fmt::Display for TableCursor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&to_hex(&self.0))
    }
}

impl TryFrom<String> for JobCursor {
    type Error = CursorError;

    fn try_from(text: String) -> Result<Self, CursorError> {
        text.parse()
    }
}

impl TryFrom<String> for TableCursor {
    type Error = CursorError;

    fn try_from(text: String) -> Result<Self, CursorError> {
        text.parse()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cursor_is_read_as_it_was_given() {
        for cursor in [JobCursor(0), JobCursor(u64::MAX)] {
            assert_eq!(cursor.to_string().parse(), Ok(cursor));
        }
        let cursor = TableCursor(vec![0, 1, 0xfe, 0xff]);
        assert_eq!(cursor.to_string(), "0001feff");
        assert_eq!("0001feff".parse(), Ok(cursor));
    }

    #[test]
    fn anything_else_is_named_in_the_error() {
        for text in ["", "none", "-1", "+1", "007", "18446744073709551616", "\0/xyz"] {
            let error = text.parse::<JobCursor>().expect_err(text);
            assert!(error.to_string().contains(&format!("«{text}»")), "{error}");
        }
        for text in ["", "0", "0g", "FF", "é", &"00".repeat(LONGEST_KEY + 1)] {
            assert!(text.parse::<TableCursor>().is_err(), "{text}");
        }
    }
}
