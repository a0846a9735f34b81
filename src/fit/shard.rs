//! The unit of leasing and of resuming: a fixed run of entries.

use std::ops::{ControlFlow, Range};

use super::Recipe;
use crate::ltc::Table;

/// One fitted configuration, before alignment and storage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FittedEntry {
    /// `M`, row-major.
    pub matrix: [f64; 9],
    /// Directional albedo for a Fresnel factor of one.
    pub amplitude: f64,
    /// Its part weighted by Schlick's fifth power.
    pub fresnel: f64,
    /// Sliced Wasserstein error on samples and directions that the fit did not see.
    pub error: f64,
}

/// A recipe's nodes and how they are cut into shards; the recipe alone decides both.
#[derive(Debug, Clone)]
pub struct Plan {
    recipe: Recipe,
}

impl Plan {
    /// The plan of a recipe that has passed [`crate::recipe::check`].
    #[must_use]
    pub fn new(recipe: &Recipe) -> Self {
        Self { recipe: recipe.clone() }
    }

    /// The recipe that is planned.
    #[must_use]
    pub fn recipe(&self) -> &Recipe {
        &self.recipe
    }

    /// Number of shards.
    #[must_use]
    pub fn shards(&self) -> u32 {
        todo!()
    }

    /// The entries of `shard`, as indices in storage order.
    #[must_use]
    pub fn shard_entries(&self, _shard: u32) -> Range<u64> {
        todo!()
    }
}

/// Fits the entries of `shard` in storage order.
///
/// `after_row` is told after every few entries how many of the shard's entries are done, and may stop the fit:
/// then the result is `None` and nothing of the shard is kept.
pub fn fit_shard(
    _plan: &Plan,
    _shard: u32,
    _after_row: &mut dyn FnMut(u64) -> ControlFlow<()>,
) -> Option<Vec<FittedEntry>> {
    todo!()
}

/// Aligns, normalises and rounds all entries of a plan, given in storage order, into its table.
#[must_use]
pub fn assemble(_plan: &Plan, _entries: &[FittedEntry]) -> Table {
    todo!()
}

/// Bytes that are not the result of a shard of the expected length.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("a shard of {expected} bytes was expected, {actual} were found")]
pub struct ShardBytesError {
    /// Bytes that the shard's entries take.
    pub expected: usize,
    /// Bytes that there are.
    pub actual: usize,
}

/// A finished shard as bytes: 12 little-endian f64 an entry (matrix, amplitude, Fresnel, error).
#[must_use]
pub fn shard_to_bytes(_entries: &[FittedEntry]) -> Vec<u8> {
    todo!()
}

/// The inverse of [`shard_to_bytes`].
///
/// # Errors
/// When `bytes` is not exactly `entries` entries long.
pub fn shard_from_bytes(_bytes: &[u8], _entries: usize) -> Result<Vec<FittedEntry>, ShardBytesError> {
    todo!()
}
