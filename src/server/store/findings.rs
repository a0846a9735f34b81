//! What was wrong with a store when it was opened.

use serde::Serialize;

use ltcforge_files::job::listed;

/// What was wrong with a store when it was opened.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Findings {
    /// The database was missing, did not open or could not be read: a part of it, or an empty one, took its place. Jobs that
    /// the end of the journal has lost as well leave no trace.
    pub database_was_replaced: bool,
    /// The journal goes on where the database ends. Jobs that the end of the journal has lost as well leave no trace.
    pub database_is_older: bool,
    /// Rows that do not match their seal. They count as absent.
    pub damaged_rows: usize,
    /// Rows of jobs that the database had lost, or had as they once were, and that the journal had.
    pub restored_rows: usize,
    /// Ids of the jobs that the database had lost.
    pub restored_jobs: Vec<String>,
    /// Ids of the jobs that the database had as they once were: queued instead of cancelled, or not yet forgotten.
    pub reverted_jobs: Vec<String>,
    /// Ids of jobs that there were, and that neither the database nor the journal has whole.
    pub lost_jobs: Vec<String>,
    /// Ids that damaged entries of the journal name and that no job has. Either the job is lost, or the id is misread.
    pub doubtful_jobs: Vec<String>,
    /// Damaged entries of the journal.
    pub damaged_journal_entries: usize,
    /// The journal is missing, empty, or lacks entries: whether the database has lost or reverted jobs cannot be proved.
    pub journal_is_incomplete: bool,
}

impl Findings {
    /// Logs all that was wrong.
    pub(super) fn log(&self) {
        if self.database_was_replaced {
            tracing::error!(
                "the database was replaced; jobs are restored from their journal, and those that its end has lost as well \
                 are lost"
            );
        }
        if self.database_is_older && !self.database_was_replaced {
            tracing::error!(
                "the database is older than the journal of jobs; jobs that the end of the journal has lost as well \
                 leave no trace"
            );
        }
        if self.damaged_rows > 0 {
            tracing::error!(rows = self.damaged_rows, "rows of the database do not match their seal");
        }
        if self.restored_rows > 0 {
            tracing::error!(
                rows = self.restored_rows,
                jobs = listed(&self.restored_jobs),
                "the database had lost or reverted rows of jobs; they are restored from the journal"
            );
        }
        if !self.reverted_jobs.is_empty() {
            tracing::error!(
                jobs = listed(&self.reverted_jobs),
                "the database had these jobs as they once were; they are as the journal has them"
            );
        }
        if self.damaged_journal_entries > 0 {
            tracing::error!(
                entries = self.damaged_journal_entries,
                "entries of the journal of jobs are damaged; a job that the database lacks as well is lost"
            );
        }
        if self.journal_is_incomplete {
            tracing::error!(
                "the journal of jobs is missing, empty or incomplete; whether the database has lost or reverted \
                 jobs cannot be proved"
            );
        }
        if !self.lost_jobs.is_empty() {
            tracing::error!(jobs = listed(&self.lost_jobs), "these jobs are lost and can be submitted again");
        }
        if !self.doubtful_jobs.is_empty() {
            tracing::error!(
                jobs = listed(&self.doubtful_jobs),
                "damaged entries of the journal name these jobs, which are nowhere else; they may be lost, or an id may \
                 be misread"
            );
        }
    }
}
