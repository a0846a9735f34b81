//! Fits all entries of a plan on the threads of the current pool.

use std::{
    ops::ControlFlow,
    sync::atomic::{AtomicU64, Ordering},
};

use rayon::prelude::*;

use super::{
    assemble::assemble,
    entry::{FittedEntry, Fitter},
    shard::{Plan, fit_rows},
    table::Table,
};

/// A callback that receives the number of fitted entries and can stop the fit. Several threads call it.
pub type Progress<'a> = dyn Fn(u64) -> ControlFlow<()> + Sync + 'a;

/// Fits a whole plan on the current rayon pool. The size of the pool does not change the result. Returns `None` if
/// `progress` stops the fit.
///
/// `progress` receives the number of finished entries after each entry, and at intervals within a long entry.
#[must_use]
pub fn fit_plan(plan: &Plan, progress: &Progress) -> Option<Table> {
    Some(assemble(plan, &fit_entries(plan, progress)?))
}

/// The fitted entries of a whole plan, before [`fit_plan`] assembles them.
#[must_use]
pub fn fit_entries(plan: &Plan, progress: &Progress) -> Option<Vec<FittedEntry>> {
    let finished = AtomicU64::new(0);
    let fitter = Fitter::new(&plan.recipe().fit).of(plan.recipe().lobe);
    let fit_row = |row: u64| {
        let mut counted = 0;
        fit_rows(plan, row..row + 1, &mut fitter.another(), &mut |done| {
            let new = done - counted;
            counted = done;
            progress(finished.fetch_add(new, Ordering::Relaxed) + new)
        })
    };
    let rows: Vec<u64> = (0..plan.rows()).collect();
    // Threads take one row at a time, so all threads end at about the same time. The results are in the order of the
    // rows, whichever row ends first.
    let fitted: Option<Vec<_>> = rows.into_par_iter().with_max_len(1).map(fit_row).collect();
    Some(fitted?.concat())
}
