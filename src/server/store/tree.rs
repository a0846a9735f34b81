//! The trees of the database.

/// A tree of the database. `migrations/` creates the trees. Each variant documents its key and value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Tree {
    /// Job id: the job and its shards.
    Jobs,
    /// Job id and shard number, big-endian: the result of a finished shard, until the job ends.
    Results,
    /// Table digest: its row in the list of tables.
    Tables,
    /// Microseconds since 1970, big-endian, and table digest: no value.
    TablesByAge,
    /// Recipe digest: the recipe and its table.
    Recipes,
    /// Table digest: the version of its manifest, and the manifest.
    Manifests,
    /// BRDF digest: its row in the list of BRDFs.
    Brdfs,
}

impl Tree {
    /// Every tree.
    pub const ALL: [Self; 7] =
        [Self::Jobs, Self::Results, Self::Tables, Self::TablesByAge, Self::Recipes, Self::Manifests, Self::Brdfs];

    /// The tree's name in the database.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Jobs => "jobs",
            Self::Results => "results",
            Self::Tables => "tables",
            Self::TablesByAge => "tables_by_age",
            Self::Recipes => "recipes",
            Self::Manifests => "manifests",
            Self::Brdfs => "brdfs",
        }
    }
}
