//! The leases that this process holds.

use std::{
    collections::HashMap,
    sync::{Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

use crate::queue::{Lease, StaleLease};

/// Leases of this process.
#[derive(Debug, Default)]
pub(super) struct Held(Mutex<HashMap<Lease, Holding>>);

#[derive(Debug)]
struct Holding {
    entries_done: u64,
    renewed: Instant,
    /// Whether its worker has reported since it was renewed.
    is_worked_on: bool,
    is_lost: bool,
}

impl Held {
    fn lock(&self) -> MutexGuard<'_, HashMap<Lease, Holding>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn add(&self, leases: impl Iterator<Item = Lease>) {
        let renewed = Instant::now();
        let new = |lease| (lease, Holding { entries_done: 0, renewed, is_worked_on: false, is_lost: false });
        self.lock().extend(leases.map(new));
    }

    pub(super) fn remove(&self, lease: &Lease) {
        self.lock().remove(lease);
    }

    /// Voids the leases of a submission.
    pub(super) fn lose(&self, submission: u64) {
        let mut held = self.lock();
        held.iter_mut()
            .filter(|(lease, _)| lease.submission == submission)
            .for_each(|(_, holding)| holding.is_lost = true);
    }

    pub(super) fn report(&self, lease: &Lease, entries_done: u64) -> Result<(), StaleLease> {
        let mut held = self.lock();
        let holding = held.get_mut(lease).filter(|holding| !holding.is_lost).ok_or(StaleLease)?;
        holding.entries_done = entries_done;
        holding.is_worked_on = true;
        Ok(())
    }

    pub(super) fn due(&self, after: Duration) -> Vec<(Lease, u64)> {
        let held = self.lock();
        let is_due =
            |holding: &&Holding| holding.is_worked_on && !holding.is_lost && after <= holding.renewed.elapsed();
        let due = held.iter().filter(|(_, holding)| is_due(holding));
        due.map(|(lease, holding)| (*lease, holding.entries_done)).collect()
    }

    pub(super) fn settle(&self, asked: &[(Lease, u64)], renewed: &[Lease], at: Instant) {
        let mut held = self.lock();
        for (lease, _) in asked {
            let Some(holding) = held.get_mut(lease) else { continue };
            if renewed.contains(lease) {
                holding.renewed = at;
                holding.is_worked_on = false;
            } else {
                holding.is_lost = true;
            }
        }
    }
}
