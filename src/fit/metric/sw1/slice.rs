//! A target tabulated along one direction.
//!
//! The nodes are at `centre +- width (2^e (1 + k / 16) - 1)`. They are evenly spaced in the lobe's core. In its tails
//! the spacing grows in proportion to the distance from the core. This resolves lobes with a sharp core and far tails.
//! Exponent and mantissa of the f32 number `1 + |x - centre| / width` give the position among the nodes, without a
//! logarithm.

use glam::DVec3;

use super::{
    cells::{CELL_BITS, CELLS, FRACTION_BITS, OCTAVE},
    histogram::{Histogram, Places, WHOLE, split},
};
use crate::metric::target::LobeCore;

/// The size of a cell in fixed-point positions.
const CELL: i32 = 1 << FRACTION_BITS;
/// The bits of 1.0, where positions begin.
const ONE_BITS: i32 = 0x3f80_0000;
/// The largest number of octaves on each side: a tail of 4 million widths.
const MOST_OCTAVES: i32 = 22;
const _: () = assert!((2 * MOST_OCTAVES as usize) << CELL_BITS <= CELLS);

/// The number of partial maxima. Their fixed order lets the compiler use vector instructions.
const LANES: usize = 8;

/// The samples of a target, with one array for each coordinate.
#[derive(Debug, Default)]
pub(super) struct TargetSamples {
    pub(super) x: Vec<f32>,
    pub(super) y: Vec<f32>,
    pub(super) z: Vec<f32>,
    /// Weights as integers, which add up to about [`WHOLE`].
    pub(super) weights: Vec<u32>,
    /// Distances from the centre in widths along the current direction. `places` has the cells.
    distance: Vec<f32>,
    places: Places,
}

impl TargetSamples {
    /// Sets the offsets of a lobe's samples and their weights, which add up to one.
    pub(super) fn fill(&mut self, points: &[DVec3], weights: &[f64]) {
        let coordinate = |to: &mut Vec<f32>, of: fn(&DVec3) -> f64| {
            to.clear();
            to.extend(points.iter().map(|p| of(p) as f32));
        };
        coordinate(&mut self.x, |p| p.x);
        coordinate(&mut self.y, |p| p.y);
        coordinate(&mut self.z, |p| p.z);
        self.weights.clear();
        self.weights.extend(weights.iter().map(|weight| (weight * f64::from(WHOLE) + 0.5) as u32));
        self.distance.resize(points.len(), 0.0);
        self.places.resize(points.len());
    }
}

/// The target along one direction.
#[derive(Debug, Clone)]
pub(super) struct Slice {
    pub(super) direction: [f32; 3],
    centre: f32,
    inv_width: f32,
    /// Fixed-point position of the centre: half the number of cells.
    middle: i32,
    /// G at the node after each cell.
    pub(super) cumulative: Vec<f32>,
    /// Length of each cell in x.
    pub(super) length: Vec<f32>,
}

impl Slice {
    /// Distances of offsets from the centre along the direction, in widths.
    fn distances(&self, [x, y, z]: [&[f32]; 3], distances: &mut [f32]) {
        let [dx, dy, dz] = self.direction;
        for (((x, y), z), distance) in x.iter().zip(y).zip(z).zip(distances) {
            *distance = (dx * x + dy * y + dz * z - self.centre) * self.inv_width;
        }
    }

    /// Fixed-point position of a distance in widths. It is monotonic. Distances beyond the end, and NaN, get the
    /// position just before the last node.
    #[inline]
    fn locate(&self, distance: f32) -> i32 {
        let last = f32::from_bits((ONE_BITS + self.middle - 1) as u32);
        let from_centre = 1.0 + distance.abs();
        let from_centre = if from_centre < last { from_centre } else { last };
        let from_middle = from_centre.to_bits().cast_signed() - ONE_BITS;
        // All ones for a negative distance, else zero. It negates without a branch.
        let sign = distance.to_bits().cast_signed() >> 31;
        ((from_middle ^ sign) - sign) + self.middle
    }

    /// Positions of offsets among the cells.
    pub(super) fn locate_all(&self, [x, y, z]: [&[f32]; 3], places: &mut Places) {
        let [dx, dy, dz] = self.direction;
        let n = x.len();
        let (y, z) = (&y[..n], &z[..n]);
        let (cells, parts) = (&mut places.cells[..n], &mut places.parts[..n]);
        for i in 0..n {
            let position = self.locate((dx * x[i] + dy * y[i] + dz * z[i] - self.centre) * self.inv_width);
            (cells[i], parts[i]) = split(position);
        }
    }

    /// Tabulates a target along `direction`, a unit vector in the frame of its offsets and its core.
    pub(super) fn new(
        target: &mut TargetSamples,
        core: &LobeCore,
        direction: DVec3,
        histogram: &mut Histogram,
    ) -> Self {
        let (centre, width) = core.project(direction);
        let mut slice = Self {
            direction: direction.as_vec3().to_array(),
            centre: centre as f32,
            inv_width: (1.0 / width) as f32,
            middle: i32::MAX - ONE_BITS,
            cumulative: Vec::new(),
            length: Vec::new(),
        };
        let TargetSamples { x, y, z, weights, distance, places } = target;
        slice.distances([x, y, z], distance);
        let farthest = largest(distance);
        // One octave more than the target needs, because an LTC can be wider than the target.
        let octaves = (((1.0 + farthest).to_bits().cast_signed() - ONE_BITS) >> (FRACTION_BITS + CELL_BITS)) + 2;
        let octaves = octaves.min(MOST_OCTAVES);
        let side = octaves << CELL_BITS;
        slice.middle = side * CELL;
        let Places { cells, parts } = places;
        for ((distance, cell), part) in distance.iter().zip(cells).zip(parts) {
            (*cell, *part) = split(slice.locate(*distance));
        }
        histogram.add(places, weights);
        let whole = 1.0 / weights.iter().sum::<u32>() as f32;
        histogram.drain(2 * side as usize);
        slice.cumulative.extend(histogram.below().iter().map(|below| *below as f32 * whole));
        // All cells of an octave have the same length.
        slice.length.resize(2 * side as usize, 0.0);
        let (below, above) = slice.length.split_at_mut(side as usize);
        for (octave, (below, above)) in below.rchunks_mut(OCTAVE).zip(above.chunks_mut(OCTAVE)).enumerate() {
            let cell = (width * f64::from(1_u32 << octave) / OCTAVE as f64) as f32;
            below.fill(cell);
            above.fill(cell);
        }
        slice
    }
}

/// The largest absolute value; zero for an empty slice.
fn largest(values: &[f32]) -> f32 {
    let (chunks, rest) = values.as_chunks::<LANES>();
    let larger = |a: f32, b: f32| if b.abs() > a { b.abs() } else { a };
    let mut lanes = [0.0; LANES];
    for chunk in chunks {
        for (lane, value) in lanes.iter_mut().zip(chunk) {
            *lane = larger(*lane, *value);
        }
    }
    lanes.iter().chain(rest).fold(0.0, |most, value| larger(most, *value))
}
