//! The filters of the prefilter along one axis: from a level to the next coarser level, within a level, and back to the
//! finer level.
//!
//! A level has half as many texels as the previous level, rounded down, and at least one. If a size is odd, a texel of
//! the next level is as long as two texels and a fraction, or three. Filters are centred on this texel and have its
//! width. So the image does not shift, and every texel counts.

/// The weights with which texels of one row make a texel of another row. `first` is the first texel; the weights add up
/// to one.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Taps {
    pub(super) first: usize,
    pub(super) weights: Vec<f64>,
}

impl Taps {
    /// The values of `weight` at texels `first..end`, divided by their sum.
    fn new(first: usize, end: usize, weight: impl Fn(usize) -> f64) -> Self {
        let weights: Vec<f64> = (first..end).map(weight).collect();
        let sum: f64 = weights.iter().sum();
        Self { first, weights: weights.into_iter().map(|weight| weight / sum).collect() }
    }
}

/// A filter along an axis, with taps for each resulting texel.
pub(super) type Filter = Vec<Taps>;

/// The number of texels at level `level` of an image with `size` texels.
pub(super) fn size_of(size: usize, level: usize) -> usize {
    (size >> level).max(1)
}

/// Reduces `from` texels to `to`. The filter is a tent that reaches from a texel to the centres of its neighbours. For
/// even sizes it is `[1 3 3 1] / 8`. A single texel is the mean of all texels.
pub(super) fn halved(from: usize, to: usize) -> Filter {
    if from == to {
        return (0..from).map(|i| Taps::new(i, i + 1, |_| 1.0)).collect();
    }
    if to == 1 {
        return vec![Taps::new(0, from, |_| 1.0)];
    }
    let ratio = from as f64 / to as f64;
    let taps = |i: usize| {
        let middle = (i as f64 + 0.5) * ratio - 0.5;
        let first = ((middle - ratio).floor() + 1.0).max(0.0) as usize;
        let end = ((middle + ratio).ceil() as usize).min(from);
        Taps::new(first, end, |j| 1.0 - (j as f64 - middle).abs() / ratio)
    };
    (0..to).map(taps).collect()
}

/// The filter `[beside, 1 - 2 beside, beside]` within a level.
pub(super) fn widened(size: usize, beside: f64) -> Filter {
    let weight = |i: usize| move |j: usize| if i == j { 1.0 - 2.0 * beside } else { beside };
    (0..size).map(|i| Taps::new(i.saturating_sub(1), (i + 2).min(size), weight(i))).collect()
}

/// Converts `from` texels to more or fewer texels, `to`. Each new texel is the mean of the old texels that overlap it,
/// weighted by the overlap.
pub(super) fn averaged(from: usize, to: usize) -> Filter {
    let edge = |i: usize| i as f64 * from as f64 / to as f64;
    let taps = |i: usize| {
        let (begin, end) = (edge(i), edge(i + 1));
        // Rounding can move an edge between two texels. A texel without overlap is left out.
        let last = (end.ceil() as usize).clamp(begin as usize + 1, from);
        Taps::new(begin as usize, last, |j| ((j + 1) as f64).min(end) - (j as f64).max(begin))
    };
    (0..to).map(taps).collect()
}

/// Enlarges `from` texels to `to`, linearly between their centres.
pub(super) fn enlarged(from: usize, to: usize) -> Filter {
    let taps = |i: usize| {
        let middle = ((i as f64 + 0.5) * from as f64 / to as f64 - 0.5).max(0.0).min((from - 1) as f64);
        let first = middle as usize;
        let along = middle - first as f64;
        Taps::new(first, (first + 2).min(from), |j| if j == first { 1.0 - along } else { along })
    };
    (0..to).map(taps).collect()
}

/// The parameter of [`widened`] for level `level` of an image with `size` texels. If all sizes are even, halving makes
/// a kernel of variance `(4^level - 1) / 4` square texels of the image. A parameter of a quarter raises it to
/// `(3 4^level - 1) / 4`. If sizes are odd, texels are longer and halving spreads more, so the parameter is smaller. A
/// tent of half width s over texels of length t has the variance `s^2 / 6 + t^2 / 12`, which is exact for 2 t = s.
pub(super) fn beside(size: usize, level: usize) -> f64 {
    let length = |level| size as f64 / size_of(size, level) as f64;
    let halves = |level: &usize| size_of(size, *level) > size_of(size, level + 1);
    let halving = |level| length(level + 1).powi(2) / 6.0 + length(level).powi(2) / 12.0;
    let halved: f64 = (0..level).filter(halves).map(halving).sum();
    let wanted = 0.75 * (1_u64 << (2 * level)) as f64 - 0.25;
    ((wanted - halved) / (2.0 * length(level).powi(2))).max(0.0)
}
