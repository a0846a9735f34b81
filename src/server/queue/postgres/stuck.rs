//! Jobs that would wait for ever.

use std::collections::BTreeSet;

use super::PostgresQueue;
use crate::{queue::JobId, store::StoreError};

impl PostgresQueue {
    /// Queued and running jobs that no worker would ever end: nobody serves them, or shards of theirs have no row.
    ///
    /// # Errors
    /// When the database fails.
    pub fn stuck(&self) -> Result<BTreeSet<JobId>, StoreError> {
        // One statement, so that no other process changes anything in between.
        let stuck = "
            SELECT id FROM ltcforge.jobs AS j WHERE state IN ('queued', 'running') AND (
                NOT EXISTS (SELECT FROM ltcforge.serving AS s WHERE s.submission = j.submission)
                OR (SELECT count(*) FROM ltcforge.tasks AS t WHERE t.submission = j.submission)
                    + (SELECT coalesce(sum(past - next), 0) FROM ltcforge.blocks AS b WHERE b.submission = j.submission)
                    <> j.shards + 1)";
        let rows =
            self.database.run(async |client| Ok(client.query(&client.prepare_cached(stuck).await?, &[]).await?))?;
        Ok(rows.iter().filter_map(|row| JobId::from_slice(row.get(0))).collect())
    }
}
