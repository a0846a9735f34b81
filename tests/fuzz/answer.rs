//! The words that a reader itself adds to an answer. Words repeated from the input are removed.

use std::collections::BTreeSet;

/// The least length of a word. Shorter words are parts of escapes, units or numbers.
const FEWEST_LETTERS: usize = 3;

/// The largest number of counted format words that repeat the input. A long name in the input can consist of many
/// format words in any order.
const MOST_REPEATED: usize = 2;

/// The words of a format, such as field names. They count even if an answer repeats them from the input.
pub(crate) struct Format(BTreeSet<String>);

impl Format {
    /// The words in these texts.
    pub(crate) fn of<'a>(texts: impl IntoIterator<Item = &'a [u8]>) -> Self {
        let texts = texts.into_iter().map(String::from_utf8_lossy);
        Self(texts.flat_map(|text| words(&text).map(str::to_owned).collect::<Vec<_>>()).collect())
    }

    /// The faults in an answer. They are separated by line breaks or semicolons. Each fault is the list of its words,
    /// without duplicates and quotations.
    pub(crate) fn faults(&self, answer: &str, input: &[u8]) -> BTreeSet<String> {
        let (answer, input) = (unquoted(answer), String::from_utf8_lossy(input));
        let fault = |line: &str| {
            let (mut own, mut repeated) = (Vec::new(), 0);
            for word in words(line) {
                let counts = !input.contains(word) || self.0.contains(word) && repeated < MOST_REPEATED;
                if counts && !own.contains(&word) {
                    repeated += usize::from(input.contains(word));
                    own.push(word);
                }
            }
            own.join(" ")
        };
        answer.lines().flat_map(|line| line.split("; ")).map(fault).collect()
    }
}

/// The text without quotations in «», or with escapes in "".
fn unquoted(text: &str) -> String {
    let (mut kept, mut depth) = (String::new(), 0_usize);
    let mut characters = text.chars();
    while let Some(c) = characters.next() {
        match c {
            '«' => depth += 1,
            '»' => depth = depth.saturating_sub(1),
            '"' if depth == 0 => {
                while let Some(quoted) = characters.next() {
                    match quoted {
                        '"' => break,
                        '\\' => drop(characters.next()),
                        _ => {}
                    }
                }
                kept.push(' ');
            }
            _ if depth == 0 => kept.push(c),
            _ => {}
        }
    }
    kept
}

/// The words of a text: letters and digits, starting with a letter. Escapes start with a backslash and are skipped.
fn words(text: &str) -> impl Iterator<Item = &str> {
    let is_of_word = |c: char| c.is_alphanumeric() || c == '_' || c == '\\';
    text.split(move |c| !is_of_word(c))
        .flat_map(|run| {
            // The letter after a backslash belongs to the escape.
            run.split('\\').enumerate().map(|(at, part)| {
                let mut rest = part.chars();
                if at > 0 {
                    rest.next();
                }
                rest.as_str()
            })
        })
        .filter(|word| word.starts_with(char::is_alphabetic) && word.chars().count() >= FEWEST_LETTERS)
}

#[test]
fn words_repeated_from_the_input_are_not_part_of_faults() {
    let format = Format::of([b"{\"alpha\": 1}".as_slice()]);
    let faults = |answer, input: &[u8]| format.faults(answer, input).into_iter().collect::<Vec<_>>();
    assert_eq!(
        faults("alpha: `gaga\\ngogo` is 0x1ffe, not a number; alpha: twice alpha", b"alpha gaga\ngogo"),
        ["alpha not number", "alpha twice"]
    );
    assert_eq!(faults("«alpha«beta\n»» none of \"alpha\\\" x\", twice", b"alpha"), ["none twice"]);
    let long = b"unknown field: one two three four";
    assert_eq!(
        Format::of([long.as_slice()]).faults("four and three and two", long),
        ["four and three".to_owned()].into()
    );
    assert_eq!(faults("", b""), [""; 0]);
}
