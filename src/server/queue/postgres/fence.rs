//! Leases as parameters of statements: nothing is written under a lease that is not the current one.

use deadpool_postgres::GenericClient;

use super::Process;
use crate::queue::Lease;

/// Whether a lease is current: `$1` submission, `$2` task, `$3` name. Selects whether it is the assembly's.
pub(super) const IS_CURRENT: &str = "
    SELECT is_assembly FROM ltcforge.tasks
    WHERE submission = $1 AND task = $2 AND worker = $3 AND lease_until > (SELECT ltcforge.clock())";

impl Process {
    /// The name of a lease in the column `worker`. No other lease has it, of this process or another, nor had before
    /// the database was restored.
    pub(super) fn lease_name(&self, name: u64) -> String {
        format!("{}/{name:016x}", self.name)
    }

    /// Submission, task and name, by which a lease is found.
    pub(super) fn fence(&self, lease: &Lease) -> (i64, i32, String) {
        (lease.submission.cast_signed(), lease.task.cast_signed(), self.lease_name(lease.name))
    }

    /// Whether a current lease is of the assembly; `None` if the lease is not current.
    pub(super) async fn is_of_assembly(
        &self,
        client: &impl GenericClient,
        lease: &Lease,
    ) -> Result<Option<bool>, tokio_postgres::Error> {
        let (submission, task, name) = self.fence(lease);
        let row = client.query_opt(&client.prepare_cached(IS_CURRENT).await?, &[&submission, &task, &name]).await?;
        Ok(row.map(|row| row.get(0)))
    }
}
