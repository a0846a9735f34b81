//! The sliced Wasserstein-1 distance between a lobe and an LTC, and its gradient, without sorting.
//!
//! On one direction `d` the distance is the area between two cumulative distributions, `integral |F(x) - G(x)| dx`.
//! G belongs to the lobe and never changes; it is tabulated once. F is that of the LTC's samples, projected on `d`.
//! Both are histograms on the same nodes in which a sample is shared by the two nodes around it in proportion
//! (cloud-in-cell), so F moves continuously with the samples, and the cost is linear in their number.
//!
//! The nodes lie at `centre +- width (2^e (1 + k / 32) - 1)`: evenly spaced where the lobe is, and in proportion to
//! the distance from it in its tails, so that lobes with a sharp core and far tails lose neither. The bits of the
//! f32 number `1 + |x - centre| / width` are that position, as exponent and mantissa; no logarithm is taken.

use glam::{DMat3, DVec3};

use super::target::Target;
use crate::math::cosine_hemisphere;

/// Mantissa bits that number the cells of an octave: 32 cells, a core cell is 1/32 of the lobe's width.
const CELL_BITS: u32 = 5;
/// Mantissa bits that are left for the position inside a cell.
const FRACTION_BITS: u32 = f32::MANTISSA_DIGITS - 1 - CELL_BITS;
/// One cell in the fixed-point positions.
const CELL: i32 = 1 << FRACTION_BITS;
/// Bits of 1.0, where positions start.
const ONE_BITS: i32 = 0x3f80_0000;
/// Most octaves on each side: widths of 2^-20 of the sphere's diameter are told apart from zero.
const MOST_OCTAVES: i32 = 22;

/// Fixed samples of the clamped cosine, one array a coordinate.
#[derive(Debug, Clone)]
pub(super) struct CosineSamples {
    points: Vec<DVec3>,
}

impl CosineSamples {
    pub(super) fn len(&self) -> usize {
        self.points.len()
    }
    /// The images of `count` points of the unit square under [`cosine_hemisphere`].
    pub(super) fn new(count: usize, point: impl Fn(usize) -> [f64; 2]) -> Self {
        Self { points: (0..count).map(|i| cosine_hemisphere(point(i))).collect() }
    }
}

/// What is known of the target along one direction.
#[derive(Debug, Clone)]
struct Slice {
    direction: [f32; 3],
    centre: f32,
    inv_width: f32,
    /// Fixed-point position of the centre: half the number of cells.
    middle: i32,
    /// G at the node after each cell.
    cumulative: Vec<f32>,
    /// Length of each cell in x.
    length: Vec<f32>,
}

impl Slice {
    /// Fixed-point position of a projection. Monotonic; projections off the end are put on the last node.
    #[inline(always)]
    fn locate(&self, x: f32) -> i32 {
        let y = (x - self.centre) * self.inv_width;
        let beyond_one = ((1.0 + y.abs()).to_bits() as i32 - ONE_BITS).min(self.middle - 1);
        let sign = (y.to_bits() as i32) >> 31;
        ((beyond_one ^ sign) - sign) + self.middle
    }

