//! Looking at jobs.

use super::{Job, JobId, Queue, StateName, jobs::State};
use crate::server::store::{StoreError, Tree};

/// Rows read at a time while a list is filtered.
const PAGE_ROWS: usize = 64;

impl Queue {
    /// A job by its id.
    ///
    /// # Errors
    /// When the database fails.
    pub fn job(&self, id: JobId) -> Result<Option<Job>, StoreError> {
        self.find(&self.lock(), id)
    }

    pub(super) fn find(&self, state: &State, id: JobId) -> Result<Option<Job>, StoreError> {
        if let Some(active) = state.by_id.get(&id).and_then(|submission| state.active.get(submission)) {
            return Ok(Some(active.job()));
        }
        Ok(self.record(state, id)?.map(|record| record.job))
    }

    /// Up to `limit` jobs, last submitted first, below the submission `before`; and the submission to pass for those
    /// that follow.
    ///
    /// # Errors
    /// When the database fails.
    pub fn list(
        &self,
        wanted: Option<StateName>,
        before: Option<u64>,
        limit: usize,
    ) -> Result<(Vec<Job>, Option<u64>), StoreError> {
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

    /// Jobs in each state.
    pub fn counts(&self) -> Vec<(StateName, u64)> {
        let state = self.lock();
        let active =
            |name| state.active.values().filter(|active| active.record.job.state.name() == name).count() as u64;
        let concluded = |name| state.concluded.get(&name).copied().unwrap_or(0);
        let count = |name: StateName| if name.is_final() { concluded(name) } else { active(name) };
        StateName::ALL.iter().map(|name| (*name, count(*name))).collect()
    }

    /// Jobs that wait or run, in the order in which they are worked on.
    pub fn unfinished(&self) -> Vec<Job> {
        self.lock().active.values().map(super::active::Active::job).collect()
    }

    /// Leases that ran out, and steps that failed (those included), since the queue was opened.
    pub fn failures(&self) -> (u64, u64) {
        let state = self.lock();
        (state.leases_expired, state.failures)
    }
}
