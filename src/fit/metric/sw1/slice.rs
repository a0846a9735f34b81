//! A target along one direction, tabulated.
//!
//! The nodes lie at `centre +- width (2^e (1 + k / 32) - 1)`: evenly spaced in the lobe's core, and in its tails spaced
//! in proportion to the distance from the core, so that lobes with a sharp core and far tails lose neither. The
//! exponent and mantissa of the f32 number `1 + |x - centre| / width` give the position among the nodes; no logarithm
//! is taken.

use glam::DVec3;

use crate::fit::metric::target::Target;

/// Mantissa bits that number the cells of an octave: 32 cells, a core cell is 1/32 of the lobe's width.
const CELL_BITS: u32 = 5;
/// Mantissa bits that are left for the position inside a cell.
const FRACTION_BITS: u32 = f32::MANTISSA_DIGITS - 1 - CELL_BITS;
/// One cell in the fixed-point positions.
const CELL: i32 = 1 << FRACTION_BITS;
/// Bits of 1.0, where positions start.
const ONE_BITS: i32 = 0x3f80_0000;
/// Most octaves on each side, so that positions fit an i32: a tail of 4 million widths.
const MOST_OCTAVES: i32 = 22;

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
    /// Projection of an offset on the direction.
    #[inline]
    pub(super) fn project(&self, x: f32, y: f32, z: f32) -> f32 {
        self.direction[0] * x + self.direction[1] * y + self.direction[2] * z
    }

    /// Fixed-point position of a projection. Monotonic; projections off the end are put just before the last node.
    #[inline]
    pub(super) fn locate(&self, x: f32) -> i32 {
        let y = (x - self.centre) * self.inv_width;
        let from_middle = ((1.0 + y.abs()).to_bits().cast_signed() - ONE_BITS).min(self.middle - 1);
        // All ones for a negative y, else zero: negates without a branch.
        let sign = y.to_bits().cast_signed() >> 31;
        ((from_middle ^ sign) - sign) + self.middle
    }

    /// Tabulates `target` along `direction`, a unit vector in the lobe's frame.
    pub(super) fn new(target: &Target, direction: DVec3) -> Self {
        let (centre, width) = target.core.project(direction);
        let mut slice = Self {
            direction: direction.as_vec3().to_array(),
            centre: centre as f32,
            inv_width: (1.0 / width) as f32,
            middle: i32::MAX,
            cumulative: Vec::new(),
            length: Vec::new(),
        };
        let project = |slice: &Self, p: &DVec3| {
            let [x, y, z] = p.as_vec3().to_array();
            slice.project(x, y, z)
        };
        let distance = |p: &DVec3| (project(&slice, p) - slice.centre).abs();
        let farthest = target.points.iter().map(distance).fold(0.0, f32::max) * slice.inv_width;
        // One octave more than the target needs: an LTC may be wider.
        let octaves = (((1.0 + farthest).to_bits().cast_signed() - ONE_BITS) >> (FRACTION_BITS + CELL_BITS)) + 2;
        let side = octaves.min(MOST_OCTAVES) << CELL_BITS;
        slice.middle = side * CELL;
        let node = |c: i32| {
            let from_middle = c - side;
            let distance = f64::from(f32::from_bits((from_middle.abs() * CELL + ONE_BITS) as u32)) - 1.0;
            width * if from_middle < 0 { -distance } else { distance }
        };
        let mut mass = vec![0.0; 2 * side as usize + 1];
        for (point, weight) in target.points.iter().zip(&target.weights) {
            let (cell, fraction) = split(slice.locate(project(&slice, point)));
            mass[cell] += weight * f64::from(1.0 - fraction);
            mass[cell + 1] += weight * f64::from(fraction);
        }
        let mut below = 0.0;
        for (c, mass) in (0..2 * side).zip(mass) {
            below += mass;
            slice.cumulative.push(below as f32);
            slice.length.push((node(c + 1) - node(c)) as f32);
        }
        slice
    }
}

/// Cell of a fixed-point position, and where in the cell it is, in [0, 1).
#[inline]
pub(super) fn split(position: i32) -> (usize, f32) {
    ((position >> FRACTION_BITS) as usize, (position & (CELL - 1)) as f32 * (1.0 / CELL as f32))
}
