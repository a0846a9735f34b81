//! The interface of a metric.

use glam::{DMat3, DVec3};

use super::target::Target;
use crate::{brdf::Brdf, math::Lattice, stop_check::StopCheck};

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

/// The lobe that a distance is measured to: its samples, and the BRDF from which they were drawn.
#[derive(Clone, Copy)]
pub(crate) struct Lobe<'a> {
    /// The surface.
    pub(crate) brdf: &'a dyn Brdf,
    /// View direction.
    pub(crate) wo: DVec3,
    /// The lobe's samples.
    pub(crate) target: &'a Target,
}

/// Fresh samples of one step of the published descent, in the tangent frame.
#[derive(Debug, Clone)]
pub(crate) struct Draws {
    /// Directions, drawn with the lobe's density.
    pub(crate) lobe: Vec<DVec3>,
    /// Directions of the clamped cosine, as many.
    pub(crate) cosines: Vec<DVec3>,
    /// Directions to project on.
    pub(crate) directions: Vec<DVec3>,
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

    /// Whether its losses have images, see [`Loss::images`].
    fn compares_images(&self) -> bool {
        false
    }

    /// Seconds of one evaluation, with a gradient or without, for these numbers of samples and directions: of one
    /// thread, on the machine of `fit_seconds`. What an entry is prepared for is in it.
    fn seconds(&self, samples: usize, directions: usize) -> f64;
}

/// A metric with its fixed samples: prepared once for all entries.
pub(crate) trait Distance: std::fmt::Debug + Send + Sync {
    /// The same metric with buffers of its own, for another thread.
    fn another(&self) -> Box<dyn Distance>;

    /// The distance to one lobe; `None` when `stop_check` stops its preparation.
    fn to<'a>(&'a mut self, lobe: &Lobe<'a>, stop_check: &mut StopCheck) -> Option<Box<dyn Loss + 'a>>;
}

/// Offsets of directions from +z, or a gradient by them, one array a coordinate.
pub(crate) type Offsets = [Vec<f32>; 3];

/// The distance between one target and the LTC of a matrix. Evaluations give `None` when `stop_check` stops them.
pub(crate) trait Loss {
    /// Mean standard deviation of the lobe's projections: the unit in which losses are measured.
    fn spread(&self) -> f64;

    /// The distance at `m`, a matrix from cosine space to the lobe's frame with positive determinant.
    fn value(&mut self, m: &DMat3, stop_check: &mut StopCheck) -> Option<f64>;

    /// The distance at `m` and its gradient by the elements of `m`.
    fn value_and_gradient(&mut self, m: &DMat3, grain: Grain, stop_check: &mut StopCheck) -> Option<(f64, DMat3)>;

    /// A step up the distance: `rate` times an estimate, from these samples alone, of its gradient by `m`, a matrix to
    /// the tangent frame whose determinant may have either sign.
    fn step(&self, m: &DMat3, rate: f64, draws: &Draws, stop_check: &mut StopCheck) -> Option<DMat3>;

    /// The same distance of other models than LTCs, where the metric compares samples alone.
    fn images(&mut self) -> Option<&mut dyn ImageLoss> {
        None
    }
}

/// The distance between one lobe and directions that any model maps fixed points to. Evaluations give `None` when
/// `stop_check` stops them.
pub(crate) trait ImageLoss {
    /// The points of the unit square of which an evaluation compares the images.
    fn lattice(&self, grain: Grain) -> Lattice;

    /// The distance of directions, one of each of the points of [`ImageLoss::lattice`], and its gradient by each
    /// direction. Directions are offsets from +z of the lobe's frame, one array a coordinate, and so is the gradient.
    fn slopes(&mut self, offsets: &Offsets, grain: Grain, stop_check: &mut StopCheck) -> Option<(f64, Offsets)>;

    /// The distance of directions alone, with all of the points.
    fn value_of(&mut self, offsets: &Offsets, stop_check: &mut StopCheck) -> Option<f64>;
}
