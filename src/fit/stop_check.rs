//! The progress calls of a long fit, by which it is also stopped.

use std::ops::ControlFlow;

/// Work between two calls: projections of a sample on a direction, 5 to 15 ns each. A call follows after some
/// hundredths of a second, whatever the recipe.
const WORK_PER_CHECK: usize = 1 << 23;

/// Counts the work of a fit and calls back at intervals, so that the caller knows that the fit is alive and can stop
/// it.
pub struct StopCheck<'a> {
    go_on: &'a mut dyn FnMut() -> ControlFlow<()>,
    /// Work since the last call.
    work: usize,
}

impl std::fmt::Debug for StopCheck<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("StopCheck").field("work", &self.work).finish_non_exhaustive()
    }
}

impl<'a> StopCheck<'a> {
    /// Calls `go_on` at intervals.
    pub fn new(go_on: &'a mut dyn FnMut() -> ControlFlow<()>) -> Self {
        Self { go_on, work: 0 }
    }

    /// Counts the projection of `samples` samples on one direction, or work that takes as long; `None` when the caller
    /// wants the fit to stop.
    pub(crate) fn worked(&mut self, samples: usize) -> Option<()> {
        self.work += samples;
        if self.work < WORK_PER_CHECK {
            return Some(());
        }
        self.work = 0;
        (self.go_on)().is_continue().then_some(())
    }
}

/// The work that `fit` counts. Before each call, what it counts beyond the work between two calls is left out.
#[cfg(test)]
pub(crate) fn work_of(fit: impl FnOnce(&mut StopCheck)) -> usize {
    let mut calls = 0;
    let mut go_on = || {
        calls += 1;
        ControlFlow::Continue(())
    };
    let mut stop_check = StopCheck::new(&mut go_on);
    fit(&mut stop_check);
    let rest = stop_check.work;
    calls * WORK_PER_CHECK + rest
}

/// The answer to a fit that nothing stops.
pub(crate) fn unstopped() -> ControlFlow<()> {
    ControlFlow::Continue(())
}
