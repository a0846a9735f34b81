//! Shards that were never leased, as runs.

use std::collections::HashSet;

/// Shards of a block, at most. Transactions that lease from one job at the same time each take from a block of their own.
const BLOCK: usize = 64;

/// The blocks of a job, as columns for a statement: the first shard, the one past the last, and the entries of each shard.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Blocks {
    pub(super) first: Vec<i32>,
    pub(super) past: Vec<i32>,
    pub(super) entries: Vec<i32>,
}

impl Blocks {
    /// The blocks of all shards but the `finished` ones: runs of shards with equally many entries.
    pub(super) fn of(shard_entries: &[u32], finished: &HashSet<u32>) -> Self {
        let integer = |number: u32| i32::try_from(number).unwrap_or(i32::MAX);
        let mut blocks = Self::default();
        let waiting = (0..).zip(shard_entries).filter(|(shard, _)| !finished.contains(shard));
        for (shard, entries) in waiting.map(|(shard, entries)| (integer(shard), integer(*entries))) {
            if let (Some(first), Some(past), Some(of_block)) =
                (blocks.first.last(), blocks.past.last_mut(), blocks.entries.last())
                && *past == shard
                && *of_block == entries
                && usize::try_from(shard - first).is_ok_and(|shards| shards < BLOCK)
            {
                *past += 1;
            } else {
                blocks.first.push(shard);
                blocks.past.push(shard + 1);
                blocks.entries.push(entries);
            }
        }
        blocks
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_runs_of_equal_shards_without_the_finished_ones() {
        let mut entries = vec![64; 130];
        entries[129] = 7;
        let whole = Blocks::of(&entries, &HashSet::new());
        let expected = (vec![0, 64, 128, 129], vec![64, 128, 129, 130], vec![64, 64, 64, 7]);
        assert_eq!((whole.first, whole.past, whole.entries), expected);
        let rest = Blocks::of(&entries, &(1..128).collect());
        assert_eq!((rest.first, rest.past, rest.entries), (vec![0, 128, 129], vec![1, 129, 130], vec![64, 64, 7]));
        assert_eq!(Blocks::of(&[], &HashSet::new()), Blocks::default());
    }
}
