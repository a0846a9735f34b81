//! The signal of life of a long fit, by which it is also stopped.

use std::ops::ControlFlow;

/// Work between two beats: projections of a sample on a direction, 5 to 15 ns each. A beat follows after some hundredths
/// of a second, whatever the recipe.
const WORK_PER_BEAT: usize = 1 << 23;

/// Counts the work of a fit and calls back at intervals, so that the caller knows that the fit is alive and can stop it.
pub struct Pulse<'a> {
    beat: &'a mut dyn FnMut() -> ControlFlow<()>,
    /// Work since the last beat.
    work: usize,
}

impl std::fmt::Debug for Pulse<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Pulse").field("work", &self.work).finish_non_exhaustive()
    }
}

impl<'a> Pulse<'a> {
    /// A pulse that calls `beat`.
    pub fn new(beat: &'a mut dyn FnMut() -> ControlFlow<()>) -> Self {
        Self { beat, work: 0 }
    }

    /// Counts the projection of `samples` samples on one direction, or what takes as long; `None` when the caller wants
    /// the fit to stop.
    pub(crate) fn worked(&mut self, samples: usize) -> Option<()> {
        self.work += samples;
        if self.work < WORK_PER_BEAT {
            return Some(());
        }
        self.work = 0;
        (self.beat)().is_continue().then_some(())
    }
}

/// The work that `fit` counts. What it counts beyond a beat's work before each beat is left out.
#[cfg(test)]
pub(crate) fn work_of(fit: impl FnOnce(&mut Pulse)) -> usize {
    let mut beats = 0;
    let mut beat = || {
        beats += 1;
        ControlFlow::Continue(())
    };
    let mut pulse = Pulse::new(&mut beat);
    fit(&mut pulse);
    let rest = pulse.work;
    beats * WORK_PER_BEAT + rest
}

/// The beat of a fit that nothing stops.
pub(crate) fn unstopped() -> ControlFlow<()> {
    ControlFlow::Continue(())
}
