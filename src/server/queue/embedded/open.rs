//! Opens the queue with the jobs and results of the last process.

use std::{
    collections::HashMap,
    sync::{Arc, Condvar, Mutex},
};

use super::{
    Clock, EmbeddedQueue,
    record::{Entry, Record, parse_result_key},
    state::State,
};
use crate::{
    queue::{JobId, JobState, Limits},
    store::{Batch, Rows, StoreError, Tree},
};

/// Number of results that are read at a time.
const PAGE: usize = 256;

impl EmbeddedQueue {
    /// Opens the queue in `rows`. Unfinished jobs of another fitter version start again.
    ///
    /// # Errors
    /// When the rows cannot be read or written.
    pub fn open(rows: Arc<dyn Rows>, limits: Limits, fitter: u32) -> Result<Self, StoreError> {
        Self::open_with(rows, limits, fitter, Clock::default())
    }

    pub(in crate::queue) fn open_with(
        rows: Arc<dyn Rows>,
        limits: Limits,
        fitter: u32,
        clock: Clock,
    ) -> Result<Self, StoreError> {
        let mut batch = Batch::default();
        let mut records: HashMap<JobId, (Record, Vec<u32>)> = HashMap::new();
        for (key, value) in rows.scan(Tree::Jobs, &[])? {
            match serde_json::from_slice::<Record>(&value) {
                Ok(record) => drop(records.insert(record.job.id, (record, vec![]))),
                Err(error) => {
                    tracing::error!(%error, ?key, "the row of a job cannot be read; the job is removed");
                    batch.remove(Tree::Jobs, key);
                }
            }
        }
        let mut state = State::new();
        let mut before: Option<Vec<u8>> = None;
        loop {
            let page = rows.page(Tree::Results, before.as_deref(), PAGE)?;
            let Some((last, _)) = page.last() else { break };
            before = Some(last.clone());
            for (key, _) in page {
                let shard = parse_result_key(&key).and_then(|(id, shard)| records.get_mut(&id).zip(Some(shard)));
                match shard.filter(|((record, _), shard)| keeps(record, *shard, fitter)) {
                    Some(((_, finished), shard)) => finished.push(shard),
                    None => batch.remove(Tree::Results, key),
                }
            }
            if !batch.is_empty() {
                rows.commit(&std::mem::take(&mut batch))?;
            }
        }
        for (mut record, mut finished) in records.into_values() {
            // Pages are in descending order of keys.
            finished.reverse();
            if record.job.state.name().is_final() {
                state.insert(Entry::ended(record, finished));
                continue;
            }
            if record.fitter != fitter {
                record.fitter = fitter;
                record.put(&mut batch)?;
            }
            state.insert(Entry::unfinished(record, &finished));
        }
        let now = (clock.wall)();
        loop {
            for submission in state.forgettable(&limits, now) {
                state.jobs.get(&submission).into_iter().for_each(|entry| entry.remove(&mut batch));
                state.remove(submission);
            }
            if batch.is_empty() {
                break;
            }
            rows.commit(&std::mem::take(&mut batch))?;
        }
        let (writer, state) = (Mutex::new(()), Mutex::new(state));
        Ok(Self { rows, limits, clock, writer, state, changed: Condvar::new() })
    }
}

/// Whether a stored result can still be used.
fn keeps(record: &Record, shard: u32, fitter: u32) -> bool {
    let is_shard = (shard as usize) < record.shards.len();
    match record.job.state {
        JobState::Queued | JobState::Running => is_shard && record.fitter == fitter,
        JobState::Failed { .. } => is_shard,
        JobState::Done { .. } | JobState::Cancelled => false,
    }
}
