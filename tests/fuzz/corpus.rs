//! The inputs in the repository: inputs that once failed, and inputs that are the only ones to trigger an error.
//!
//! `corpus/` has a text file for each target, with one input per line. Bytes outside printable ASCII are escaped as
//! `\\n` or `\\x00`, and a backslash as `\\\\`.

use std::{
    collections::BTreeSet,
    fmt::Write as _,
    fs::{self, OpenOptions},
    io::Write as _,
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

/// The largest size of an input that is kept for its faults, in bytes.
const MOST_BYTES: usize = 4096;

/// The largest number of inputs per target that are kept for their faults.
const MOST_INPUTS: usize = 100;

/// The time limit for shortening an input.
const MOST_TIME: Duration = Duration::from_secs(20);

/// The corpus file of a target.
fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz/corpus").join(name).with_extension("txt")
}

/// The inputs of a target, in the order of the file.
pub(crate) fn inputs(name: &str) -> Vec<Vec<u8>> {
    let text = fs::read_to_string(file(name)).unwrap_or_default();
    let input = |line| unescaped(line).unwrap_or_else(|| panic!("{name}.txt: unknown escape in {line}"));
    text.lines().map(input).collect()
}

/// Appends an input if the file does not have it yet. Returns the file and the line.
pub(crate) fn write(name: &str, input: &[u8]) -> String {
    let (file, known) = (file(name), inputs(name));
    let line = known.iter().position(|other| other == input).unwrap_or_else(|| {
        let mut open = OpenOptions::new().create(true).append(true).open(&file).expect("a file of the corpus");
        writeln!(open, "{}", escaped(input)).expect("a file of the corpus");
        known.len()
    });
    format!("{}:{}", file.display(), line + 1)
}

/// An input as a line of text.
fn escaped(input: &[u8]) -> String {
    input.iter().fold(String::new(), |mut line, &byte| {
        match byte {
            b'\\' => line += r"\\",
            b'\n' => line += r"\n",
            b' '..=b'~' => line.push(byte.into()),
            _ => write!(line, r"\x{byte:02x}").expect("a string takes all"),
        }
        line
    })
}

/// The input in a line. `None` if an escape is unknown.
fn unescaped(line: &str) -> Option<Vec<u8>> {
    let (mut input, mut rest) = (Vec::new(), line.as_bytes());
    while let [byte, after @ ..] = rest {
        (rest, ()) = match (byte, after) {
            (b'\\', [b'\\', after @ ..]) => (after, input.push(b'\\')),
            (b'\\', [b'n', after @ ..]) => (after, input.push(b'\n')),
            (b'\\', [b'x', high, low, after @ ..]) => {
                let digit = |digit: u8| char::from(digit).to_digit(16);
                (after, input.push((16 * digit(*high)? + digit(*low)?) as u8))
            }
            (b'\\', _) => return None,
            (byte, after) => (after, input.push(*byte)),
        };
    }
    Some(input)
}

/// Shortens an input that triggers the faults `new`. Writes it if it is short enough and the target has room for more
/// inputs.
pub(crate) fn keep(name: &str, input: &[u8], new: &BTreeSet<String>, faults: impl Fn(&[u8]) -> BTreeSet<String>) {
    if inputs(name).len() < MOST_INPUTS {
        let short = shortened(input, |shorter| faults(shorter).is_superset(new));
        if short.len() <= MOST_BYTES {
            write(name, &short);
        }
    }
}

/// Removes all parts of an input that `is_as_good` does not need: halves, quarters and so on, down to bytes.
fn shortened(input: &[u8], is_as_good: impl Fn(&[u8]) -> bool) -> Vec<u8> {
    let (mut input, start) = (input.to_vec(), Instant::now());
    let mut part = input.len().div_ceil(2);
    while part > 0 {
        let mut at = 0;
        while at < input.len() && start.elapsed() < MOST_TIME {
            let shorter = [&input[..at], &input[(at + part).min(input.len())..]].concat();
            if is_as_good(&shorter) {
                input = shorter;
            } else {
                at += part;
            }
        }
        part /= 2;
    }
    input
}

#[test]
fn an_input_is_shortened_to_the_bytes_that_its_fault_needs() {
    let long = [b"some words, a {brace, and \"size\": -1 and more }".as_slice(), &[b' '; 3000]].concat();
    let has = |text: &[u8], word: &[u8]| text.windows(word.len()).any(|part| part == word);
    assert_eq!(shortened(&long, |input| has(input, b"{") && has(input, b"size")), b"{size");
    assert_eq!(shortened(&long, |input| input == long), long);
}

#[test]
fn every_byte_survives_a_line() {
    let input: Vec<u8> = (0..=255).chain(*b"\\n\\x00\r\n \xc3\xa9").collect();
    let line = escaped(&input);
    assert!(line.is_ascii() && line.lines().count() == 1, "{line}");
    assert_eq!(unescaped(&line), Some(input));
    for faulty in [r"\", r"\t", r"\x0", r"\x0g"] {
        assert_eq!(unescaped(faulty), None, "{faulty}");
    }
}
