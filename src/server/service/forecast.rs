//! Predicts the time of a job on this machine, and the quality of its table.

use std::{
    num::NonZeroUsize,
    sync::{Mutex, PoisonError},
};

use serde::Serialize;

use super::fitter::PlannedRecipe;
use ltcforge_fit::Solver;

/// The forecast for a job's fit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Expected {
    /// Predicted seconds if all workers of this service fit only this job.
    pub seconds: f64,
    /// Mean error between nodes, relative to the lobe's width.
    pub error: f64,
    /// Bytes of the table's matrices and terms.
    pub bytes: u64,
    /// Number of shards.
    pub shards: u32,
}

/// Predictions of the cost model, corrected with the measured speed of this machine.
#[derive(Debug)]
pub(super) struct Forecast {
    workers: NonZeroUsize,
    /// The speed for each solver, because solvers do different work. Lookup tables have no solver.
    speeds: Mutex<Vec<(Option<Solver>, Speed)>>,
}

/// Predicted and measured seconds on one thread for the latest shards.
#[derive(Debug, Clone, Copy)]
struct Speed {
    predicted: f64,
    measured: f64,
}

/// Weight of the uncorrected prediction, in seconds of work.
const PRIOR_SECONDS: f64 = 0.5;
/// Seconds of work after which older measurements lose their weight.
const MEMORY_SECONDS: f64 = 60.0;

impl Forecast {
    pub(super) fn new(workers: NonZeroUsize) -> Self {
        let prior = Speed { predicted: PRIOR_SECONDS, measured: PRIOR_SECONDS };
        let speeds = Solver::ALL.iter().copied().map(Some).chain([None]).map(|solver| (solver, prior));
        Self { workers, speeds: Mutex::new(speeds.collect()) }
    }

    /// The forecast for a recipe if all workers fit it.
    pub(super) fn of(&self, planned: &PlannedRecipe) -> Expected {
        let model = planned.expectation;
        let seconds = model.seconds * self.ratio(planned.solver()) / self.workers.get() as f64;
        Expected { seconds, error: model.error, bytes: model.bytes, shards: planned.shards() }
    }

    /// Adds a measurement: a worker has fitted the fraction `part` of a recipe's entries in `seconds`.
    pub(super) fn learn(&self, planned: &PlannedRecipe, part: f64, seconds: f64) {
        let predicted = part * planned.expectation.seconds;
        if !(predicted > 0.0 && seconds > 0.0 && predicted.is_finite() && seconds.is_finite()) {
            return;
        }
        let mut speeds = self.speeds.lock().unwrap_or_else(PoisonError::into_inner);
        for (_, speed) in speeds.iter_mut().filter(|(solver, _)| *solver == planned.solver()) {
            let fade = (MEMORY_SECONDS / (speed.predicted + predicted)).min(1.0);
            speed.predicted = fade * (speed.predicted + predicted);
            speed.measured = fade * (speed.measured + seconds);
        }
    }

    /// Measured seconds per predicted second.
    fn ratio(&self, solver: Option<Solver>) -> f64 {
        let speeds = self.speeds.lock().unwrap_or_else(PoisonError::into_inner);
        speeds.iter().find(|(of, _)| *of == solver).map_or(1.0, |(_, speed)| speed.measured / speed.predicted)
    }

    /// The seconds that one core of this machine needs for `predicted` seconds of mixed work.
    pub(super) fn core_seconds(&self, predicted: f64) -> f64 {
        let speeds = self.speeds.lock().unwrap_or_else(PoisonError::into_inner);
        let sum = |of: fn(&Speed) -> f64| speeds.iter().map(|(_, speed)| of(speed)).sum::<f64>();
        predicted * sum(|speed| speed.measured) / sum(|speed| speed.predicted)
    }
}
