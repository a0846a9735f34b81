//! The inputs of the repository: what once failed, and what was told a fault that none was told before, as short as it may be.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use ltcforge::Digest;

/// The longest input that is kept for its faults.
const MOST_BYTES: usize = 4096;

/// Inputs that are kept for their faults, of one target.
const MOST_FILES: usize = 100;

/// How long an input is shortened.
const MOST_TIME: Duration = Duration::from_secs(20);

/// The folder of a target's inputs.
fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz/corpus").join(name)
}

/// The files of a target, in the order of their names.
pub(crate) fn files(name: &str) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> =
        fs::read_dir(folder(name)).into_iter().flatten().flatten().map(|file| file.path()).collect();
    files.sort();
    files
}

/// Writes an input under its digest's name.
pub(crate) fn write(name: &str, input: &[u8]) -> PathBuf {
    let file = folder(name).join(&Digest::of(input).hex()[..16]);
    fs::create_dir_all(folder(name)).and_then(|()| fs::write(&file, input)).expect("a file of the corpus");
    file
}

/// Writes an input with the faults `new`, shortened, if it is short then and the target has few.
pub(crate) fn keep(name: &str, input: &[u8], new: &BTreeSet<String>, faults: impl Fn(&[u8]) -> BTreeSet<String>) {
    if files(name).len() < MOST_FILES {
        let short = shortened(input, |shorter| faults(shorter).is_superset(new));
        if short.len() <= MOST_BYTES {
            write(name, &short);
        }
    }
}

/// An input without the parts that `is_as_good` says it can lose: halves, quarters and so on, down to bytes.
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
fn an_input_is_shortened_to_what_its_fault_needs() {
    let long = [b"some words, a {brace, and \"size\": -1 and more }".as_slice(), &[b' '; 3000]].concat();
    let has = |text: &[u8], word: &[u8]| text.windows(word.len()).any(|part| part == word);
    assert_eq!(shortened(&long, |input| has(input, b"{") && has(input, b"size")), b"{size");
    assert_eq!(shortened(&long, |input| input == long), long);
}
