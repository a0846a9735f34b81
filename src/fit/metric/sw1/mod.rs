//! The sliced Wasserstein-1 distance between a lobe and an LTC, and its gradient, without sorting.
//!
//! On one direction `d` the distance is the area between two cumulative distributions, `integral |F(x) - G(x)| dx`. G
//! belongs to the lobe and never changes; it is tabulated once. F belongs to the LTC's samples, projected on `d`. Both
//! are histograms on the same nodes. The two nodes around a sample share it in proportion (cloud-in-cell), so F moves
//! continuously with the samples, and the cost is linear in their number.

mod slice;

use glam::{DMat3, DVec3};

use self::slice::{Slice, split};
use super::{
    distance::{Distance, Loss, MetricRules, Samples},
    target::Target,
};
use crate::fit::{
    math::{Lattice, cosine_hemisphere, fibonacci_hemisphere},
    pulse::Pulse,
};

/// Fixed samples of the clamped cosine.
#[derive(Debug, Clone)]
struct CosineSamples {
    points: Vec<DVec3>,
}

impl CosineSamples {
    /// The images of a lattice's points under [`cosine_hemisphere`].
    fn new(lattice: Lattice) -> Self {
        Self { points: lattice.points().map(cosine_hemisphere).collect() }
    }
}

/// The sliced Wasserstein distance as an item of [`super::Metric`].
pub(super) struct Rules;

impl MetricRules for Rules {
    fn distance(&self, samples: &Samples) -> Box<dyn Distance> {
        let directions = samples.directions;
        Box::new(SlicedWasserstein {
            samples: CosineSamples::new(Lattice::new(samples.count, samples.shift)),
            directions: (0..directions).map(|i| fibonacci_hemisphere(i, directions, samples.shift[1])).collect(),
            buffers: Buffers::default(),
        })
    }
}

/// The metric with its fixed samples and directions, shared by all entries.
#[derive(Debug)]
struct SlicedWasserstein {
    samples: CosineSamples,
    directions: Vec<DVec3>,
    buffers: Buffers,
}

impl Distance for SlicedWasserstein {
    fn to<'a>(&'a mut self, target: &Target, pulse: &mut Pulse) -> Option<Box<dyn Loss + 'a>> {
        Some(Box::new(SlicedLoss::new(target, &self.samples, &self.directions, &mut self.buffers, pulse)?))
    }
}

/// The distance to one target over fixed samples and directions.
#[derive(Debug)]
struct SlicedLoss<'a> {
    samples: &'a CosineSamples,
    slices: Vec<Slice>,
    /// Mean standard deviation of the target over the directions: the unit in which losses are measured.
    spread: f64,
    buffers: &'a mut Buffers,
}

/// Buffers of an evaluation, kept between evaluations.
#[derive(Debug, Default)]
struct Buffers {
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

impl<'a> SlicedLoss<'a> {
    /// Tabulates `target` along `directions` (unit vectors in the lobe's frame); `None` when `pulse` stops it.
    fn new(
        target: &Target,
        samples: &'a CosineSamples,
        directions: &[DVec3],
        buffers: &'a mut Buffers,
        pulse: &mut Pulse,
    ) -> Option<Self> {
        let slice = |d: &DVec3| pulse.worked(target.points.len()).map(|()| Slice::new(target, *d));
        let slices: Vec<Slice> = directions.iter().map(slice).collect::<Option<_>>()?;
        let spread = directions.iter().map(|d| target.core.project(*d).1).sum::<f64>() / directions.len() as f64;
        Some(Self { samples, slices, spread, buffers })
    }

