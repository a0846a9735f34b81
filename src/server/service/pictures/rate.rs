//! How fast pictures are rendered, measured on those that were.

use std::time::{Duration, Instant};

/// Seconds per unit of cost before anything was measured. Nothing is refused by it: a scene is measured by a probe before it
/// is rendered, and a plot takes seconds on any machine.
const INITIAL: f64 = 1e-9;
/// A picture of this cost weighs as much as all before it: the default reference of 512 x 512 pixels, 64 samples each.
const HALF_COST: f64 = 16_777_216.0;
/// Seconds that do not grow with the cost, at most: opening a device, compiling shaders, reading back.
const FIXED_SECONDS: f64 = 0.25;
/// Time in which what the rate is above that of the probe halves if nothing confirms it. A slow hour of the machine would
/// otherwise have large pictures refused for ever, as none would be rendered that shows the contrary.
const FADE: Duration = Duration::from_secs(600);
/// A picture that was given up is taken to need so many times the time that it had.
const GIVEN_UP_FACTOR: f64 = 2.0;

/// Seconds per unit of cost, as an exponential mean. The weight of a picture grows with its cost, since the time of a
/// small one is mostly not its pixels'.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rate {
    mean: f64,
    /// What the mean fades to: the probe's rate, or that of a picture that was faster since.
    floor: f64,
    measured: Instant,
    /// A probe, or a picture that weighs as much as all before it, was measured.
    is_known: bool,
}

/// What a picture took.
#[derive(Debug, Clone, Copy)]
pub(super) enum Took {
    /// It was finished in this time.
    Finished(Duration),
    /// It was given up after this time, all that it had.
    GivenUp(Duration),
    /// Nobody waited for it any more after this time. How much was still to do is not known.
    Abandoned(Duration),
}

impl Rate {
    pub(super) fn new(now: Instant) -> Self {
        Self { mean: INITIAL, floor: 0.0, measured: now, is_known: false }
    }

    /// The rate that a probe measured. Domain: positive and finite.
    pub(super) fn probed(rate: f64, now: Instant) -> Self {
        Self { mean: rate, floor: rate, measured: now, is_known: true }
    }

    /// Whether it was measured.
    pub(super) fn is_known(&self) -> bool {
        self.is_known
    }

    /// Predicted seconds of a picture.
    pub(super) fn seconds(&self, cost: f64, now: Instant) -> f64 {
        cost * self.faded(now)
    }

    /// Takes a measurement into account. A finished picture tells the rate between two bounds, with and without the
    /// seconds that do not grow with the cost; within them the mean stays what it is. A cost that is not positive and
    /// finite is ignored.
    pub(super) fn learn(&mut self, cost: f64, took: Took, now: Instant) {
        if !(cost > 0.0 && cost.is_finite()) {
            return;
        }
        let before = self.faded(now);
        let least = |time: Duration| (time.as_secs_f64() - FIXED_SECONDS).max(0.0) / cost;
        let told = match took {
            Took::Finished(time) => before.clamp(least(time), time.as_secs_f64() / cost),
            Took::GivenUp(time) => before.max(GIVEN_UP_FACTOR * time.as_secs_f64() / cost),
            Took::Abandoned(time) => before.max(least(time)),
        };
        // As in a least-squares fit of a line, what a point tells of the slope grows with its distance squared.
        let weight = cost * cost / (cost * cost + HALF_COST * HALF_COST);
        let (mean, is_finished) = (before + weight * (told - before), matches!(took, Took::Finished(_)));
        let floor = if is_finished { self.floor.min(mean) } else { self.floor };
        let is_known = self.is_known || (weight >= 0.5 && !matches!(took, Took::Abandoned(_)));
        *self = Self { mean, floor, measured: now, is_known };
    }

