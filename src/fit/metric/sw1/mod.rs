//! The sliced Wasserstein-1 distance between a lobe and an LTC, and its gradient, without sorting.
//!
//! Along one direction `d`, the distance is the area between two cumulative distributions, `integral |F(x) - G(x)| dx`.
//! G belongs to the lobe, does not change, and is tabulated once. F belongs to the LTC's samples, projected on `d`.
//! Both are histograms on the same nodes. The two nodes around a sample share its weight in proportion (cloud-in-cell).
//! F therefore moves continuously with the samples, and the cost is linear in the number of samples.

mod cells;
mod histogram;
mod samples;
mod slice;
mod sorted;

use std::sync::Arc;

use glam::{DMat3, DVec3};

use self::{
    cells::CELLS,
    histogram::{EQUAL, Histogram, Places},
    samples::{CosineSamples, LANES},
    slice::{Slice, TargetSamples},
};
use super::{
    distance::{Distance, Draws, Grain, ImageLoss, Lobe, Loss, MetricRules, Offsets, Samples},
    target::Target,
};
use crate::{
    math::{Lattice, fibonacci_hemisphere},
    stop_check::StopCheck,
};

/// The number of directions whose gradients are added to the samples together.
const GROUP: usize = 4;
/// A coarse evaluation takes one in `COARSE_SAMPLES` samples, but at least [`LEAST_COARSE`], and one in
/// [`COARSE_DIRECTIONS`] directions.
const COARSE_SAMPLES: usize = 4;
const COARSE_DIRECTIONS: usize = 2;
const LEAST_COARSE: usize = 64;

/// Seconds of one evaluation of loss and gradient, for each sample and direction. The projections of the lobe and the
/// measured error are included.
const EVALUATION_SECONDS: f64 = 2.4e-9;
/// Seconds of one evaluation for each direction, independent of the number of samples. The histograms take this time.
const DIRECTION_SECONDS: f64 = 0.48e-6;

/// The sliced Wasserstein distance as an item of [`super::Metric`].
pub(super) struct Sw1;

impl MetricRules for Sw1 {
    fn compares_images(&self) -> bool {
        true
    }

    fn distance(&self, samples: &Samples) -> Box<dyn Distance> {
        let directions = samples.directions;
        let coarse = (samples.count / COARSE_SAMPLES).max(LEAST_COARSE).min(samples.count);
        Box::new(SlicedWasserstein {
            samples: Arc::new([
                CosineSamples::new(Lattice::new(coarse, samples.shift)),
                CosineSamples::new(Lattice::new(samples.count, samples.shift)),
            ]),
            directions: (0..directions).map(|i| fibonacci_hemisphere(i, directions, samples.shift[1])).collect(),
            buffers: Buffers::default(),
        })
    }

    fn seconds(&self, samples: usize, directions: usize) -> f64 {
        directions as f64 * (EVALUATION_SECONDS * samples as f64 + DIRECTION_SECONDS)
    }
}

/// The metric with its fixed samples and directions. All entries share them.
#[derive(Debug)]
struct SlicedWasserstein {
    samples: Arc<[CosineSamples; 2]>,
    directions: Arc<[DVec3]>,
    buffers: Buffers,
}

impl Distance for SlicedWasserstein {
    fn another(&self) -> Box<dyn Distance> {
        Box::new(Self {
            samples: Arc::clone(&self.samples),
            directions: Arc::clone(&self.directions),
            buffers: Buffers::default(),
        })
    }

    fn to<'a>(&'a mut self, lobe: &Lobe<'a>, stop_check: &mut StopCheck) -> Option<Box<dyn Loss + 'a>> {
        Some(Box::new(SlicedLoss::new(lobe.target, &self.samples, &self.directions, &mut self.buffers, stop_check)?))
    }
}

/// The distance to one target over fixed samples and directions.
#[derive(Debug)]
struct SlicedLoss<'a> {
    samples: &'a [CosineSamples; 2],
    slices: Vec<Slice>,
    /// Mean width of the target's core over the directions. It is the unit of losses.
    spread: f64,
    buffers: &'a mut Buffers,
}

