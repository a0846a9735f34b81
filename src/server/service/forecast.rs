//! How long a job is expected to take, and how good its table is expected to be.

use std::{num::NonZeroUsize, sync::Arc};

use super::{
    Expected,
    backend::{Backend, ExpectedFit, StoredRecipe},
    speed::Speed,
};
use ltcforge_fit::Solver;

/// Forecasts by the backend's model, corrected by the measured speed of this service.
pub(super) struct Forecast {
    backend: Arc<dyn Backend>,
    workers: NonZeroUsize,
    /// The speed of each solver: how fast a machine is depends on the work that it does.
    speeds: Vec<(Solver, Speed)>,
}

impl Forecast {
    pub(super) fn new(backend: Arc<dyn Backend>, workers: NonZeroUsize) -> Self {
        let speeds = Solver::ALL.iter().map(|solver| (*solver, Speed::default())).collect();
        Self { backend, workers, speeds }
    }

    /// The forecast for a stored recipe with all workers on its job; `None` for a recipe of another fitter.
    pub(super) fn of(&self, recipe: StoredRecipe<'_>) -> Option<Expected> {
        let whole = self.on_one_core(recipe)?;
        Some(Expected { seconds: whole.seconds / self.workers.get() as f64, ..whole })
    }

    /// The forecast for a stored recipe with one core on its job; `None` for a recipe of another fitter.
    pub(super) fn on_one_core(&self, recipe: StoredRecipe<'_>) -> Option<Expected> {
        let ExpectedFit { solver, shards, model } = self.backend.expect(recipe)?;
        let seconds = model.seconds * self.speed(solver)?.ratio();
        Some(Expected { seconds, error: model.error, bytes: model.bytes, shards })
    }

    /// Takes a measurement into account: a worker fitted `part` of a recipe's entries in `seconds`.
    pub(super) fn learn(&self, recipe: StoredRecipe<'_>, part: f64, seconds: f64) {
        if let Some(ExpectedFit { solver, model, .. }) = self.backend.expect(recipe)
            && let Some(speed) = self.speed(solver)
        {
            speed.learn(part * model.seconds, seconds);
        }
    }

    fn speed(&self, solver: Solver) -> Option<&Speed> {
        self.speeds.iter().find(|(of, _)| *of == solver).map(|(_, speed)| speed)
    }
}

#[cfg(test)]
mod tests {
    use super::{super::backend::FitBackend, *};
    use crate::queue::NewJob;
    use ltcforge_files::digest::Digest;

    #[test]
    fn a_measurement_changes_the_forecast() {
        let backend = Arc::new(FitBackend::new(None));
        let job = backend.plan(br#"{"preset": "best"}"#, 10_000).expect("a recipe");
        let ExpectedFit { model, .. } = backend.expect((&job).into()).expect("this fitter's");
        let forecast = Forecast::new(backend, NonZeroUsize::new(2).expect("two"));
        let before = forecast.of((&job).into()).expect("this fitter's");
        assert_eq!((before.seconds, before.error), (model.seconds / 2.0, model.error));
        // Half of the entries, at a third of the speed.
        forecast.learn((&job).into(), 0.5, 3.0 * 0.5 * model.seconds);
        let after = forecast.of((&job).into()).expect("this fitter's");
        // The earlier estimate still weighs a little.
        assert!((2.7..3.0).contains(&(after.seconds / before.seconds)), "{before:?} {after:?}");
        assert_eq!(after.error, before.error);
        let text = "another fitter's";
        assert!(forecast.of(StoredRecipe { digest: Digest::of(text.as_bytes()), text }).is_none());
    }

    #[test]
    fn a_solver_s_measurements_do_not_change_the_forecasts_of_another() {
        let backend: Arc<dyn Backend> = Arc::new(FitBackend::new(None));
        let planned = |document: &str| backend.plan(document.as_bytes(), 10_000).expect("a recipe");
        let [bfgs, sgd] = ["bfgs", "sgd"].map(|solver| planned(&format!(r#"{{"fit": {{"solver": "{solver}"}}}}"#)));
        let forecast = Forecast::new(backend, NonZeroUsize::MIN);
        let seconds = |job: &NewJob| forecast.of(job.into()).expect("this fitter's").seconds;
        let before = [seconds(&bfgs), seconds(&sgd)];
        forecast.learn((&sgd).into(), 1.0, 9.0 * before[1]);
        assert_eq!(seconds(&bfgs), before[0]);
        assert!(seconds(&sgd) > 8.0 * before[1]);
    }
}
