//! Results on their way into the queue: those that come while others are being stored are stored together.

use std::{
    collections::BTreeMap,
    sync::{Condvar, Mutex, MutexGuard, PoisonError},
};

use crate::queue::{Lease, LeaseError, Queue, StaleLease};

/// Results stored in one transaction, at most.
const AT_ONCE: usize = 64;

/// The results that wait and the answers to those that were stored.
#[derive(Debug, Default)]
pub(super) struct Deliveries {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct State {
    tickets: u64,
    /// By ticket: what waits to be stored.
    waiting: BTreeMap<u64, (Lease, Vec<u8>)>,
    is_storing: bool,
    /// By ticket: what became of it; `None` if it could not be stored with the others.
    stored: BTreeMap<u64, Option<Result<(), StaleLease>>>,
}

impl Deliveries {
    /// Stores a result; it is durable when this returns.
    ///
    /// # Errors
    /// As [`Queue::complete`].
    pub(super) fn deliver(&self, queue: &dyn Queue, lease: Lease, result: &[u8]) -> Result<(), LeaseError> {
        let mut state = self.lock();
        let ticket = state.tickets;
        state.tickets += 1;
        state.waiting.insert(ticket, (lease, result.to_vec()));
        loop {
            match state.stored.remove(&ticket) {
                Some(Some(answer)) => return Ok(answer?),
                // Another's result may have been the reason; this one has an error of its own, or none.
                Some(None) => break,
                None if state.is_storing => {
                    state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
                }
                None => {
                    state.is_storing = true;
                    let mut together = BTreeMap::new();
                    while together.len() < AT_ONCE
                        && let Some((ticket, delivery)) = state.waiting.pop_first()
                    {
                        together.insert(ticket, delivery);
                    }
                    drop(state);
                    let answers = store(queue, &together);
                    state = self.lock();
                    state.is_storing = false;
                    state.stored.extend(together.into_keys().zip(answers));
                    self.changed.notify_all();
                }
            }
        }
        drop(state);
        let answers = queue.complete(&[(lease, result)])?;
        Ok(answers.into_iter().next().unwrap_or(Err(StaleLease))?)
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// What becomes of results that are stored together, in order.
fn store(queue: &dyn Queue, together: &BTreeMap<u64, (Lease, Vec<u8>)>) -> Vec<Option<Result<(), StaleLease>>> {
    let done: Vec<(Lease, &[u8])> = together.values().map(|(lease, result)| (*lease, result.as_slice())).collect();
    match queue.complete(&done) {
        Ok(answers) => answers.into_iter().map(Some).collect(),
        Err(error) => {
            tracing::debug!(%error, results = done.len(), "the results are stored one by one");
            vec![None; done.len()]
        }
    }
}