/// Buffers that tabulations and evaluations reuse.
#[derive(Debug, Default)]
struct Buffers {
    target: TargetSamples,
    /// Offsets of the LTC's samples from the lobe's axis, with one array for each coordinate.
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    inv_length: Vec<f32>,
    /// Gradient of the loss with respect to each sample's direction, not yet divided by [`SlicedLoss::parts`].
    gx: Vec<f32>,
    gy: Vec<f32>,
    gz: Vec<f32>,
    histogram: Histogram,
    rows: [Row; GROUP],
}

impl Buffers {
    /// Resizes the buffers for `n` samples, and sets the gradient to zero.
    fn prepare(&mut self, n: usize) {
        let buffers =
            [&mut self.x, &mut self.y, &mut self.z, &mut self.inv_length, &mut self.gx, &mut self.gy, &mut self.gz];
        for buffer in buffers {
            buffer.resize(n, 0.0);
        }
        for row in &mut self.rows {
            row.places.resize(n);
            row.slopes.resize(n, 0.0);
        }
        self.gx.fill(0.0);
        self.gy.fill(0.0);
        self.gz.fill(0.0);
    }
}

/// The data of one direction for the gradient.
#[derive(Debug)]
struct Row {
    /// The position of each sample among the direction's nodes.
    places: Places,
    /// The direction in which samples of each cell reduce the loss: -1, 0 or 1.
    push: Box<[f32; CELLS]>,
    /// The slope of each sample, from `push`.
    slopes: Vec<f32>,
}

impl Default for Row {
    fn default() -> Self {
        Self { places: Places::default(), push: Box::new([0.0; CELLS]), slopes: Vec::new() }
    }
}

impl<'a> SlicedLoss<'a> {
    /// Tabulates `target` along `directions` (unit vectors in the lobe's frame); `None` if `stop_check` stops it.
    fn new(
        target: &Target,
        samples: &'a [CosineSamples; 2],
        directions: &[DVec3],
        buffers: &'a mut Buffers,
        stop_check: &mut StopCheck,
    ) -> Option<Self> {
        let Buffers { target: sampled, histogram, .. } = &mut *buffers;
        sampled.fill(&target.points, &target.weights);
        let slice = |d: &DVec3| {
            stop_check.worked(target.points.len())?;
            Some(Slice::new(sampled, &target.core, *d, histogram))
        };
        let slices: Vec<Slice> = directions.iter().map(slice).collect::<Option<_>>()?;
        let spread = directions.iter().map(|d| target.core.project(*d).1).sum::<f64>() / directions.len() as f64;
        Some(Self { samples, slices, spread, buffers })
    }

    /// Fills the buffers with the samples transformed by `m`.
    fn transform(&mut self, m: &DMat3, grain: Grain) {
        let CosineSamples { x: cx, y: cy, z: cz, .. } = &self.samples[grain as usize];
        let work = &mut *self.buffers;
        let n = cx.len();
        work.prepare(n);
        let m = m.as_mat3();
        let [rx, ry, rz] = [m.row(0), m.row(1), m.row(2)];
        let (xs, ys, zs, lengths) = (&mut work.x[..n], &mut work.y[..n], &mut work.z[..n], &mut work.inv_length[..n]);
        let (cx, cy, cz) = (&cx[..n], &cy[..n], &cz[..n]);
        for i in 0..n {
            let x = rx.x * cx[i] + rx.y * cy[i] + rx.z * cz[i];
            let y = ry.x * cx[i] + ry.y * cy[i] + ry.z * cz[i];
            let z = rz.x * cx[i] + rz.y * cy[i] + rz.z * cz[i];
            let tangential2 = x * x + y * y;
            let length = (tangential2 + z * z).sqrt();
            let inv = 1.0 / length;
            // The offset of `w / length` from z. The form for positive z avoids cancellation near z.
            let above = -tangential2 / (length + z);
            let offset = if z > 0.0 { above } else { z - length };
            xs[i] = x * inv;
            ys[i] = y * inv;
            zs[i] = offset * inv;
            lengths[i] = inv;
        }
    }

    /// Fills the buffers with directions.
    fn take(&mut self, offsets: &Offsets, grain: Grain) {
        let CosineSamples { x: samples, count, .. } = &self.samples[grain as usize];
        let work = &mut *self.buffers;
        work.prepare(samples.len());
        for (to, from) in [&mut work.x, &mut work.y, &mut work.z].into_iter().zip(offsets) {
            to[..*count].copy_from_slice(&from[..*count]);
            // The padding of the arrays must consist of valid directions.
            to[*count..].fill(0.0);
        }
    }