    fn new(target: &Target, direction: DVec3) -> Self {
        let (centre, width) = target.core.project(direction);
        let mut slice = Self {
            direction: direction.as_vec3().to_array(),
            centre: centre as f32,
            inv_width: (1.0 / width) as f32,
            middle: i32::MAX,
            cumulative: Vec::new(),
            length: Vec::new(),
        };
        let project = |p: &DVec3| {
            let p = p.as_vec3();
            slice.direction[0] * p.x + slice.direction[1] * p.y + slice.direction[2] * p.z
        };
        let farthest = target.points.iter().map(|p| (project(p) - slice.centre).abs()).fold(0.0, f32::max);
        // One octave more than the target needs: an LTC may be wider.
        let octaves =
            (((1.0 + farthest * slice.inv_width).to_bits() as i32 - ONE_BITS) >> (FRACTION_BITS + CELL_BITS)) + 2;
        let side = (octaves.min(MOST_OCTAVES) as usize) << CELL_BITS;
        slice.middle = side as i32 * CELL;
        let node = |c: usize| {
            let from_middle = c as i32 - side as i32;
            let beyond_one = f64::from(f32::from_bits((from_middle.abs() * CELL + ONE_BITS) as u32)) - 1.0;
            width * if from_middle < 0 { -beyond_one } else { beyond_one }
        };
        let mut mass = vec![0.0; 2 * side + 1];
        for (point, weight) in target.points.iter().zip(&target.weights) {
            let p = point.as_vec3();
            let x = slice.direction[0] * p.x + slice.direction[1] * p.y + slice.direction[2] * p.z;
            let (cell, fraction) = split(slice.locate(x));
            mass[cell] += weight * f64::from(1.0 - fraction);
            mass[cell + 1] += weight * f64::from(fraction);
        }
        let mut below = 0.0;
        for c in 0..2 * side {
            below += mass[c];
            slice.cumulative.push(below as f32);
            slice.length.push((node(c + 1) - node(c)) as f32);
        }
        slice
    }
}

/// Cell of a fixed-point position, and where in the cell it is, in [0, 1).
#[inline(always)]
fn split(position: i32) -> (usize, f32) {
    ((position >> FRACTION_BITS) as usize, (position & (CELL - 1)) as f32 * (1.0 / CELL as f32))
}

/// The distance to one target over fixed samples and directions.
#[derive(Debug)]
pub(super) struct Loss<'a> {
    samples: &'a CosineSamples,
    slices: Vec<Slice>,
    /// Mean standard deviation of the target over the directions: the unit in which losses are told.
    spread: f64,
}

/// Buffers of an evaluation, kept between evaluations.
#[derive(Debug, Default)]
pub(super) struct Workspace {
    /// Offsets of the LTC's samples from the lobe's axis, one array a coordinate.
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    inv_length: Vec<f64>,
    /// Gradient of the loss by each sample's direction.
    gx: Vec<f32>,
    gy: Vec<f32>,
    gz: Vec<f32>,
    /// Cell, fraction and slope of each sample on the current direction.
    cell: Vec<u32>,
    fraction: Vec<f32>,
    slope: Vec<f32>,
    /// Samples at each node, and the gradient of each cell.
    mass: Vec<f32>,
    push: Vec<f32>,
}

impl<'a> Loss<'a> {
    /// Tabulates `target` along `directions` (unit vectors in the lobe's frame).
    pub(super) fn new(target: &Target, samples: &'a CosineSamples, directions: &[DVec3]) -> Self {
        let slices: Vec<Slice> = directions.iter().map(|d| Slice::new(target, *d)).collect();
        let spread = directions.iter().map(|d| target.core.project(*d).1).sum::<f64>() / directions.len() as f64;
        Self { samples, slices, spread }
    }

    /// Samples of the LTC.
    pub(super) fn samples(&self) -> usize {
        self.samples.points.len()
    }

    /// Mean standard deviation of the target's projections.
    pub(super) fn spread(&self) -> f64 {
        self.spread
    }

    /// The distance at `m`, a matrix from cosine space to the lobe's frame with positive determinant.
    pub(super) fn value(&self, m: &DMat3, work: &mut Workspace) -> f64 {
        self.transform(m, work);
        self.slices.iter().map(|slice| slice_loss::<false>(slice, work)).sum::<f64>() / self.slices.len() as f64
    }

    /// The distance at `m` and its gradient by the elements of `m`.
    pub(super) fn value_and_gradient(&self, m: &DMat3, work: &mut Workspace) -> (f64, DMat3) {
        self.transform(m, work);
        let count = self.slices.len() as f64;
        let value = self.slices.iter().map(|slice| slice_loss::<true>(slice, work)).sum::<f64>() / count;
        (value, self.pull_back(work) * (1.0 / count))
    }

