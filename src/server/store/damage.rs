//! Damage that was found when a store was opened.

use serde::Serialize;

use crate::files::job::listed;

/// Damage that was found when a store was opened.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Damage {
    /// The database was missing, did not open or could not be read, and an empty one took its place.
    pub database_was_replaced: bool,
    /// Rows of the database that do not match their hash. They count as absent.
    pub damaged_rows: usize,
    /// Damaged lines of the journal.
    pub damaged_journal_entries: usize,
    /// The journal is missing, empty or cut short.
    pub journal_is_incomplete: bool,
    /// Ids of jobs that damaged lines name and that no later line has.
    pub lost_jobs: Vec<String>,
}

impl Damage {
    /// Logs all of it.
    pub(super) fn log(&self) {
        if self.database_was_replaced {
            tracing::error!(
                "the database was replaced; the catalogue is made again from the tables, and shards are fitted again"
            );
        }
        if self.damaged_rows > 0 {
            tracing::error!(rows = self.damaged_rows, "rows of the database are damaged; they count as absent");
        }
        if self.damaged_journal_entries > 0 {
            tracing::error!(
                entries = self.damaged_journal_entries,
                "entries of the journal of jobs are damaged; a crash may have cut the last one off before it was acknowledged"
            );
        }
        if self.journal_is_incomplete {
            tracing::error!("the journal of jobs is missing, empty or cut short; the jobs that it had are lost");
        }
        if !self.lost_jobs.is_empty() {
            tracing::error!(
                jobs = listed(&self.lost_jobs),
                "the last change of these jobs is lost; those that are missing can be submitted again"
            );
        }
    }
}