    /// The mean distance over the slices. With `GRADIENT`, adds its gradient with respect to each sample's direction to
    /// the buffers.
    fn mean<const GRADIENT: bool>(&mut self, grain: Grain, stop_check: &mut StopCheck) -> Option<f64> {
        let count = self.samples[grain as usize].count;
        let stride = Self::stride(grain);
        let work = &mut *self.buffers;
        let mut sum = 0.0;
        for group in self.slices.chunks(GROUP * stride) {
            for (slice, row) in group.iter().step_by(stride).zip(&mut work.rows) {
                stop_check.worked(count)?;
                slice.locate_all([&work.x, &work.y, &work.z], &mut row.places);
                work.histogram.add_equal(&row.places, count);
                sum += row.compare(slice, count, &mut work.histogram);
            }
            if GRADIENT {
                let gradient = [&mut work.gx, &mut work.gy, &mut work.gz];
                add_gradient(group.iter().step_by(stride), &mut work.rows, count, gradient);
            }
        }
        Some(sum / self.slices.len().div_ceil(stride) as f64)
    }

    /// The number of terms in the sum of an evaluation's gradient: samples times directions.
    fn parts(&self, grain: Grain) -> usize {
        self.slices.len().div_ceil(Self::stride(grain)) * self.samples[grain as usize].count
    }

    /// The step through the directions: a coarse evaluation takes every n-th direction.
    fn stride(grain: Grain) -> usize {
        match grain {
            Grain::Coarse => COARSE_DIRECTIONS,
            Grain::Full => 1,
        }
    }

    /// Converts the gradient with respect to directions `f = M c / |M c|` to the gradient with respect to `M`:
    /// `dL/dM = sum_i ((g_i - f_i (f_i . g_i)) / |M c_i|) c_i^T`.
    fn pull_back(&self, grain: Grain) -> DMat3 {
        let work = &*self.buffers;
        let CosineSamples { x: cx, y: cy, z: cz, .. } = &self.samples[grain as usize];
        let n = cx.len();
        let (xs, ys, zs, lengths) = (&work.x[..n], &work.y[..n], &work.z[..n], &work.inv_length[..n]);
        let (gxs, gys, gzs) = (&work.gx[..n], &work.gy[..n], &work.gz[..n]);
        let (cx, cy, cz) = (&cx[..n], &cy[..n], &cz[..n]);
        let mut sums = [[0.0_f32; LANES]; 9];
        for start in (0..n).step_by(LANES) {
            let lanes = |numbers: &[f32]| -> [f32; LANES] { std::array::from_fn(|k| numbers[start + k]) };
            let [x, y, z, inv] = [xs, ys, zs, lengths].map(lanes);
            let [gx, gy, gz] = [gxs, gys, gzs].map(lanes);
            let c = [cx, cy, cz].map(lanes);
            let mut by_w = [[0.0; LANES]; 3];
            for k in 0..LANES {
                // With f = (x, y, 1 + z), f . g = partial + gz. The third component is written without cancellation.
                let partial = x[k] * gx[k] + y[k] * gy[k] + z[k] * gz[k];
                let along = partial + gz[k];
                by_w[0][k] = (gx[k] - x[k] * along) * inv[k];
                by_w[1][k] = (gy[k] - y[k] * along) * inv[k];
                by_w[2][k] = -(partial + z[k] * along) * inv[k];
            }
            for (i, sum) in sums.iter_mut().enumerate() {
                for k in 0..LANES {
                    sum[k] += by_w[i % 3][k] * c[i / 3][k];
                }
            }
        }
        DMat3::from_cols_array(&sums.map(|lanes| lanes.iter().map(|x| f64::from(*x)).sum()))
    }
}

impl Loss for SlicedLoss<'_> {
    fn spread(&self) -> f64 {
        self.spread
    }

    fn value(&mut self, m: &DMat3, stop_check: &mut StopCheck) -> Option<f64> {
        self.transform(m, Grain::Full);
        self.mean::<false>(Grain::Full, stop_check)
    }

    fn value_and_gradient(&mut self, m: &DMat3, grain: Grain, stop_check: &mut StopCheck) -> Option<(f64, DMat3)> {
        self.transform(m, grain);
        let value = self.mean::<true>(grain, stop_check)?;
        Some((value, self.pull_back(grain) * (1.0 / self.parts(grain) as f64)))
    }

    fn step(&self, m: &DMat3, rate: f64, draws: &Draws, stop_check: &mut StopCheck) -> Option<DMat3> {
        sorted::step(m, rate, draws, stop_check)
    }

    fn images(&mut self) -> Option<&mut dyn ImageLoss> {
        Some(self)
    }
}

