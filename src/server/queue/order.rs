//! The order in which tasks are leased: a virtual clock.
//!
//! The tag of a shard is base + predicted seconds of its job's earlier shards; that of the assembly is base + all seconds.
//! base is the time of submission, but at most 50 ms above the smallest waiting tag. The smallest (tag, submission, task)
//! is leased first: a small job starts at once, long jobs share evenly, and no job starves, since new tags are above the
//! smallest one. A clock that is set changes the order only.

use super::Shard;

/// How far above the smallest waiting tag a new job starts, at most, in microseconds.
const AHEAD: i64 = 50_000;

/// The base of a new job at `now`, in microseconds; `first` is the smallest waiting tag.
pub(super) fn base(now: i64, first: Option<i64>) -> i64 {
    first.map_or(now, |first| now.min(first.saturating_add(AHEAD)))
}

/// The tag of each shard, then that of the assembly, in microseconds. Finished shards take no time.
pub(super) fn tags(base: i64, shards: &[Shard], is_finished: impl Fn(u32) -> bool) -> Vec<i64> {
    let mut tags = Vec::with_capacity(shards.len() + 1);
    let mut tag = base;
    for (number, shard) in (0..).zip(shards) {
        tags.push(tag);
        if !is_finished(number) {
            // A cast saturates, and that of NaN is 0.
            tag = tag.saturating_add((shard.seconds.max(0.0) * 1e6) as i64);
        }
    }
    tags.push(tag);
    tags
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tags_add_up_and_a_base_is_just_above_the_smallest() {
        let shards = [1.0, f64::NAN, 0.5, -1.0].map(|seconds| Shard { entries: 1, seconds });
        assert_eq!(tags(7, &shards, |_| false), [7, 1_000_007, 1_000_007, 1_500_007, 1_500_007]);
        assert_eq!(tags(7, &shards, |number| number == 0), [7, 7, 7, 500_007, 500_007]);
        assert_eq!(tags(7, &[Shard { entries: 1, seconds: f64::INFINITY }], |_| false), [7, i64::MAX]);
        assert_eq!(base(100_000_000, None), 100_000_000);
        assert_eq!(base(100_000_000, Some(5)), 50_005);
        assert_eq!(base(3, Some(i64::MAX)), 3);
    }
}
