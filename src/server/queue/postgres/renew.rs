//! Renewing the leases that this process holds.

use std::time::{Duration, Instant};

use super::{fence::Fences, shared::Shared};
use crate::{
    queue::{Lease, StaleLease},
    store::StoreError,
};

/// Leases are renewed this often, or eight times within their duration if that is more often. Most shards take less time.
const RENEWAL: Duration = Duration::from_secs(2);

impl Shared {
    /// Records the entries done so far; the lease is renewed by and by.
    pub(super) fn record_progress(&self, lease: &Lease, entries_done: u64) -> Result<(), StaleLease> {
        if self.is_eager() {
            let renewed = self.renew(&[(*lease, entries_done)]);
            return if renewed.is_ok_and(|renewed| renewed == [*lease]) { Ok(()) } else { Err(StaleLease) };
        }
        self.held.report(lease, entries_done)
    }

    /// Renews the leases whose workers have reported, for as long as the queue is open.
    pub(super) fn renew_for_ever(&self) {
        let every = RENEWAL.min(self.limits.lease_ttl / 8);
        while self.goes_on_after(every / 2) {
            let due = self.held.due(every);
            if due.is_empty() {
                continue;
            }
            let at = Instant::now();
            match self.renew(&due) {
                Ok(renewed) => self.held.settle(&due, &renewed, at),
                // They are tried again; whether they have expired meanwhile, the database tells then.
                Err(error) => tracing::warn!(leases = due.len(), %error, "leases could not be renewed yet"),
            }
        }
    }

    /// Renews leases; returns those that were current.
    fn renew(&self, leases: &[(Lease, u64)]) -> Result<Vec<Lease>, StoreError> {
        let fences = Fences::of(leases.iter().map(|(lease, _)| lease));
        let entries: Vec<i64> = leases.iter().map(|(_, entries)| i64::try_from(*entries).unwrap_or(i64::MAX)).collect();
        self.database.run(async |client| {
            let statement = client.prepare_cached(RENEW).await?;
            let Fences { submissions, tasks, attempts } = &fences;
            let rows =
                client.query(&statement, &[submissions, tasks, attempts, &entries, &self.lease_seconds()]).await?;
            let place = |row: &tokio_postgres::Row| usize::try_from(row.get::<_, i64>(0) - 1).ok();
            Ok(rows.iter().filter_map(|row| Some(leases.get(place(row)?)?.0)).collect())
        })
    }
}

pub(super) const RENEW: &str = "
    UPDATE ltcforge.tasks AS t
    SET lease_until = (SELECT ltcforge.clock()) + make_interval(secs => $5), entries_reported = least(g.entries, t.entries)
    FROM unnest($1::bigint[], $2::integer[], $3::integer[], $4::bigint[]) WITH ORDINALITY
        AS g (submission, task, attempt, entries, place)
    WHERE t.submission = g.submission AND t.task = g.task AND t.attempt = g.attempt
        AND t.lease_until > (SELECT ltcforge.clock())
    RETURNING g.place";
