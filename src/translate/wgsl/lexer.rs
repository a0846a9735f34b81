//! Tokens: words, numbers and signs, with their positions in the source.

use std::ops::Range;

/// A range of bytes of the source.
pub(crate) type Span = Range<usize>;

/// An error in the source, with its position.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Fault {
    /// The position, in bytes from the start.
    pub(crate) at: usize,
    pub(crate) reason: String,
}

impl Fault {
    pub(crate) fn new(at: usize, reason: impl Into<String>) -> Self {
        Self { at, reason: reason.into() }
    }

    /// The message with line and column, both counted from 1. `source` must be the text with the error.
    pub(crate) fn message(&self, source: &str) -> String {
        let before = source.get(..self.at).unwrap_or(source);
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().map_or(0, |rest| rest.chars().count()) + 1;
        format!("line {line}, column {column}: {}", self.reason)
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Word,
    Number,
    Sign,
    /// The end of the text, after the last token.
    End,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Token {
    pub(crate) kind: Kind,
    pub(crate) span: Span,
}

/// Signs of two characters. Two `>` are missing, because the parser decides whether they are a shift or close two type
/// lists.
const PAIRS: [&str; 16] =
    ["->", "==", "!=", "<=", ">=", "&&", "||", "<<", "+=", "-=", "*=", "/=", "%=", "&=", "|=", "^="];
const STEPS: [&str; 2] = ["++", "--"];
const SIGNS: &str = "(){}[]<>,;:.@=+-*/%&|^!~";

/// The tokens of the source. The last is [`Kind::End`].
pub(crate) fn tokens(source: &str) -> Result<Vec<Token>, Fault> {
    let (mut found, mut at) = (Vec::new(), 0);
    while let Some(first) = source[at..].chars().next() {
        let rest = &source[at..];
        let (kind, length) = if first.is_whitespace() {
            (None, first.len_utf8())
        } else if rest.starts_with("//") {
            (None, rest.find('\n').unwrap_or(rest.len()))
        } else if rest.starts_with("/*") {
            let end = rest.find("*/").ok_or_else(|| Fault::new(at, "this comment is not closed"))?;
            (None, end + 2)
        } else if first.is_ascii_alphabetic() || first == '_' {
            (Some(Kind::Word), length_while(rest, |c| c.is_ascii_alphanumeric() || c == '_'))
        } else if first.is_ascii_digit() {
            (Some(Kind::Number), number_length(rest))
        } else if PAIRS.iter().chain(&STEPS).any(|sign| rest.starts_with(sign)) {
            (Some(Kind::Sign), 2)
        } else if SIGNS.contains(first) {
            (Some(Kind::Sign), 1)
        } else {
            return Err(Fault::new(at, format!("unexpected character {first:?}")));
        };
        if let Some(kind) = kind {
            found.push(Token { kind, span: at..at + length });
        }
        at += length;
    }
    found.push(Token { kind: Kind::End, span: at..at });
    Ok(found)
}

fn length_while(text: &str, is_part: impl Fn(char) -> bool) -> usize {
    text.find(|c| !is_part(c)).unwrap_or(text.len())
}

/// The length of a number: digits, point, exponent with sign, suffix. Domain: the text starts with a digit.
fn number_length(text: &str) -> usize {
    if text.starts_with("0x") {
        return length_while(text, |c| c.is_ascii_alphanumeric());
    }
    let length = length_while(text, |c| c.is_ascii_alphanumeric() || c == '.');
    let has_open_exponent = text[..length].ends_with(['e', 'E']);
    let has_sign = has_open_exponent && text[length..].starts_with(['+', '-']);
    if has_sign { length + 1 + length_while(&text[length + 1..], |c| c.is_ascii_alphanumeric()) } else { length }
}