    /// Fills the buffers with the directions that `m` makes of the samples.
    fn transform(&mut self, m: &DMat3) {
        let work = &mut *self.buffers;
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

    /// The mean distance along the slices; leaves its gradient by each sample's direction in the buffers when asked to.
    fn mean<const GRADIENT: bool>(&mut self, m: &DMat3, pulse: &mut Pulse) -> Option<f64> {
        self.transform(m);
        let mut sum = 0.0;
        for slice in &self.slices {
            pulse.worked(self.samples.points.len())?;
            sum += slice_loss::<GRADIENT>(slice, self.buffers);
        }
        Some(sum / self.slices.len() as f64)
    }

    /// From the gradient by directions `f = M c / |M c|` to that by `M`:
    /// `dL/dM = sum_i ((g_i - f_i (f_i . g_i)) / |M c_i|) c_i^T`.
    fn pull_back(&self) -> DMat3 {
        let work = &*self.buffers;
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

impl Loss for SlicedLoss<'_> {
    fn spread(&self) -> f64 {
        self.spread
    }

    fn value(&mut self, m: &DMat3, pulse: &mut Pulse) -> Option<f64> {
        self.mean::<false>(m, pulse)
    }

    fn value_and_gradient(&mut self, m: &DMat3, pulse: &mut Pulse) -> Option<(f64, DMat3)> {
        let value = self.mean::<true>(m, pulse)?;
        Some((value, self.pull_back() * (1.0 / self.slices.len() as f64)))
    }
}

/// The distance along one slice; adds its gradient by each sample's direction to `work` when asked to.
fn slice_loss<const GRADIENT: bool>(slice: &Slice, work: &mut Buffers) -> f64 {
    let n = work.x.len();
    let (xs, ys, zs) = (&work.x[..n], &work.y[..n], &work.z[..n]);
    let (cells, fractions, slopes) = (&mut work.cell[..n], &mut work.fraction[..n], &mut work.slope[..n]);
    for i in 0..n {
        let (cell, fraction) = split(slice.locate(slice.project(xs[i], ys[i], zs[i])));
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
    // Samples off the end are held in the outermost cells and do not move.
    push[0] = 0.0;
    push[count - 1] = 0.0;
    if GRADIENT {
        let [dx, dy, dz] = slice.direction;
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

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::fit::{brdf::Mirrors, metric::planted, pulse::unstopped};

    const NO_MIRRORS: Mirrors = Mirrors { x: false, y: false };

    fn samples(n: usize) -> CosineSamples {
        CosineSamples::new(Lattice::new(n, [0.0; 2]))
    }

    fn directions(n: usize) -> Vec<DVec3> {
        (0..n).map(|i| fibonacci_hemisphere(i, n, 0.0)).collect()
    }

    fn lobe(scale: f64) -> DMat3 {
        DMat3::from_cols(
            DVec3::new(0.9 * scale, 0.1 * scale, 0.2 * scale),
            DVec3::new(-0.2 * scale, 0.4 * scale, 0.0),
            DVec3::new(-0.6, 0.2, 0.8),
        )
    }

    fn loss<'a>(
        target: &Target,
        samples: &'a CosineSamples,
        directions: &[DVec3],
        buffers: &'a mut Buffers,
    ) -> SlicedLoss<'a> {
        SlicedLoss::new(target, samples, directions, buffers, &mut Pulse::new(&mut unstopped))
            .expect("nothing stops it")
    }

    fn value(loss: &mut SlicedLoss<'_>, m: &DMat3) -> f64 {
        loss.value(m, &mut Pulse::new(&mut unstopped)).expect("nothing stops it")
    }

    /// A neighbour of the lobe in its own frame.
    fn near(target: &Target, scale: f64) -> DMat3 {
        let m = target.frame.transpose() * lobe(scale);
        // The slope shrinks with the lobe. With a larger slope, a sample or two would fall behind a sharp lobe.
        let slope = scale * DVec2::new(0.02, -0.03);
        m * DMat3::from_cols(
            DVec3::new(1.1, 0.05, slope.x),
            DVec3::new(0.05, 0.9, slope.y),
            DVec3::new(0.1, -0.05, 1.0),
        )
    }

    /// Equation 10 of KT et al. 2022 on the loss's own samples: sorted projections, quantile by quantile.
    fn by_sorting(target: &Target, m: &DMat3, samples: &CosineSamples, directions: &[DVec3]) -> f64 {
        let sorted = |values: &mut Vec<f64>| values.sort_by(f64::total_cmp);
        let mut sum = 0.0;
        for d in directions {
            let mut wanted: Vec<f64> = target.points.iter().map(|p| d.dot(*p)).collect();
            let mut ours: Vec<f64> = samples.points.iter().map(|c| d.dot((*m * *c).normalize() - DVec3::Z)).collect();
            sorted(&mut wanted);
            sorted(&mut ours);
            let per_sample = wanted.len() / ours.len();
            let of = |i: usize| (wanted[i] - ours[i / per_sample]).abs();
            sum += (0..wanted.len()).map(of).sum::<f64>() / wanted.len() as f64;
        }
        sum / directions.len() as f64
    }

    #[test]
    fn equals_the_distance_by_sorting() {
        for scale in [1.0, 0.1, 1e-3] {
            let target = planted(lobe(scale), NO_MIRRORS);
            let (samples, directions) = (samples(2048), directions(16));
            let m = near(&target, scale);
            let mut buffers = Buffers::default();
            let loss = value(&mut loss(&target, &samples, &directions, &mut buffers), &m);
            let exact = by_sorting(&target, &m, &samples, &directions);
            assert!((loss / exact - 1.0).abs() < 0.01, "{scale}: {loss} {exact}");
        }
    }

    #[test]
    fn gradient_is_that_of_central_differences() {
        for scale in [1.0, 0.1, 1e-3, 1e-4] {
            let target = planted(lobe(scale), NO_MIRRORS);
            let (samples, directions) = (samples(8192), directions(16));
            let mut buffers = Buffers::default();
            let mut loss = loss(&target, &samples, &directions, &mut buffers);
            // Far enough from the lobe for the two cumulatives to cross in few places: at a crossing the
            // distance has a kink.
            let far =
                DMat3::from_cols(DVec3::new(1.8, 0.3, 0.0), DVec3::new(0.3, 0.5, 0.1), DVec3::new(0.5, -0.4, 1.0));
            let m = near(&target, scale) * far;
            let found = loss.value_and_gradient(&m, &mut Pulse::new(&mut unstopped));
            let (at_m, gradient) = found.expect("nothing stops it");
            assert_eq!(at_m, value(&mut loss, &m));
            // Small compared with the lobe's width, large compared with the spacing of its samples, so that their kinks
            // average out.
            let step = 3e-3 * scale;
            let norm = gradient.to_cols_array().iter().map(|g| g * g).sum::<f64>().sqrt();
            for k in 0..9 {
                let moved = |by: f64| {
                    let mut numbers = m.to_cols_array();
                    numbers[k] += by;
                    DMat3::from_cols_array(&numbers)
                };
                let difference = value(&mut loss, &moved(step)) - value(&mut loss, &moved(-step));
                let slope = difference / (2.0 * step);
                let analytic = gradient.to_cols_array()[k];
                assert!((slope - analytic).abs() < 0.01 * norm, "{scale} {k}: {slope} {analytic}");
            }
        }
    }

    #[test]
    fn the_planted_matrix_has_the_least_loss() {
        let target = planted(lobe(0.3), NO_MIRRORS);
        let (samples, directions) = (samples(1024), directions(16));
        let mut buffers = Buffers::default();
        let mut loss = loss(&target, &samples, &directions, &mut buffers);
        let at_truth = value(&mut loss, &(target.frame.transpose() * lobe(0.3)));
        let nearby = value(&mut loss, &near(&target, 0.3));
        assert!(at_truth < 0.1 * nearby && at_truth < 0.02 * loss.spread(), "{at_truth} {nearby}");
    }
}
