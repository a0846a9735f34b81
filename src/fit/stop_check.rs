//! The progress callbacks of a long fit. A callback can also stop the fit.

use std::ops::ControlFlow;

/// The work between two calls, in projections of a sample on a direction. A projection takes 5 to 15 ns, so for every
/// recipe the time between calls is about 0.04 to 0.13 s.
const WORK_PER_CHECK: usize = 1 << 23;

/// Counts the work of a fit and calls back at intervals. The caller then knows that the fit is running, and can stop
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
    /// Counts work for the callback `go_on`.
    pub fn new(go_on: &'a mut dyn FnMut() -> ControlFlow<()>) -> Self {
        Self { go_on, work: 0 }
    }

    /// Counts the projection of `samples` samples on one direction, or equivalent work; `None` if the caller stops the
    /// fit.
    pub(crate) fn worked(&mut self, samples: usize) -> Option<()> {
        self.work += samples;
        if self.work < WORK_PER_CHECK {
            return Some(());
        }
        self.work = 0;
        (self.go_on)().is_continue().then_some(())
    }
}

/// The work that `fit` counts. Excess work before a call is not counted.
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

/// A callback that never stops the fit.
pub(crate) fn unstopped() -> ControlFlow<()> {
    ControlFlow::Continue(())
}
