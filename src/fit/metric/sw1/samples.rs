//! The samples of the clamped cosine.

use glam::DVec3;

use super::histogram::MOST_SAMPLES;
use crate::math::{Lattice, cosine_hemisphere};

/// Each sum is split into this many partial sums, over every eighth term. The number is fixed, so the order of
/// additions does not depend on the processor's vector width.
pub(super) const LANES: usize = 8;
/// Fixed samples of the clamped cosine, with one array for each coordinate. Arrays are padded to a multiple of
/// [`LANES`].
#[derive(Debug, Clone)]
pub(super) struct CosineSamples {
    pub(super) count: usize,
    /// The points of the unit square from which the samples come.
    pub(super) lattice: Lattice,
    pub(super) x: Vec<f32>,
    pub(super) y: Vec<f32>,
    pub(super) z: Vec<f32>,
}

impl CosineSamples {
    /// Maps the points of a lattice with [`cosine_hemisphere`].
    pub(super) fn new(lattice: Lattice) -> Self {
        let points: Vec<DVec3> = lattice.points().map(cosine_hemisphere).collect();
        let count = points.len();
        assert!(count <= MOST_SAMPLES, "{count} samples");
        let coordinate = |of: fn(&DVec3) -> f64| {
            let mut numbers: Vec<f32> = points.iter().map(|c| of(c) as f32).collect();
            numbers.resize(count.next_multiple_of(LANES), 0.0);
            numbers
        };
        let mut z = coordinate(|c| c.z);
        // The padding must consist of valid directions.
        z[count..].fill(1.0);
        Self { count, lattice, x: coordinate(|c| c.x), y: coordinate(|c| c.y), z }
    }
}
