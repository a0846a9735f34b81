//! All entries of a plan on the cores of the current pool.

use std::{
    ops::ControlFlow,
    sync::atomic::{AtomicU64, Ordering},
};

use rayon::prelude::*;

use super::{
    assemble::assemble,
    shard::{Plan, fit_rows},
    table::Table,
};

/// Told how many entries of a table are fitted; may stop the fit. Several threads call it.
pub type Progress<'a> = dyn Fn(u64) -> ControlFlow<()> + Sync + 'a;

/// Fits a whole plan on the current rayon pool, whose size changes nothing; `None` when `progress` stops it.
///
/// `progress` hears the count of finished entries after each of them, and now and then within a long one.
#[must_use]
pub fn fit_plan(plan: &Plan, progress: &Progress) -> Option<Table> {
    let finished = AtomicU64::new(0);
    let fit_row = |row: u64| {
        let mut counted = 0;
        fit_rows(plan, row..row + 1, &mut |done| {
            let new = done - counted;
            counted = done;
            progress(finished.fetch_add(new, Ordering::Relaxed) + new)
        })
    };
    let rows: Vec<u64> = (0..plan.rows()).collect();
    // One row at a time, so that all threads end together; collected in the rows' order, whichever ends first.
    let fitted: Option<Vec<_>> = rows.into_par_iter().with_max_len(1).map(fit_row).collect();
    Some(assemble(plan, &fitted?.concat()))
}
