//! The trees of the database.

/// A tree of the current schema; `migrations/` creates them. Each variant says what key and value are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Tree {
    /// Job id: the job. The journal puts the revision of the last change in front of it.
    Jobs,
    /// Submission number, big-endian: job id. The journal puts the revision of the last change in front of it.
    JobOrder,
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
    /// `last`: the last entry of the journal of jobs.
    Journal,
}

impl Tree {
    /// Every tree.
    pub const ALL: [Self; 9] = [
        Self::Jobs,
        Self::JobOrder,
        Self::Shards,
        Self::Results,
        Self::Tables,
        Self::TablesByAge,
        Self::Recipes,
        Self::Manifests,
        Self::Journal,
    ];

    /// The tree's name in the database.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Jobs => "numbered_jobs",
            Self::JobOrder => "numbered_job_order",
            Self::Shards => "shards",
            Self::Results => "results",
            Self::Tables => "tables",
            Self::TablesByAge => "tables_by_age",
            Self::Recipes => "recipes",
            Self::Manifests => "manifests",
            Self::Journal => "journal",
        }
    }
}
