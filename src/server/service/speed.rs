//! How fast this machine fits, measured on the shards that it has fitted.

use std::sync::{Mutex, PoisonError};

/// The ratio of measured to predicted seconds of a thread, over the latest shards.
///
/// The constants of the cost model are those of one machine; this factor adapts them to another.
#[derive(Debug)]
pub(super) struct Speed(Mutex<Sums>);

#[derive(Debug, Clone, Copy)]
struct Sums {
    predicted: f64,
    measured: f64,
}

/// Weight of the uncorrected prediction, as seconds of work: those of a few shards.
const PRIOR_SECONDS: f64 = 0.5;
/// Seconds of work after which older measurements fade.
const MEMORY_SECONDS: f64 = 60.0;

impl Default for Speed {
    fn default() -> Self {
        Self(Mutex::new(Sums { predicted: PRIOR_SECONDS, measured: PRIOR_SECONDS }))
    }
}

impl Speed {
    /// Takes a measurement into account, in seconds of one thread. Values that are not positive and finite are ignored.
    pub(super) fn learn(&self, predicted: f64, measured: f64) {
        if !(predicted > 0.0 && measured > 0.0 && predicted.is_finite() && measured.is_finite()) {
            return;
        }
        let mut sums = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let fade = (MEMORY_SECONDS / (sums.predicted + predicted)).min(1.0);
        sums.predicted = fade * (sums.predicted + predicted);
        sums.measured = fade * (sums.measured + measured);
    }

    /// Measured seconds per predicted second.
    pub(super) fn ratio(&self) -> f64 {
        let sums = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        sums.measured / sums.predicted
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ratio_moves_from_one_to_the_measured_one_and_forgets() {
        let speed = Speed::default();
        assert_eq!(speed.ratio(), 1.0);
        for (predicted, measured) in [(0.0, 1.0), (1.0, f64::NAN), (f64::INFINITY, 1.0), (1.0, -1.0)] {
            speed.learn(predicted, measured);
        }
        assert_eq!(speed.ratio(), 1.0);
        for _ in 0..100 {
            speed.learn(1.0, 3.0);
        }
        assert!((speed.ratio() - 3.0).abs() < 0.05, "{}", speed.ratio());
        for _ in 0..300 {
            speed.learn(1.0, 0.5);
        }
        assert!((speed.ratio() - 0.5).abs() < 0.05, "{}", speed.ratio());
    }
}
