//! What an ended job leaves in the database.

use std::ops::Range;

use super::record::{self, JobRecord};
use crate::{queue::JobId, store::Batch};

/// Tasks whose rows are removed in one transaction.
pub(super) const AT_ONCE: usize = 64;

/// Tasks of an ended job whose rows may still be stored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Remains {
    pub(super) job: JobId,
    tasks: Range<u32>,
}

impl Remains {
    /// Nothing of a job.
    pub(super) fn none(job: JobId) -> Self {
        Self { job, tasks: 0..0 }
    }

    /// All tasks of a job: one more than there are shards, the assembly.
    pub(super) fn of(record: &JobRecord) -> Self {
        Self { job: record.job.id, tasks: 0..record.shards().saturating_add(1) }
    }

    /// Whether there is nothing more to remove.
    pub(super) fn is_empty(&self) -> bool {
        self.tasks.is_empty()
    }

    /// Takes the first tasks and puts the removal of their rows into `batch`.
    pub(super) fn remove_some(&mut self, batch: &mut Batch) {
        for task in self.tasks.by_ref().take(AT_ONCE) {
            record::remove_task(batch, self.job, task);
        }
    }
}
