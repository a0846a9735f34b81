//! The trees of the database.

/// A tree of the database. The migrations create the trees. The comment of each variant is `key: value`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Tree {
    /// Job id: job and shards.
    Jobs,
    /// Job id and big-endian shard number: result of the finished shard. Deleted when the job ends without a failure.
    Results,
    /// Table digest: row in the list of tables.
    Tables,
    /// Big-endian microseconds since 1970, and table digest: empty value.
    TablesByAge,
    /// Recipe digest: recipe and table digest.
    Recipes,
    /// Table digest: version of the manifest, and manifest.
    Manifests,
    /// BRDF digest: row in the list of BRDFs.
    Brdfs,
}

impl Tree {
    /// All trees.
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
