//! Looking jobs up, listing and counting them.

use super::{
    jobs::{EmbeddedQueue, QueueState},
    record::{self, JobRecord},
    task::TaskState,
};
use crate::{
    queue::{Job, JobId, JobPage, StateName},
    store::{StoreError, Tree},
};

/// Rows read at a time while a list is filtered.
const PAGE_ROWS: usize = 64;

impl EmbeddedQueue {
    pub(super) fn find(&self, state: &QueueState, id: JobId) -> Result<Option<Job>, StoreError> {
        if let Some(active) = state.by_id.get(&id).and_then(|submission| state.active.get(submission)) {
            return Ok(Some(active.job()));
        }
        Ok(self.record(state, id)?.map(|record| record.job))
    }

    /// The record of a job in a final state, as it was last stored.
    pub(super) fn record(&self, state: &QueueState, id: JobId) -> Result<Option<JobRecord>, StoreError> {
        if let Some(record) = state.unsaved.get(&id) {
            return Ok(Some(record.clone()));
        }
        match self.rows.get(Tree::Jobs, id.as_bytes()) {
            Ok(value) => Ok(value.and_then(|value| serde_json::from_slice(&value).ok())),
            Err(error @ StoreError::DamagedRow { .. }) => {
                tracing::error!(job = %id, %error, "the job is lost and can be submitted again");
                Ok(None)
            }
            Err(error) => Err(error),
        }
    }

    /// The stored states of a job's tasks; `None` for a damaged row.
    pub(super) fn stored_tasks(&self, id: JobId) -> Result<Vec<(u32, Option<TaskState>)>, StoreError> {
        let rows = self.rows.scan(Tree::Shards, id.as_bytes())?;
        let read = |value: Option<Vec<u8>>| serde_json::from_slice(&value?).ok();
        Ok(rows.into_iter().filter_map(|row| Some((record::task_of_key(&row.key)?, read(row.value)))).collect())
    }

    pub(super) fn list_jobs(
        &self,
        wanted: Option<StateName>,
        before: Option<u64>,
        limit: usize,
    ) -> Result<JobPage, StoreError> {
        let state = self.lock();
        let mut jobs = Vec::new();
        let mut before = before;
        loop {
            let key = before.map(u64::to_be_bytes);
            let rows = self.rows.page(Tree::JobOrder, key.as_ref().map(<[u8; 8]>::as_slice), PAGE_ROWS)?;
            let last_page = rows.len() < PAGE_ROWS;
            for row in rows {
                let Some(submission) = <[u8; 8]>::try_from(row.key.as_slice()).ok().map(u64::from_be_bytes) else {
                    continue;
                };
                if jobs.len() == limit {
                    return Ok((jobs, before));
                }
                before = Some(submission);
                let id = row.value.and_then(|id| JobId::from_slice(&id));
                let Some(job) = id.map(|id| self.find(&state, id)).transpose()?.flatten() else { continue };
                if wanted.is_none_or(|wanted| job.state.name() == wanted) {
                    jobs.push(job);
                }
            }
            if last_page {
                return Ok((jobs, None));
            }
        }
    }

    /// Number of jobs in each state.
    pub(super) fn count_jobs(&self) -> Vec<(StateName, u64)> {
        let state = self.lock();
        let active =
            |name| state.active.values().filter(|active| active.record.job.state.name() == name).count() as u64;
        let concluded = |name| state.concluded.get(&name).copied().unwrap_or(0);
        let count = |name: StateName| if name.is_final() { concluded(name) } else { active(name) };
        StateName::ALL.iter().map(|name| (*name, count(*name))).collect()
    }
}
