//! Forgetting jobs that ended long ago.

use super::shared::Shared;
use crate::store::StoreError;

impl Shared {
    /// Removes the rows of jobs that ended longer ago than the limit, now and then. A failure is logged: the caller does not
    /// depend on it.
    pub(super) fn keep_house(&self) {
        if !self.housekeeping_is_due() {
            return;
        }
        let Some(keep) = self.limits.keep_ended else { return };
        match self.forget_ended(keep.as_secs_f64()) {
            Ok(0) => {}
            Ok(jobs) => tracing::info!(jobs, "jobs that ended long ago were forgotten"),
            Err(error) => tracing::warn!(%error, "old jobs could not be forgotten"),
        }
    }

    fn forget_ended(&self, seconds: f64) -> Result<i64, StoreError> {
        self.database.run(async |client| {
            let forget = "
                WITH old AS (
                    SELECT submission FROM ltcforge.jobs
                    WHERE finished_at < (SELECT ltcforge.clock()) - make_interval(secs => $1)
                    FOR UPDATE SKIP LOCKED
                ), jobs AS (
                    DELETE FROM ltcforge.jobs WHERE submission IN (SELECT submission FROM old)
                ), tasks AS (
                    DELETE FROM ltcforge.tasks WHERE submission IN (SELECT submission FROM old)
                ), blocks AS (
                    DELETE FROM ltcforge.blocks WHERE submission IN (SELECT submission FROM old)
                )
                SELECT count(*) FROM old";
            Ok(client.query_one(&client.prepare_cached(forget).await?, &[&seconds]).await?.get(0))
        })
    }
}
