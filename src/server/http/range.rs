//! The `Range` field with one byte range [RFC 9110, section 14].

use std::ops::Range;

/// What a `Range` field asks of a representation.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Asked {
    /// All of it: the field is not one byte range, which a server may ignore.
    Whole,
    /// These bytes, not empty.
    Part(Range<usize>),
    /// Bytes that are not there.
    Unsatisfiable,
}

/// Reads a `Range` field for a representation of `length` bytes. Several ranges are ignored like foreign units.
pub(super) fn parse(field: &str, length: usize) -> Asked {
    let spec = match field.split_once('=') {
        Some((unit, spec)) if unit.trim().eq_ignore_ascii_case("bytes") => spec.trim(),
        _ => return Asked::Whole,
    };
    let Some((first, last)) = spec.split_once('-') else {
        return Asked::Whole;
    };
    match (position(first), position(last)) {
        (Position::Absent, Position::At(suffix)) => part(length.saturating_sub(suffix), length),
        (Position::At(first), Position::Absent) => part(first, length),
        (Position::At(first), Position::At(last)) if first <= last => part(first, last.saturating_add(1).min(length)),
        _ => Asked::Whole,
    }
}

fn part(start: usize, end: usize) -> Asked {
    if start < end { Asked::Part(start..end) } else { Asked::Unsatisfiable }
}

enum Position {
    Absent,
    At(usize),
    Malformed,
}

/// A position of digits alone; one too large for the machine lies past every end.
fn position(text: &str) -> Position {
    if text.is_empty() {
        Position::Absent
    } else if text.bytes().all(|byte| byte.is_ascii_digit()) {
        Position::At(text.parse().unwrap_or(usize::MAX))
    } else {
        Position::Malformed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_range_is_cut_to_the_file() {
        assert_eq!(parse("bytes=0-0", 10), Asked::Part(0..1));
        assert_eq!(parse("bytes=2-5", 10), Asked::Part(2..6));
        assert_eq!(parse("Bytes = 2-", 10), Asked::Part(2..10));
        assert_eq!(parse("bytes=-3", 10), Asked::Part(7..10));
        assert_eq!(parse("bytes=-30", 10), Asked::Part(0..10));
        assert_eq!(parse("bytes=9-99999999999999999999999", 10), Asked::Part(9..10));
    }

    #[test]
    fn bytes_that_are_not_there_are_refused() {
        for field in ["bytes=10-", "bytes=10-20", "bytes=-0", "bytes=99999999999999999999999-"] {
            assert_eq!(parse(field, 10), Asked::Unsatisfiable, "{field}");
        }
        assert_eq!(parse("bytes=0-", 0), Asked::Unsatisfiable);
    }

    #[test]
    fn what_is_not_one_byte_range_is_ignored() {
        for field in
            ["", "bytes", "bytes=", "bytes=-", "bytes=5-2", "bytes=a-b", "bytes=0-1,4-5", "items=0-1", "bytes=+1-2"]
        {
            assert_eq!(parse(field, 10), Asked::Whole, "{field}");
        }
    }
}
