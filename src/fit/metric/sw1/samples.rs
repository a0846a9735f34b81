//! The samples of the clamped cosine.

use glam::DVec3;

use super::histogram::MOST_SAMPLES;
use crate::math::{Lattice, cosine_hemisphere};

/// Numbers of a sum, each the sum of every eighth summand: the same order whatever vectors the processor has.
pub(super) const LANES: usize = 8;
/// Fixed samples of the clamped cosine, one array a coordinate, filled up with zeros to whole [`LANES`].
#[derive(Debug, Clone)]
pub(super) struct CosineSamples {
    pub(super) count: usize,
    /// The points of the unit square that they are images of.
    pub(super) lattice: Lattice,
    pub(super) x: Vec<f32>,
    pub(super) y: Vec<f32>,
    pub(super) z: Vec<f32>,
}

impl CosineSamples {
    /// The images of a lattice's points under [`cosine_hemisphere`].
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
        // The padding of the arrays is a direction too.
        z[count..].fill(1.0);
        Self { count, lattice, x: coordinate(|c| c.x), y: coordinate(|c| c.y), z }
    }
}