    /// Fills `work` with the directions that `m` makes of the samples.
    fn transform(&self, m: &DMat3, work: &mut Workspace) {
        let n = self.samples.points.len();
        for buffer in [&mut work.x, &mut work.y, &mut work.z, &mut work.gx, &mut work.gy, &mut work.gz] {
            buffer.resize(n, 0.0);
        }
        work.fraction.resize(n, 0.0);
        work.slope.resize(n, 0.0);
        work.cell.resize(n, 0);
        work.inv_length.resize(n, 0.0);
        work.gx.fill(0.0);
        work.gy.fill(0.0);
        work.gz.fill(0.0);
        for (i, c) in self.samples.points.iter().enumerate() {
            let w = *m * *c;
            let tangential2 = w.x * w.x + w.y * w.y;
            let length = (tangential2 + w.z * w.z).sqrt();
            let inv = 1.0 / length;
            // The offset of `w / length` from z, without cancellation where w.z is close to the length.
            let z = if w.z > 0.0 { -tangential2 / (length + w.z) } else { w.z - length };
            work.x[i] = (w.x * inv) as f32;
            work.y[i] = (w.y * inv) as f32;
            work.z[i] = (z * inv) as f32;
            work.inv_length[i] = inv;
        }
    }

    /// From the gradient by directions `f = M c / |M c|` to that by `M`:
    /// `dL/dM = sum_i ((g_i - f_i (f_i . g_i)) / |M c_i|) c_i^T`.
    fn pull_back(&self, work: &Workspace) -> DMat3 {
        let mut gradient = DMat3::ZERO;
        for (i, c) in self.samples.points.iter().enumerate() {
            let f = DVec3::new(f64::from(work.x[i]), f64::from(work.y[i]), 1.0 + f64::from(work.z[i]));
            let g = DVec3::new(f64::from(work.gx[i]), f64::from(work.gy[i]), f64::from(work.gz[i]));
            let by_w = (g - f * f.dot(g)) * work.inv_length[i];
            gradient += DMat3::from_cols(by_w * c.x, by_w * c.y, by_w * c.z);
        }
        gradient
    }
}

/// The distance along one slice; adds its gradient by each sample's direction to `work` when asked to.
fn slice_loss<const GRADIENT: bool>(slice: &Slice, work: &mut Workspace) -> f64 {
    let n = work.x.len();
    let (xs, ys, zs) = (&work.x[..n], &work.y[..n], &work.z[..n]);
    let (cells, fractions, slopes) = (&mut work.cell[..n], &mut work.fraction[..n], &mut work.slope[..n]);
    let [dx, dy, dz] = slice.direction;
    for i in 0..n {
        let (cell, fraction) = split(slice.locate(dx * xs[i] + dy * ys[i] + dz * zs[i]));
        cells[i] = cell as u32;
        fractions[i] = fraction;
    }
    let count = slice.length.len();
    let mass = &mut work.mass;
    mass.clear();
    mass.resize(count + 1, 0.0);
    for (cell, fraction) in cells.iter().zip(fractions.iter()) {
        let pair = &mut mass[*cell as usize..][..2];
        pair[0] += 1.0 - fraction;
        pair[1] += fraction;
    }
    let per_sample = 1.0 / n as f32;
    let push = &mut work.push;
    push.resize(count, 0.0);
    let (mut below, mut loss) = (0.0_f32, 0.0_f64);
    for c in 0..count {
        below += mass[c];
        let gap = below * per_sample - slice.cumulative[c];
        loss += f64::from(gap.abs() * slice.length[c]);
        // A sample that moves up by dx takes dx / (n length) out of F at the node after its cell.
        push[c] = -per_sample.copysign(gap);
    }
    if GRADIENT {
        let (gx, gy, gz) = (&mut work.gx[..n], &mut work.gy[..n], &mut work.gz[..n]);
        for i in 0..n {
            slopes[i] = push[cells[i] as usize];
        }
        for i in 0..n {
            gx[i] += dx * slopes[i];
            gy[i] += dy * slopes[i];
            gz[i] += dz * slopes[i];
        }
    }
    loss
}