impl ImageLoss for SlicedLoss<'_> {
    fn lattice(&self, grain: Grain) -> Lattice {
        self.samples[grain as usize].lattice
    }

    fn slopes(&mut self, offsets: &Offsets, grain: Grain, stop_check: &mut StopCheck) -> Option<(f64, Offsets)> {
        self.take(offsets, grain);
        let value = self.mean::<true>(grain, stop_check)?;
        let (count, part) = (self.samples[grain as usize].count, 1.0 / self.parts(grain) as f32);
        let Buffers { gx, gy, gz, .. } = &*self.buffers;
        Some((value, [gx, gy, gz].map(|slopes| slopes[..count].iter().map(|slope| slope * part).collect())))
    }

    fn value_of(&mut self, offsets: &Offsets, stop_check: &mut StopCheck) -> Option<f64> {
        self.take(offsets, Grain::Full);
        self.mean::<false>(Grain::Full, stop_check)
    }
}

impl Row {
    /// The distance along one slice of the samples in the histogram. Sets `push`, the direction in which samples of
    /// each cell reduce the distance.
    fn compare(&mut self, slice: &Slice, count: usize, histogram: &mut Histogram) -> f64 {
        let cells = slice.length.len();
        histogram.drain(cells);
        let whole = 1.0 / (count as f32 * EQUAL as f32);
        let mut loss = [0.0_f32; LANES];
        // The number of cells is a multiple of the lanes.
        let (below, _) = histogram.below().as_chunks::<LANES>();
        let (cumulative, _) = slice.cumulative.as_chunks::<LANES>();
        let (length, _) = slice.length.as_chunks::<LANES>();
        let (push, _) = self.push[..cells].as_chunks_mut::<LANES>();
        for (((below, cumulative), length), push) in below.iter().zip(cumulative).zip(length).zip(push) {
            for k in 0..LANES {
                let gap = below[k] as f32 * whole - cumulative[k];
                loss[k] += gap.abs() * length[k];
                // A sample that moves up by dx reduces F at the node after its cell by dx / (n length).
                push[k] = -1.0_f32.copysign(gap);
            }
        }
        // Samples beyond the ends are clamped to the outermost cells and do not move.
        self.push[0] = 0.0;
        self.push[cells - 1] = 0.0;
        loss.iter().map(|loss| f64::from(*loss)).sum()
    }
}

/// Adds the gradient of a few slices with respect to each sample's direction.
fn add_gradient<'s>(
    slices: impl Iterator<Item = &'s Slice>,
    rows: &mut [Row; GROUP],
    count: usize,
    gradient: [&mut Vec<f32>; 3],
) {
    // If there are fewer slices than rows, the remaining rows have a zero direction.
    let mut d = [[0.0; 3]; GROUP];
    for ((slice, row), d) in slices.zip(&mut *rows).zip(&mut d) {
        *d = slice.direction;
        for (slope, cell) in row.slopes.iter_mut().zip(&row.places.cells[..count]) {
            *slope = row.push[*cell as usize & (CELLS - 1)];
        }
    }
    let [gx, gy, gz] = gradient;
    let n = gx.len();
    let [a, b, c, e] = rows;
    let (gx, gy, gz) = (&mut gx[..n], &mut gy[..n], &mut gz[..n]);
    let (a, b, c, e) = (&a.slopes[..n], &b.slopes[..n], &c.slopes[..n], &e.slopes[..n]);
    for i in 0..n {
        gx[i] += d[0][0] * a[i] + d[1][0] * b[i] + d[2][0] * c[i] + d[3][0] * e[i];
        gy[i] += d[0][1] * a[i] + d[1][1] * b[i] + d[2][1] * c[i] + d[3][1] * e[i];
        gz[i] += d[0][2] * a[i] + d[1][2] * b[i] + d[2][2] * c[i] + d[3][2] * e[i];
    }
}

#[cfg(test)]
mod tests;
