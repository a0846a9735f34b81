//! How long a job is expected to take, and how good its table is expected to be.

use std::{num::NonZeroUsize, sync::Arc};

use super::{Expected, engine::Engine, speed::Speed};

/// Forecasts by the engine's model, corrected by the measured speed of this service.
pub(super) struct Forecast {
    engine: Arc<dyn Engine>,
    workers: NonZeroUsize,
    speed: Speed,
}

impl Forecast {
    pub(super) fn new(engine: Arc<dyn Engine>, workers: NonZeroUsize) -> Self {
        Self { engine, workers, speed: Speed::default() }
    }

    /// The forecast for a stored recipe with all workers on its job; `None` for a recipe of another fitter.
    pub(super) fn of(&self, recipe: &str) -> Option<Expected> {
        let model = self.engine.expect(recipe)?;
        Some(Expected { seconds: model.seconds * self.speed.ratio() / self.workers.get() as f64, error: model.error })
    }

    /// Takes a measurement into account: a worker fitted `part` of a recipe's entries in `seconds`.
    pub(super) fn learn(&self, recipe: &str, part: f64, seconds: f64) {
        if let Some(model) = self.engine.expect(recipe) {
            self.speed.learn(part * model.seconds, seconds);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{super::engine::FitEngine, *};

    #[test]
    fn a_measurement_changes_the_forecast() {
        let engine = Arc::new(FitEngine::default());
        let recipe = engine.plan(br#"{"preset": "best"}"#, 10_000).expect("a recipe").recipe;
        let model = engine.expect(&recipe).expect("this fitter's");
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
}
