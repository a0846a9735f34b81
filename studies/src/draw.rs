//! The random numbers that studies use to draw surfaces and lights.

use std::f64::consts::TAU;

use glam::DVec3;
use rand_core::{Rng as _, SeedableRng as _};
use rand_xoshiro::Xoshiro256PlusPlus;

/// A sequence of random numbers. The same seed gives the same numbers on every machine.
pub(crate) struct Draw(Xoshiro256PlusPlus);

impl Draw {
    pub(crate) fn new(seed: u64) -> Self {
        Self(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    /// A uniform number between `low` and `high`.
    pub(crate) fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64)
    }

    /// A number between `low` and `high` with a uniform logarithm. Domain: bounds above zero.
    pub(crate) fn logarithmic(&mut self, low: f64, high: f64) -> f64 {
        self.within(low.ln(), high.ln()).exp()
    }

    /// A vector of normally distributed numbers.
    pub(crate) fn vector(&mut self) -> DVec3 {
        let mut normal = || (-2.0 * (1.0 - self.within(0.0, 1.0)).ln()).sqrt() * self.within(0.0, TAU).cos();
        DVec3::new(normal(), normal(), normal())
    }
}
