//! The leases that this process holds, and their renewal.

use std::{
    collections::HashMap,
    sync::{Mutex, MutexGuard, PoisonError, mpsc},
    time::{Duration, Instant},
};

use super::Process;
use crate::{
    queue::{Lease, StaleLease},
    store::{Database, StoreError},
};

/// The interval of renewals, unless an eighth of a lease's duration is shorter. Most shards take less time.
const RENEWAL: Duration = Duration::from_secs(2);

pub(super) const RENEW: &str = "
    UPDATE ltcforge.tasks AS t
    SET entries_reported = least(g.entries, t.entries),
        lease_until = (SELECT ltcforge.clock()) + make_interval(secs => $5)
    FROM unnest($1::bigint[], $2::integer[], $3::text[], $4::bigint[]) WITH ORDINALITY
        AS g (submission, task, worker, entries, n)
    WHERE t.submission = g.submission AND t.task = g.task AND t.worker = g.worker
        AND t.lease_until > (SELECT ltcforge.clock())
    RETURNING g.n - 1";

/// Leases of this process.
#[derive(Debug, Default)]
pub(super) struct Held(Mutex<HashMap<Lease, Progress>>);

#[derive(Debug)]
struct Progress {
    entries_done: u64,
    renewed: Instant,
    /// Whether its worker has reported since then.
    is_reported: bool,
}

impl Held {
    fn lock(&self) -> MutexGuard<'_, HashMap<Lease, Progress>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn add(&self, leases: impl Iterator<Item = Lease>) {
        let renewed = Instant::now();
        self.lock().extend(leases.map(|lease| (lease, Progress { entries_done: 0, renewed, is_reported: false })));
    }

    pub(super) fn remove(&self, lease: &Lease) {
        self.lock().remove(lease);
    }

    /// Removes the leases of a submission, which are void.
    pub(super) fn remove_all(&self, submission: u64) {
        self.lock().retain(|lease, _| lease.submission != submission);
    }

    /// Records the entries done so far; the lease is renewed later.
    pub(super) fn report(&self, lease: &Lease, entries_done: u64) -> Result<(), StaleLease> {
        let mut held = self.lock();
        let progress = held.get_mut(lease).ok_or(StaleLease)?;
        progress.entries_done = entries_done;
        progress.is_reported = true;
        Ok(())
    }

    /// Renews the leases whose workers have reported, until `ended` has no sender any more.
    pub(super) fn renew_until(
        &self,
        ended: &mpsc::Receiver<()>,
        database: &Database,
        process: &Process,
        lease_ttl: Duration,
    ) {
        let every = RENEWAL.min(lease_ttl / 8);
        while ended.recv_timeout(every / 2) == Err(mpsc::RecvTimeoutError::Timeout) {
            let is_due = |progress: &Progress| progress.is_reported && every <= progress.renewed.elapsed();
            let due: Vec<(Lease, u64)> = (self.lock().iter())
                .filter(|(_, progress)| is_due(progress))
                .map(|(lease, progress)| (*lease, progress.entries_done))
                .collect();
            if due.is_empty() {
                continue;
            }
            let at = Instant::now();
            match renew(database, process, &due, lease_ttl) {
                Ok(renewed) => {
                    let mut held = self.lock();
                    for (lease, _) in &due {
                        if !renewed.contains(lease) {
                            held.remove(lease);
                        } else if let Some(progress) = held.get_mut(lease) {
                            (progress.renewed, progress.is_reported) = (at, false);
                        }
                    }
                }
                // They are renewed the next time, if they have not expired by then.
                Err(error) => tracing::warn!(leases = due.len(), %error, "leases could not be renewed yet"),
            }
        }
    }
}

/// Renews leases; returns those that were current.
pub(super) fn renew(
    database: &Database,
    process: &Process,
    leases: &[(Lease, u64)],
    lease_ttl: Duration,
) -> Result<Vec<Lease>, StoreError> {
    let (submissions, tasks, names): (Vec<_>, Vec<_>, Vec<_>) =
        leases.iter().map(|(lease, _)| process.fence(lease)).collect();
    let entries: Vec<i64> = leases.iter().map(|(_, entries)| i64::try_from(*entries).unwrap_or(i64::MAX)).collect();
    let rows = database.run(async |client| {
        let statement = client.prepare_cached(RENEW).await?;
        let seconds = lease_ttl.as_secs_f64();
        Ok(client.query(&statement, &[&submissions, &tasks, &names, &entries, &seconds]).await?)
    })?;
    let place = |row: &tokio_postgres::Row| usize::try_from(row.get::<_, i64>(0)).ok();
    Ok(rows.iter().filter_map(|row| Some(leases.get(place(row)?)?.0)).collect())
}
