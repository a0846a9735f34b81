//! Limits on the length and the time of answers, because a server may never end one.

use std::{fmt, time::Duration};

/// Limits on the answers of a server.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// The longest answer that is a document: a job, a page of jobs, a problem.
    pub document_bytes: u64,
    /// The longest table, unless the lock file states its size.
    pub table_bytes: u64,
    /// How long a server may send nothing in the middle of an answer.
    pub stall: Duration,
    /// How long a document may take in all.
    pub document_time: Duration,
    /// How long a table may take in all.
    pub table_time: Duration,
    /// The time over which the speed of an answer is averaged.
    pub pace_window: Duration,
    /// The slowest average speed that is accepted, in bytes per second.
    pub pace_bytes_per_second: u64,
}

impl Limits {
    /// The usual limits.
    pub const USUAL: Self = Self {
        document_bytes: 4 << 20,
        table_bytes: 1 << 30,
        stall: Duration::from_secs(30),
        document_time: Duration::from_secs(120),
        table_time: Duration::from_secs(6 * 3600),
        pace_window: Duration::from_secs(60),
        pace_bytes_per_second: 1000,
    };
}

/// The origin of the limit on the length of an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SizeOrigin {
    /// The lock file, which states the size of the file.
    LockFile,
    /// The limit for tables of an unknown size.
    Tables,
    /// The limit for documents.
    Documents,
}

impl fmt::Display for SizeOrigin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::LockFile => "the size that the lock file states",
            Self::Tables => "the limit for tables; --table-limit sets another",
            Self::Documents => "the client's limit for documents",
        })
    }
}

impl Default for Limits {
    fn default() -> Self {
        Self::USUAL
    }
}

/// Checks the speed of an answer and its time in all.
#[derive(Debug)]
pub(super) struct Pace {
    limits: Limits,
    /// How long the answer may take in all.
    time: Duration,
    /// When the current window began, counted from the start of the answer.
    window_start: Duration,
    /// Bytes that were read in it.
    window_bytes: u64,
}

impl Pace {
    /// The pace of an answer that may take `time` in all.
    pub(super) fn new(limits: Limits, time: Duration) -> Self {
        Self { limits, time, window_start: Duration::ZERO, window_bytes: 0 }
    }

    /// Counts `bytes` that were read `elapsed` after the start of the answer.
    ///
    /// # Errors
    /// The limit that the answer exceeds, in words.
    pub(super) fn read(&mut self, bytes: u64, elapsed: Duration) -> Result<(), String> {
        if elapsed > self.time {
            return Err(format!("the answer takes longer than {} s, the limit", self.time.as_secs_f64()));
        }
        self.window_bytes += bytes;
        let passed = elapsed.saturating_sub(self.window_start);
        if passed >= self.limits.pace_window {
            let slowest = self.limits.pace_bytes_per_second;
            if (self.window_bytes as f64) < slowest as f64 * passed.as_secs_f64() {
                let seconds = passed.as_secs_f64();
                return Err(format!(
                    "the answer came at less than {slowest} bytes/s, the limit, on average over {seconds:.0} s"
                ));
            }
            (self.window_start, self.window_bytes) = (elapsed, 0);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seconds(n: u64) -> Duration {
        Duration::from_secs(n)
    }

    #[test]
    fn a_byte_a_second_is_refused_after_a_minute() {
        let mut pace = Pace::new(Limits::USUAL, Limits::USUAL.table_time);
        for second in 1..60 {
            pace.read(1, seconds(second)).expect("the window is open");
        }
        let refused = pace.read(1, seconds(60)).expect_err("60 bytes in 60 s");
        assert!(refused.contains("1000 bytes/s"), "{refused}");
    }

    #[test]
    fn a_fast_start_does_not_excuse_a_slow_end() {
        let mut pace = Pace::new(Limits::USUAL, Limits::USUAL.table_time);
        pace.read(1 << 20, seconds(60)).expect("fast");
        pace.read(60_000, seconds(120)).expect("just fast enough");
        assert!(pace.read(59_999, seconds(180)).is_err());
    }

    #[test]
    fn an_answer_ends_in_its_time() {
        let mut pace = Pace::new(Limits::USUAL, Limits::USUAL.document_time);
        pace.read(1 << 20, seconds(120)).expect("in time");
        assert!(pace.read(1 << 20, seconds(121)).expect_err("too late").contains("120 s"));
    }
}
