//! Tests with a short form for every run, and a long form for `make soak`.

use std::env;

/// The number of rounds of a test: the number in the environment variable `name`, or `short`.
pub(crate) fn rounds(name: &str, short: usize) -> usize {
    match env::var(name) {
        Ok(number) => number.parse().unwrap_or_else(|_| panic!("{name} must be a number, got «{number}»")),
        Err(_) => short,
    }
}

/// Pseudo-random numbers that are the same in every run.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        usize::try_from(self.0 >> 33).unwrap_or(0) % limit
    }
}

/// A recipe with four shards. It is unique for each number, and takes some hundredths of a second.
pub(crate) fn four_shards(number: usize) -> String {
    format!(
        r#"{{"preset":"draft","resolution":{{"alpha":4,"ratio":4,"theta":4,"phi":4}},
        "fit":{{"samples":64,"directions":4,"steps":5,"seed":{number}}}}}"#
    )
}
