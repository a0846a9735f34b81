//! Leases as parameters of statements: nothing is written for an attempt that is not the current one.

use crate::queue::Lease;

/// Whether a lease is current: `$1` submission, `$2` task, `$3` attempt.
pub(super) const IS_CURRENT: &str = "
    SELECT is_assembly FROM ltcforge.tasks WHERE submission = $1 AND task = $2 AND attempt = $3
        AND lease_until > (SELECT ltcforge.clock())";

/// The parameters by which a lease is found.
pub(super) fn fence(lease: &Lease) -> (i64, i32, i32) {
    (lease.submission.cast_signed(), lease.task.cast_signed(), lease.attempt.cast_signed())
}

/// The columns of leases, as parameters of a statement.
pub(super) struct Fences {
    pub(super) submissions: Vec<i64>,
    pub(super) tasks: Vec<i32>,
    pub(super) attempts: Vec<i32>,
}

impl Fences {
    pub(super) fn of<'a>(leases: impl Iterator<Item = &'a Lease> + Clone) -> Self {
        Self {
            submissions: leases.clone().map(|lease| lease.submission.cast_signed()).collect(),
            tasks: leases.clone().map(|lease| lease.task.cast_signed()).collect(),
            attempts: leases.map(|lease| lease.attempt.cast_signed()).collect(),
        }
    }
}
