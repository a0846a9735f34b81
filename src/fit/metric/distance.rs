//! The interface of a metric.

use glam::{DMat3, DVec3};

use super::target::Target;
use crate::{brdf::Brdf, math::Lattice, stop_check::StopCheck};

/// The fixed samples of a metric.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Samples {
    /// Samples of the LTC in each evaluation.
    pub(crate) count: usize,
    /// Directions of the projections.
    pub(crate) directions: usize,
    /// Cyclic shift of the sample sequences, in [0, 1).
    pub(crate) shift: [f64; 2],
}

/// The lobe to which distances are measured: its samples, and the BRDF from which they come.
#[derive(Clone, Copy)]
pub(crate) struct Lobe<'a> {
    /// The surface.
    pub(crate) brdf: &'a dyn Brdf,
    /// View direction.
    pub(crate) wo: DVec3,
    /// The lobe's samples.
    pub(crate) target: &'a Target,
}

/// New samples for one step of the published descent, in the tangent frame.
#[derive(Debug, Clone)]
pub(crate) struct Draws {
    /// Directions, drawn with the lobe's density.
    pub(crate) lobe: Vec<DVec3>,
    /// The same number of directions, drawn from the clamped cosine.
    pub(crate) cosines: Vec<DVec3>,
    /// Directions of the projections.
    pub(crate) directions: Vec<DVec3>,
}

/// The precision of an evaluation of the distance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Grain {
    /// Some of the samples and directions, for an eighth of the work. A coarse search ends close to the minimum.
    Coarse,
    /// All samples and directions.
    Full,
}

/// A metric as an item of [`super::Metric`].
pub(crate) trait MetricRules: Sync {
    /// The metric with these samples.
    fn distance(&self, samples: &Samples) -> Box<dyn Distance>;

    /// True if its losses implement [`Loss::images`].
    fn compares_images(&self) -> bool {
        false
    }

    /// Seconds of one evaluation, with or without a gradient, for these numbers of samples and directions. Measured
    /// with one thread on the machine of `fit_seconds`. The preparation of an entry is included.
    fn seconds(&self, samples: usize, directions: usize) -> f64;
}

/// A metric with its fixed samples, prepared once for all entries.
pub(crate) trait Distance: std::fmt::Debug + Send + Sync {
    /// The same metric with separate buffers, for another thread.
    fn another(&self) -> Box<dyn Distance>;

    /// The distance to one lobe; `None` if `stop_check` stops its preparation.
    fn to<'a>(&'a mut self, lobe: &Lobe<'a>, stop_check: &mut StopCheck) -> Option<Box<dyn Loss + 'a>>;
}

/// Offsets of directions from +z, or the gradient with respect to them, with one array for each coordinate.
pub(crate) type Offsets = [Vec<f32>; 3];

/// The distance between one target and the LTC of a matrix. Evaluations return `None` if `stop_check` stops them.
pub(crate) trait Loss {
    /// The width of the lobe's core. It is the unit of losses.
    fn spread(&self) -> f64;

    /// The distance at `m`, a matrix from cosine space to the lobe's frame with a positive determinant.
    fn value(&mut self, m: &DMat3, stop_check: &mut StopCheck) -> Option<f64>;

    /// The distance at `m` and its gradient with respect to the elements of `m`.
    fn value_and_gradient(&mut self, m: &DMat3, grain: Grain, stop_check: &mut StopCheck) -> Option<(f64, DMat3)>;

    /// `rate` times the gradient of the distance with respect to `m`, estimated from `draws` alone. `m` maps to the
    /// tangent frame, and its determinant can have either sign.
    fn step(&self, m: &DMat3, rate: f64, draws: &Draws, stop_check: &mut StopCheck) -> Option<DMat3>;

    /// The same distance for models other than LTCs; `None` unless the metric compares only samples.
    fn images(&mut self) -> Option<&mut dyn ImageLoss> {
        None
    }
}

/// The distance between one lobe and the images of fixed points under the map of any model. Evaluations return `None`
/// if `stop_check` stops them.
pub(crate) trait ImageLoss {
    /// The points of the unit square whose images an evaluation compares.
    fn lattice(&self, grain: Grain) -> Lattice;

    /// The distance between the lobe and directions, one for each point of [`ImageLoss::lattice`], and its gradient
    /// with respect to each direction. Directions and gradient are offsets from +z of the lobe's frame, with one array
    /// for each coordinate.
    fn slopes(&mut self, offsets: &Offsets, grain: Grain, stop_check: &mut StopCheck) -> Option<(f64, Offsets)>;

    /// The distance between the lobe and directions for all points, without the gradient.
    fn value_of(&mut self, offsets: &Offsets, stop_check: &mut StopCheck) -> Option<f64>;
}
