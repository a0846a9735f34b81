//! The `Range` field with one byte range [RFC 9110, section 14].

use std::ops::Range;

/// Which bytes of a representation a `Range` field requests.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Requested {
    /// All of them: the field is not a single byte range, and a server may ignore others.
    Whole,
    /// These, at least one.
    Part(Range<usize>),
    /// None that exist.
    Unsatisfiable,
}

/// Reads a `Range` field for a representation of `length` bytes. Several ranges are ignored, and so are
/// other units.
pub(super) fn parse(field: &str, length: usize) -> Requested {
    let spec = match field.split_once('=') {
        Some((unit, spec)) if unit.trim().eq_ignore_ascii_case("bytes") => spec.trim(),
        _ => return Requested::Whole,
    };
    let Some((first, last)) = spec.split_once('-') else {
        return Requested::Whole;
    };
    match (position(first), position(last)) {
        (Position::Absent, Position::At(suffix)) => part(length.saturating_sub(suffix), length),
        (Position::At(first), Position::Absent) => part(first, length),
        (Position::At(first), Position::At(last)) if first <= last => part(first, last.saturating_add(1).min(length)),
        _ => Requested::Whole,
    }
}

fn part(start: usize, end: usize) -> Requested {
    if start < end { Requested::Part(start..end) } else { Requested::Unsatisfiable }
}

enum Position {
    Absent,
    At(usize),
    Malformed,
}

/// A position consists of digits only. One too large for a `usize` lies beyond every end.
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
        assert_eq!(parse("bytes=0-0", 10), Requested::Part(0..1));
        assert_eq!(parse("bytes=2-5", 10), Requested::Part(2..6));
        assert_eq!(parse("Bytes = 2-", 10), Requested::Part(2..10));
        assert_eq!(parse("bytes=-3", 10), Requested::Part(7..10));
        assert_eq!(parse("bytes=-30", 10), Requested::Part(0..10));
        assert_eq!(parse("bytes=9-99999999999999999999999", 10), Requested::Part(9..10));
    }

    #[test]
    fn bytes_beyond_the_end_are_refused() {
        for field in ["bytes=10-", "bytes=10-20", "bytes=-0", "bytes=99999999999999999999999-"] {
            assert_eq!(parse(field, 10), Requested::Unsatisfiable, "{field}");
        }
        assert_eq!(parse("bytes=0-", 0), Requested::Unsatisfiable);
    }

    #[test]
    fn anything_but_one_byte_range_is_ignored() {
        for field in
            ["", "bytes", "bytes=", "bytes=-", "bytes=5-2", "bytes=a-b", "bytes=0-1,4-5", "items=0-1", "bytes=+1-2"]
        {
            assert_eq!(parse(field, 10), Requested::Whole, "{field}");
        }
    }
}
