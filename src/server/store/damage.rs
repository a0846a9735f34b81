//! Damage that was found when a store was opened.

use serde::Serialize;

use ltcforge_files::job::listed;

/// Damage that was found when a store was opened.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Damage {
    /// The database was missing, did not open or could not be read, and an empty one took its place.
    pub database_was_replaced: bool,
    /// Rows of the database that do not match their hash. They count as absent.
    pub damaged_rows: usize,
    /// Damaged lines of the journal.
    pub damaged_journal_entries: usize,
    /// The journal is missing, empty, cut short or something else.
    pub journal_is_incomplete: bool,
    /// Ids of jobs that damaged lines name and that no later line has.
    pub lost_jobs: Vec<String>,
    /// Tables and names of such pins.
    pub lost_pins: Vec<String>,
}

impl Damage {
    /// A sentence for each kind.
    #[must_use]
    pub fn messages(&self) -> Vec<String> {
        let Self { damaged_rows: rows, damaged_journal_entries: entries, .. } = self;
        let mut messages = Vec::new();
        if self.database_was_replaced {
            messages.push(
                "the database is damaged or missing: the catalogue is made again from the tables, and shards of \
                 unfinished jobs are fitted again"
                    .to_owned(),
            );
        }
        if *rows > 0 {
            messages.push(format!("{rows} rows of the database do not match their hash and count as absent"));
        }
        if *entries > 0 {
            messages.push(format!(
                "{entries} entries of the journal of jobs are damaged and left out; a crash may have cut off the last \
                 one before it was acknowledged"
            ));
        }
        if self.journal_is_incomplete {
            messages
                .push("the journal of jobs is missing, empty, cut short or something else: jobs are lost".to_owned());
        }
        if !self.lost_jobs.is_empty() {
            messages.push(format!("jobs whose last change is lost: {}", listed(&self.lost_jobs)));
        }
        if !self.lost_pins.is_empty() {
            messages.push(format!("pins whose last change is lost: {}", listed(&self.lost_pins)));
        }
        messages
    }

    /// Logs all of it.
    pub(super) fn log(&self) {
        for message in self.messages() {
            tracing::error!("{message}");
        }
    }
}
