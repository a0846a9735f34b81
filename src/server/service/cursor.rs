//! Cursors. A cursor is the position at which the next page of a list begins.

use serde::Deserialize;

use ltcforge_files::hex::from_hex;

/// Maximum length of a key that sorts tables by age.
const LONGEST_KEY: usize = 64;

/// A position in the list of jobs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(try_from = "String")]
pub struct JobCursor(pub(super) u64);

/// A position in the list of tables.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(try_from = "String")]
pub struct TableCursor(pub(super) Vec<u8>);

/// The error for a text that is not a cursor.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("«{0}» is not a cursor: pass the `next` of the previous page")]
pub struct CursorError(String);

impl TryFrom<String> for JobCursor {
    type Error = CursorError;

    fn try_from(text: String) -> Result<Self, CursorError> {
        // Only the canonical form of a number is valid.
        let submission = text.parse().ok().filter(|submission: &u64| submission.to_string() == text);
        submission.map(Self).ok_or(CursorError(text))
    }
}

impl TryFrom<String> for TableCursor {
    type Error = CursorError;

    fn try_from(text: String) -> Result<Self, CursorError> {
        let key = from_hex(&text).filter(|key| (1..=LONGEST_KEY).contains(&key.len()));
        key.map(Self).ok_or(CursorError(text))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cursor_is_read_as_it_was_given() {
        for submission in [0, u64::MAX] {
            assert_eq!(JobCursor::try_from(submission.to_string()), Ok(JobCursor(submission)));
        }
        assert_eq!(TableCursor::try_from("0001feff".to_owned()), Ok(TableCursor(vec![0, 1, 0xfe, 0xff])));
    }

    #[test]
    fn anything_else_is_named_in_the_error() {
        for text in ["", "none", "-1", "+1", "007", "18446744073709551616", "\0/xyz"] {
            let error = JobCursor::try_from(text.to_owned()).expect_err(text);
            assert!(error.to_string().contains(&format!("«{text}»")), "{error}");
        }
        for text in ["", "0", "0g", "FF", "é", &"00".repeat(LONGEST_KEY + 1)] {
            assert!(TableCursor::try_from(text.to_owned()).is_err(), "{text}");
        }
    }
}
