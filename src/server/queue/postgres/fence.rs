//! Leases as parameters of statements: nothing is written for an attempt that is not the current one.

use deadpool_postgres::GenericClient;

use crate::queue::Lease;

/// Submission, task and attempt, by which a lease is found.
pub(super) fn fence(lease: &Lease) -> (i64, i32, i32) {
    (lease.submission.cast_signed(), lease.task.cast_signed(), lease.attempt.cast_signed())
}

/// Whether a lease is current: `$1` submission, `$2` task, `$3` attempt. Selects whether it is the assembly's.
pub(super) const IS_CURRENT: &str = "
    SELECT is_assembly FROM ltcforge.tasks
    WHERE submission = $1 AND task = $2 AND attempt = $3 AND lease_until > (SELECT ltcforge.clock())";

/// Whether a current lease is of the assembly; `None` if the lease is not current.
pub(super) async fn is_of_assembly(
    client: &impl GenericClient,
    lease: &Lease,
) -> Result<Option<bool>, tokio_postgres::Error> {
    let (submission, task, attempt) = fence(lease);
    let row = client.query_opt(&client.prepare_cached(IS_CURRENT).await?, &[&submission, &task, &attempt]).await?;
    Ok(row.map(|row| row.get(0)))
}
