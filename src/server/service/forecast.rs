//! How long a job is expected to take, and how good its table is expected to be.

use std::{num::NonZeroUsize, sync::Arc};

use super::{Expected, engine::Engine, speed::Speed};
use ltcforge_fit::Solver;

/// Forecasts by the engine's model, corrected by the measured speed of this service.
pub(super) struct Forecast {
    engine: Arc<dyn Engine>,
    workers: NonZeroUsize,
    /// The speed of each solver: they do different work, which machines differ in.
    speeds: Vec<(Solver, Speed)>,
}

impl Forecast {
    pub(super) fn new(engine: Arc<dyn Engine>, workers: NonZeroUsize) -> Self {
        let speeds = Solver::ALL.iter().map(|solver| (*solver, Speed::default())).collect();
        Self { engine, workers, speeds }
    }

    /// The forecast for a stored recipe with all workers on its job; `None` for a recipe of another fitter.
    pub(super) fn of(&self, recipe: &str) -> Option<Expected> {
        let (solver, model) = self.engine.expect(recipe)?;
        let seconds = model.seconds * self.speed(solver)?.ratio();
        Some(Expected { seconds: seconds / self.workers.get() as f64, error: model.error })
    }

    /// Takes a measurement into account: a worker fitted `part` of a recipe's entries in `seconds`.
    pub(super) fn learn(&self, recipe: &str, part: f64, seconds: f64) {
        if let Some((solver, model)) = self.engine.expect(recipe)
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
    use super::{super::engine::FitEngine, *};

    #[test]
    fn a_measurement_changes_the_forecast() {
        let engine = Arc::new(FitEngine::default());
        let recipe = engine.plan(br#"{"preset": "best"}"#, 10_000).expect("a recipe").recipe;
        let (_, model) = engine.expect(&recipe).expect("this fitter's");
        let forecast = Forecast::new(engine, NonZeroUsize::new(2).expect("two"));
        let before = forecast.of(&recipe).expect("this fitter's");
        assert_eq!((before.seconds, before.error), (model.seconds / 2.0, model.error));
        // Half of the entries, at a third of the speed.
        forecast.learn(&recipe, 0.5, 3.0 * 0.5 * model.seconds);
        let after = forecast.of(&recipe).expect("this fitter's");
        // What was believed before still weighs a little.
        assert!((2.7..3.0).contains(&(after.seconds / before.seconds)), "{before:?} {after:?}");
        assert_eq!(after.error, before.error);
        assert!(forecast.of("another fitter's").is_none());
    }

    #[test]
    fn a_solver_s_measurements_do_not_change_the_forecasts_of_another() {
        let engine = Arc::new(FitEngine::default());
        let planned = |document: &str| engine.plan(document.as_bytes(), 10_000).expect("a recipe").recipe;
        let [bfgs, sgd] = ["bfgs", "sgd"].map(|solver| planned(&format!(r#"{{"fit": {{"solver": "{solver}"}}}}"#)));
        let engine: Arc<dyn Engine> = engine;
        let forecast = Forecast::new(engine, NonZeroUsize::MIN);
        let seconds = |recipe: &str| forecast.of(recipe).expect("this fitter's").seconds;
        let before = [seconds(&bfgs), seconds(&sgd)];
        forecast.learn(&sgd, 1.0, 9.0 * before[1]);
        assert_eq!(seconds(&bfgs), before[0]);
        assert!(seconds(&sgd) > 8.0 * before[1]);
    }
}
