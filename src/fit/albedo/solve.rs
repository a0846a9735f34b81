//! The texels whose linear filter is nearest to given values.

use super::axes::Axis;

/// The weight of places outside the domain. They only determine texels that the domain does not reach.
const OUTSIDE: f64 = 1e-4;
/// Rounds of least squares. In each round after the first, the weight of a place grows with the square of its error
/// [Lawson 1961].
const ROUNDS: usize = 12;
/// The growth of the weight where the error is largest.
const GROWTH: f64 = 4.0;
/// The smallest weight relative to the first round's, so the mean error stays small.
const LEAST_WEIGHT: f64 = 0.1;
/// The number of texels above which fewer rounds are enough.
const MANY_TEXELS: usize = 64 * 64;
const FEW_ROUNDS: usize = 3;
/// Steps of conjugate gradients in each round, from the texels of the previous round.
const STEPS: usize = 24;

/// The places of a solve or of a report, and the linear filter at each.
#[derive(Debug)]
pub(super) struct Places {
    /// The number of texels of the table.
    count: usize,
    /// The first texel of each place.
    texels: Vec<usize>,
    /// The texels of a place, relative to its first.
    offsets: Vec<usize>,
    /// The weights of these texels, for one place after another.
    filters: Vec<f64>,
    /// The weights of the first round. Places outside the domain have [`OUTSIDE`].
    domain: Vec<f64>,
}

impl Places {
    /// The product of the places on all axes.
    pub(super) fn new(axes: &[Axis]) -> Self {
        let (mut texels, mut offsets, mut filters, mut domain) = (vec![0], vec![0], vec![1.0], vec![1.0]);
        for axis in axes {
            offsets = offsets.iter().flat_map(|at| [at * axis.texels, at * axis.texels + 1]).collect();
            let corners = offsets.len() / 2;
            let (last_texels, last_domain) = (texels, domain);
            let mut next_filters = Vec::with_capacity(2 * filters.len() * axis.places.len());
            (texels, domain) = (vec![], vec![]);
            for (i, texel) in last_texels.iter().enumerate() {
                let last = &filters[i * corners..(i + 1) * corners];
                for (place, x) in axis.places.iter().enumerate() {
                    let (below, next) = axis.filter(*x);
                    texels.push(texel * axis.texels + below);
                    domain.push(last_domain[i] * axis.weight(place));
                    next_filters.extend(last.iter().flat_map(|weight| [weight * (1.0 - next), weight * next]));
                }
            }
            filters = next_filters;
        }
        let domain = domain.into_iter().map(|weight| weight.max(OUTSIDE)).collect();
        Self { count: axes.iter().map(|axis| axis.texels).product(), texels, offsets, filters, domain }
    }

    /// The numbers that the linear filter reads at the places.
    pub(super) fn filtered<'a>(&'a self, texels: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        let filters = self.filters.chunks_exact(self.offsets.len());
        self.texels.iter().zip(filters).map(move |(first, filters)| {
            filters.iter().zip(&self.offsets).map(|(weight, offset)| weight * texels[first + offset]).sum()
        })
    }

    /// Adds a number of each place to its texels, with the weights that `weight` makes of those of the filter.
    fn spread(&self, numbers: impl Iterator<Item = f64>, weight: impl Fn(f64) -> f64, to: &mut [f64]) {
        let filters = self.filters.chunks_exact(self.offsets.len());
        for ((first, filters), number) in self.texels.iter().zip(filters).zip(numbers) {
            for (filter, offset) in filters.iter().zip(&self.offsets) {
                to[first + offset] += weight(*filter) * number;
            }
        }
    }
}

/// The texels for the values at the places. Both are row-major.
///
/// Minimises the weighted squares of `filtered - value` by conjugate gradients. If `is_bounded`, texels are in [0, 1].
pub(super) fn solve(places: &Places, values: &[f64], is_bounded: bool) -> Vec<f64> {
    let mut weights = places.domain.clone();
    // The first texels are averages of the values nearby.
    let (mut texels, mut whole) = (vec![0.0; places.count], vec![1e-12; places.count]);
    places.spread(values.iter().zip(&weights).map(|(value, weight)| value * weight), |filter| filter, &mut texels);
    places.spread(weights.iter().copied(), |filter| filter, &mut whole);
    texels.iter_mut().zip(&whole).for_each(|(texel, whole)| *texel /= whole);
    let inside: Vec<usize> = (0..weights.len()).filter(|i| places.domain[*i] > OUTSIDE).collect();
    let total = |weights: &[f64]| -> f64 { inside.iter().map(|i| weights[*i]).sum() };
    let whole = total(&weights);
    for round in 0..if places.count > MANY_TEXELS { FEW_ROUNDS } else { ROUNDS } {
        if round > 0 {
            let errors: Vec<f64> =
                places.filtered(&texels).zip(values).map(|(found, value)| (found - value).abs()).collect();
            let largest = inside.iter().map(|i| errors[*i]).fold(1e-9, f64::max);
            for &i in &inside {
                let relative = errors[i] / largest;
                weights[i] *= 1.0 + GROWTH * relative * relative;
            }
            let scale = whole / total(&weights);
            for &i in &inside {
                weights[i] = (weights[i] * scale).max(LEAST_WEIGHT * places.domain[i]);
            }
        }
        descend(&mut texels, places, values, &weights, if round == 0 { 2 * STEPS } else { STEPS });
        if is_bounded {
            for texel in &mut texels {
                *texel = texel.clamp(0.0, 1.0);
            }
        }
    }
    texels
}

/// Conjugate gradients with the diagonal as preconditioner.
fn descend(texels: &mut [f64], places: &Places, values: &[f64], weights: &[f64], steps: usize) {
    let n = texels.len();
    let (mut diagonal, mut residual) = (vec![1e-12; n], vec![0.0; n]);
    places.spread(weights.iter().copied(), |filter| filter * filter, &mut diagonal);
    let errors = places.filtered(texels).zip(values).zip(weights).map(|((found, value), w)| w * (value - found));
    places.spread(errors, |filter| filter, &mut residual);
    let scaled = |residual: &[f64]| -> Vec<f64> { residual.iter().zip(&diagonal).map(|(r, d)| r / d).collect() };
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let mut direction = scaled(&residual);
    let mut square = dot(&residual, &direction);
    let mut image = vec![0.0; n];
    for _ in 0..steps {
        if square < 1e-24 {
            return;
        }
        image.fill(0.0);
        let weighted = places.filtered(&direction).zip(weights).map(|(found, w)| w * found);
        places.spread(weighted, |filter| filter, &mut image);
        let step = square / dot(&direction, &image);
        for i in 0..n {
            texels[i] += step * direction[i];
            residual[i] -= step * image[i];
        }
        let next = scaled(&residual);
        let new = dot(&residual, &next);
        let kept = new / square;
        for i in 0..n {
            direction[i] = next[i] + kept * direction[i];
        }
        square = new;
    }
}
