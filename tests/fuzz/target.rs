//! Inputs for readers of foreign bytes: seeds, the corpus, and mutations of both.
//!
//! The stable compiler has no instrumentation for fuzzing, so the answers of a reader replace it. An input that
//! triggers a new error is mutated further.

use std::{
    collections::BTreeSet,
    env,
    io::Write as _,
    panic::{AssertUnwindSafe, catch_unwind, resume_unwind},
    time::{Duration, Instant},
};

use rustix::time::{ClockId, clock_gettime};

use super::{answer::Format, corpus, watch::Watch};

/// The largest processor time for one input, in the thread that reads it. Wall-clock time is not used, because all
/// targets may share two cores. [`Watch`] limits the wall-clock time.
const MOST_TIME: Duration = Duration::from_secs(20);

/// The largest size of an input in bytes.
const MOST_BYTES: usize = 1 << 20;

/// The largest number of inputs that are mutated further.
const MOST_KEPT: usize = 2000;

/// Values that replace a number.
const NUMBERS: [&str; 12] = [
    "0",
    "-1",
    "1e999",
    "-0.0",
    "NaN",
    "null",
    "4294967296",
    "9223372036854775808",
    "18446744073709551616",
    "1e-320",
    "[]",
    "\"\"",
];

/// A reader of bytes, with inputs for it.
#[derive(Debug)]
pub(crate) struct Target<'a> {
    /// The target's name. Its file in `tests/fuzz/corpus` has the same name.
    pub(crate) name: &'a str,
    /// Valid inputs.
    pub(crate) seeds: Vec<Vec<u8>>,
    /// Words of the format.
    pub(crate) words: &'a [&'a str],
    /// The number of inputs in each run of the tests. `LTCFORGE_TEST_FUZZ_SECONDS` sets a duration instead.
    pub(crate) inputs: u64,
}

/// Pseudo-random numbers that are the same in every run.
struct Random(u64);

impl Random {
    /// `SplitMix64` [Steele et al. 2014].
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, limit: usize) -> usize {
        (self.next() % limit.max(1) as u64) as usize
    }

    fn of<'a, T: ?Sized>(&mut self, items: &[&'a T]) -> &'a T {
        items[self.below(items.len())]
    }
}

/// The processor time of this thread.
fn processor_time() -> Duration {
    Duration::try_from(clock_gettime(ClockId::ThreadCPUTime)).expect("a time since the thread began")
}

/// A number in an environment variable.
fn number_of(name: &str) -> Option<u64> {
    env::var(name).ok().map(|text| text.parse().unwrap_or_else(|_| panic!("{name} must be a number, got «{text}»")))
}