    fn faded(&self, now: Instant) -> f64 {
        let age = now.saturating_duration_since(self.measured);
        self.floor + (self.mean - self.floor) * libm::exp2(-age.as_secs_f64() / FADE.as_secs_f64())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: Duration = Duration::from_secs(1);
    /// The largest picture: mode `strip`, 2048 x 2048, 4096 samples a pixel.
    const LARGEST: f64 = 2048.0 * 2048.0 * (4096.0 + 8.0);

    #[test]
    fn nothing_is_slow_before_it_is_measured() {
        let now = Instant::now();
        let rate = Rate::new(now);
        let seconds = rate.seconds(LARGEST, now);
        assert!(!rate.is_known() && (17.0..18.0).contains(&seconds), "{seconds}");
    }

    #[test]
    fn a_probe_s_rate_does_not_fade_and_faster_pictures_lower_it() {
        let now = Instant::now();
        let mut rate = Rate::probed(1e-7, now);
        assert!(rate.is_known());
        let seconds = rate.seconds(LARGEST, now + 100 * FADE);
        assert!((1700.0..1800.0).contains(&seconds), "{seconds}");
        rate.learn(LARGEST, Took::GivenUp(1000 * SECOND), now);
        let (at_once, later) = (rate.seconds(LARGEST, now), rate.seconds(LARGEST, now + 20 * FADE));
        assert!(at_once > 1900.0 && (later / seconds - 1.0).abs() < 1e-3, "{at_once} {later}");
        for _ in 0..20 {
            rate.learn(1e9, Took::Finished(10 * SECOND), now);
        }
        let seconds = rate.seconds(1e9, now + 20 * FADE);
        assert!((9.0..=10.1).contains(&seconds), "{seconds}");
    }

    #[test]
    fn only_a_large_picture_makes_a_rate_known() {
        let now = Instant::now();
        let known = |cost, took| {
            let mut rate = Rate::new(now);
            rate.learn(cost, took, now);
            rate.is_known()
        };
        assert!(known(HALF_COST, Took::Finished(SECOND)));
        assert!(!known(HALF_COST / 2.0, Took::Finished(SECOND)));
        assert!(known(LARGEST, Took::GivenUp(SECOND)));
        assert!(!known(LARGEST, Took::Abandoned(SECOND)));
    }

    #[test]
    fn an_abandoned_picture_tells_the_least_that_it_takes() {
        let now = Instant::now();
        let mut rate = Rate::new(now);
        let before = rate.seconds(LARGEST, now);
        rate.learn(LARGEST, Took::Abandoned(SECOND), now);
        assert_eq!(rate.seconds(LARGEST, now), before, "the prediction was longer");
        rate.learn(LARGEST, Took::Abandoned(25 * SECOND), now);
        let seconds = rate.seconds(LARGEST, now);
        assert!((24.5..25.0).contains(&seconds), "{seconds}");
    }

    #[test]
    fn the_mean_moves_to_what_large_pictures_take() {
        let now = Instant::now();
        let mut rate = Rate::new(now);
        for _ in 0..20 {
            rate.learn(1e8, Took::Finished(Duration::from_secs(3)), now);
        }
        let seconds = rate.seconds(1e8, now);
        assert!((2.7..=3.0).contains(&seconds), "{seconds}");
        for _ in 0..20 {
            rate.learn(1e8, Took::Finished(SECOND), now);
        }
        let seconds = rate.seconds(1e8, now);
        assert!((0.74..=1.01).contains(&seconds), "{seconds}");
        let before = rate.seconds(1.0, now);
        for cost in [0.0, f64::NAN, f64::INFINITY, -1.0] {
            rate.learn(cost, Took::Finished(SECOND), now);
        }
        assert_eq!(rate.seconds(1.0, now), before);
    }

    /// A GPU takes a while for its first picture, and a few milliseconds for the smallest one.
    #[test]
    fn small_pictures_do_not_make_large_ones_seem_slow() {
        let now = Instant::now();
        let mut rate = Rate::new(now);
        rate.learn(64.0 * 64.0 * 8.0, Took::Finished(SECOND), now);
        for _ in 0..1000 {
            rate.learn(64.0 * 64.0 * 8.0, Took::Finished(Duration::from_millis(20)), now);
            rate.learn(512.0 * 512.0 * 8.0, Took::Finished(Duration::from_millis(30)), now);
        }
        let seconds = rate.seconds(LARGEST, now);
        assert!((10.0..30.0).contains(&seconds), "{seconds}");
    }

    #[test]
    fn a_large_picture_that_was_given_up_is_predicted_to_take_longer_than_it_had() {
        let now = Instant::now();
        let mut rate = Rate::new(now);
        rate.learn(LARGEST, Took::GivenUp(30 * SECOND), now);
        let seconds = rate.seconds(LARGEST, now);
        assert!((55.0..=60.0).contains(&seconds), "{seconds}");
        // It was a small one: something else took the time.
        let mut rate = Rate::new(now);
        rate.learn(64.0 * 64.0 * 8.0, Took::GivenUp(30 * SECOND), now);
        let seconds = rate.seconds(HALF_COST, now);
        assert!(seconds < 1.0, "{seconds}");
    }

    #[test]
    fn what_nothing_confirms_fades() {
        let now = Instant::now();
        let mut rate = Rate::new(now);
        rate.learn(LARGEST, Took::GivenUp(30 * SECOND), now);
        let (at_once, later) = (rate.seconds(LARGEST, now), rate.seconds(LARGEST, now + 2 * FADE));
        assert!((at_once / later - 4.0).abs() < 1e-9, "{at_once} {later}");
    }
}
