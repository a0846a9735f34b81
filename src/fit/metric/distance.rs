//! The interface of a metric.

use glam::{DMat3, DVec3};

use super::target::Target;
use crate::fit::{brdf::Brdf, pulse::Pulse};

/// The fixed samples of a metric.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Samples {
    /// Samples of the LTC in each evaluation.
    pub(crate) count: usize,
    /// Directions that the samples are projected on.
    pub(crate) directions: usize,
    /// Shift of the sample sequences, parts of a turn.
    pub(crate) shift: [f64; 2],
}

/// The lobe that a distance is measured to: its samples, and what they were drawn from.
#[derive(Clone, Copy)]
pub(crate) struct Lobe<'a> {
    /// The surface.
    pub(crate) brdf: &'a dyn Brdf,
    /// View direction.
    pub(crate) wo: DVec3,
    /// The lobe's samples.
    pub(crate) target: &'a Target,
}

/// How finely a distance is evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Grain {
    /// With a part of the samples and directions: an eighth of the work, for the way to the minimum.
    Coarse,
    /// With all of them.
    Full,
}

/// A metric as an item of [`super::Metric`].
pub(crate) trait MetricRules: Sync {
    /// The metric over these samples.
    fn distance(&self, samples: &Samples) -> Box<dyn Distance>;

    /// Seconds of one evaluation, with a gradient or without, for these numbers of samples and directions: of one thread,
    /// on the machine of `fit_seconds`. What an entry is prepared for is in it.
    fn seconds(&self, samples: usize, directions: usize) -> f64;
}

/// A metric with its fixed samples: prepared once for all entries.
pub(crate) trait Distance: std::fmt::Debug + Send + Sync {
    /// The same metric with buffers of its own, for another thread.
    fn another(&self) -> Box<dyn Distance>;

    /// The distance to one lobe; `None` when `pulse` stops its preparation.
    fn to<'a>(&'a mut self, lobe: &Lobe<'a>, pulse: &mut Pulse) -> Option<Box<dyn Loss + 'a>>;
}

/// The distance between one target and the LTC of a matrix. Evaluations give `None` when `pulse` stops them.
pub(crate) trait Loss {
    /// Mean standard deviation of the lobe's projections: the unit in which losses are measured.
    fn spread(&self) -> f64;

    /// The distance at `m`, a matrix from cosine space to the lobe's frame with positive determinant.
    fn value(&mut self, m: &DMat3, pulse: &mut Pulse) -> Option<f64>;

    /// The distance at `m` and its gradient by the elements of `m`.
    fn value_and_gradient(&mut self, m: &DMat3, grain: Grain, pulse: &mut Pulse) -> Option<(f64, DMat3)>;
}