impl Target<'_> {
    /// Calls `read` with the inputs of the corpus, the seeds, and mutations of both. `read` must return the message for
    /// users.
    ///
    /// # Panics
    /// `read` panics or takes too long. The input is then in the corpus, and the next run starts with it. Or there is
    /// no corpus.
    pub(crate) fn survive(&self, read: impl Fn(&[u8]) -> String) {
        assert!(!self.seeds.is_empty(), "{}: no seeds", self.name);
        let seconds = number_of("LTCFORGE_TEST_FUZZ_SECONDS");
        let keeps = number_of("LTCFORGE_TEST_FUZZ_KEEP").is_some_and(|number| number > 0);
        let corpus = corpus::inputs(self.name);
        assert!(keeps || !corpus.is_empty(), "{}: no corpus; tests/fuzz/mod.rs explains how to make one", self.name);
        let texts = self.seeds.iter().map(Vec::as_slice).chain(self.words.iter().map(|word| word.as_bytes()));
        let (watch, format) = (Watch::new(self.name), Format::of(texts));
        let faults = |input: &[u8]| format.faults(&self.answer(&read, input, &watch), input);
        let mut kept = self.seeds.clone();
        kept.extend(corpus);
        let mut known: BTreeSet<String> = kept.iter().flat_map(|input| faults(input)).collect();
        let (start, time) = (Instant::now(), seconds.map(Duration::from_secs));
        let mut inputs = 0;
        while time.map_or(inputs < self.inputs, |time| start.elapsed() < time) {
            let input = self.mutated(&kept, &mut Random(inputs));
            inputs += 1;
            let new: BTreeSet<String> = faults(&input).difference(&known).cloned().collect();
            if !new.is_empty() {
                if keeps {
                    corpus::keep(self.name, &input, &new, faults);
                }
                known.extend(new);
                if kept.len() < MOST_KEPT {
                    kept.push(input);
                }
            }
        }
        if seconds.is_some() {
            // The output of print macros is hidden for passing tests.
            let message = format!("{}: {inputs} inputs, {} faults and results\n", self.name, known.len());
            std::io::stderr().write_all(message.as_bytes()).expect("stderr");
        }
    }

    fn answer(&self, read: &impl Fn(&[u8]) -> String, input: &[u8], watch: &Watch) -> String {
        let start = processor_time();
        let answer = watch.over(input, || catch_unwind(AssertUnwindSafe(|| read(input))));
        let took = processor_time().saturating_sub(start);
        if answer.is_err() || took > MOST_TIME {
            let line = corpus::write(self.name, input);
            eprintln!("{}: after {took:?}; the input is now {line}", self.name);
        }
        let answer = answer.unwrap_or_else(|panic| resume_unwind(panic));
        assert!(took <= MOST_TIME, "{}: an input took {took:?}", self.name);
        answer
    }

    fn mutated(&self, kept: &[Vec<u8>], random: &mut Random) -> Vec<u8> {
        let mut bytes = kept[random.below(kept.len())].clone();
        for _ in 0..=random.below(4) {
            self.mutate(&mut bytes, kept, random);
        }
        bytes.truncate(MOST_BYTES);
        bytes
    }

    fn mutate(&self, bytes: &mut Vec<u8>, kept: &[Vec<u8>], random: &mut Random) {
        let at = random.below(bytes.len() + 1);
        let end = (at + 1 + random.below(16)).min(bytes.len());
        match random.below(10) {
            0 => bytes.truncate(at),
            1 => drop(bytes.drain(at..end)),
            2 => bytes.splice(at..at, self.word(random).bytes()).for_each(drop),
            3 => bytes.splice(at..end, self.word(random).bytes()).for_each(drop),
            4 => {
                // The end of another input.
                let other = &kept[random.below(kept.len())];
                bytes.truncate(at);
                bytes.extend(&other[random.below(other.len() + 1)..]);
            }
            5 => {
                let again = bytes[at..end].repeat(1 + random.below(40));
                bytes.splice(at..at, again).for_each(drop);
            }
            6 => {
                // A number of 32 or 64 bits, usually at one end of its range.
                let number = [0, 1, u64::MAX, u64::MAX >> 1, 1 << 31, 1 << 32, random.next()][random.below(7)];
                let width = (4 << random.below(2)).min(bytes.len() - at);
                bytes[at..at + width].copy_from_slice(&number.to_le_bytes()[..width]);
            }
            7 | 8 => {
                // The next number in the text.
                let is_digit = |byte: &u8| byte.is_ascii_digit();
                if let Some(from) = bytes[at..].iter().position(is_digit).map(|offset| at + offset) {
                    let length =
                        bytes[from..].iter().take_while(|byte| is_digit(byte) || b".eE+-".contains(byte)).count();
                    bytes.splice(from..from + length, random.of(&NUMBERS).bytes()).for_each(drop);
                }
            }
            _ => {
                if let Some(byte) = bytes.get_mut(at) {
                    *byte ^= 1 << random.below(8);
                }
            }
        }
    }

    fn word(&self, random: &mut Random) -> &str {
        if self.words.is_empty() { random.of(&NUMBERS) } else { random.of(self.words) }
    }
}

/// A reader with a fault behind three conditions. A random input hardly ever meets all three at once.
#[test]
fn a_fault_behind_several_conditions_is_found() {
    let read = |bytes: &[u8]| {
        let text = String::from_utf8_lossy(bytes);
        if !text.starts_with('{') {
            return "no object".to_owned();
        }
        let Some(rest) = text.split("size").nth(1) else { return "no size".to_owned() };
        assert!(!rest.starts_with("\":-1"), "the planted fault");
        "fine".to_owned()
    };
    let target =
        Target { name: "planted", seeds: vec![br#"{"a":1}"#.to_vec()], words: &["\"size\":", ",", "{"], inputs: 0 };
    let found = (0..200_000).find(|number| {
        let mut kept = target.seeds.clone();
        kept.push(br#"{"size":3}"#.to_vec());
        let input = target.mutated(&kept, &mut Random(*number));
        catch_unwind(AssertUnwindSafe(|| read(&input))).is_err()
    });
    assert!(found.is_some());
}

#[test]
fn equal_numbers_give_equal_inputs() {
    let target = Target { name: "planted", seeds: vec![b"1,2,3".to_vec()], words: &[], inputs: 0 };
    let inputs = || (0..50).map(|number| target.mutated(&target.seeds, &mut Random(number))).collect::<Vec<_>>();
    let distinct: BTreeSet<_> = inputs().into_iter().collect();
    assert_eq!(inputs(), inputs());
    assert!(distinct.len() > 30, "{}", distinct.len());
}
