//! The trees of the database.

/// A tree of the current schema; `migrations/` creates them. Each variant says what key and value are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Tree {
    /// Job id: the job. Its rows are in the journal; sled has those of earlier versions, until the store is opened.
    Jobs,
    /// Job id and shard number, big-endian: the shard's state.
    Shards,
    /// Job id and shard number, big-endian: a finished shard's bytes, until the table is stored.
    Results,
    /// Table digest: its row in the catalogue.
    Tables,
    /// Microseconds since 1970, big-endian, and table digest: empty.
    TablesByAge,
    /// Recipe digest: the recipe and its table.
    Recipes,
    /// Table digest: the version of its manifest, and the manifest.
    Manifests,
    /// Table digest and a pin's name: who pinned the table, and when. Its rows are in the journal: nothing else has them.
    Pins,
    /// File digest: when it was last used; of a table that was removed, when, why and of which recipe.
    Uses,
}

impl Tree {
    /// Every tree.
    pub const ALL: [Self; 9] = [
        Self::Jobs,
        Self::Shards,
        Self::Results,
        Self::Tables,
        Self::TablesByAge,
        Self::Recipes,
        Self::Manifests,
        Self::Pins,
        Self::Uses,
    ];

    /// Whether the journal of a data folder has its rows, and not the database, which can be lost.
    pub(super) fn is_journalled(self) -> bool {
        matches!(self, Self::Jobs | Self::Pins)
    }

    /// The tree's name in the database.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Jobs => "numbered_jobs",
            Self::Shards => "shards",
            Self::Results => "results",
            Self::Tables => "tables",
            Self::TablesByAge => "tables_by_age",
            Self::Recipes => "recipes",
            Self::Manifests => "manifests",
            Self::Pins => "pins",
            Self::Uses => "uses",
        }
    }
}
