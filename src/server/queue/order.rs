//! The order in which tasks are leased. A virtual clock determines it.
//!
//! The tag of a shard is the base of its job plus the predicted seconds of the job up to and including this shard. The
//! tag of the assembly is the base plus the seconds of all shards. The task with the smallest (tag, submission, task)
//! is leased first.
//!
//! The base is the time of submission, but at most 5 ms after the virtual time. The virtual time is the latest start
//! (tag - seconds) of a leased task. If no task is leased, it is the start of the first waiting task. It is never
//! before the base of an unfinished job. As a result, a small job starts next, long jobs share the workers evenly, and
//! no job starves, because each new job advances the virtual time by up to 5 ms. A change of the system clock affects
//! only the order of tasks.

use super::Shard;

/// Maximum difference between the base of a new job and the virtual time, in microseconds.
const AHEAD: i64 = 5_000;

/// Maximum predicted time of a shard, in microseconds.
const MOST: f64 = 1e15;

/// The predicted time of a shard in microseconds.
pub(super) fn microseconds(shard: &Shard) -> i64 {
    // NaN becomes 0.
    (shard.seconds * 1e6).clamp(0.0, MOST) as i64
}

/// The base of a new job at `now`, in microseconds. `virtual_time` is `None` if there are no unfinished jobs.
pub(super) fn base(now: i64, virtual_time: Option<i64>) -> i64 {
    virtual_time.map_or(now, |time| now.min(time.saturating_add(AHEAD)))
}

/// The tags of the shards and of the assembly, in microseconds. Finished shards add no time.
pub(super) fn tags(base: i64, shards: &[Shard], is_finished: impl Fn(u32) -> bool) -> Vec<i64> {
    let mut tags = Vec::with_capacity(shards.len() + 1);
    let mut tag = base;
    for (number, shard) in (0..).zip(shards) {
        if !is_finished(number) {
            tag = tag.saturating_add(microseconds(shard));
        }
        tags.push(tag);
    }
    tags.push(tag);
    tags
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tags_add_up_and_a_base_is_just_after_the_virtual_time() {
        let shards = [1.0, f64::NAN, 0.5, -1.0].map(|seconds| Shard { entries: 1, seconds });
        assert_eq!(tags(7, &shards, |_| false), [1_000_007, 1_000_007, 1_500_007, 1_500_007, 1_500_007]);
        assert_eq!(tags(7, &shards, |number| number == 0), [7, 7, 500_007, 500_007, 500_007]);
        assert_eq!(tags(7, &[Shard { entries: 1, seconds: f64::INFINITY }; 2], |_| false)[1], 2 * MOST as i64 + 7);
        assert_eq!(base(100_000_000, None), 100_000_000);
        assert_eq!(base(100_000_000, Some(5)), 5_005);
        assert_eq!(base(3, Some(i64::MAX)), 3);
    }
}
