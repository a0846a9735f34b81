//! What the prefilter does along one axis: from a level to the next, within a level, and back.
//!
//! A level has half as many texels as the one before, rounded down, and at least one. Where a size is odd, a texel of the
//! next level is as long as two and a fraction, or three; filters are centred on it and as wide as it is, so that nothing
//! moves and nothing is left out.

/// The weights with which texels of one row make a texel of another: the first texel and what follows it. They sum to
/// one.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Taps {
    pub(super) first: usize,
    pub(super) weights: Vec<f64>,
}

impl Taps {
    /// Those of `weight` at texels `first..end`, divided by their sum.
    fn new(first: usize, end: usize, weight: impl Fn(usize) -> f64) -> Self {
        let weights: Vec<f64> = (first..end).map(weight).collect();
        let sum: f64 = weights.iter().sum();
        Self { first, weights: weights.into_iter().map(|weight| weight / sum).collect() }
    }
}

/// A filter along an axis: taps for each texel of what it makes.
pub(super) type Filter = Vec<Taps>;

/// How many texels level `level` of `size` texels has.
pub(super) fn size_of(size: usize, level: usize) -> usize {
    (size >> level).max(1)
}

/// From `from` texels to `to` fewer: a tent that reaches from a texel to the middles of its neighbours. Where sizes are
/// even this is `[1 3 3 1] / 8`. A single texel is the mean of those below it.
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

/// `[beside, 1 - 2 beside, beside]` within a level.
pub(super) fn widened(size: usize, beside: f64) -> Filter {
    let weight = |i: usize| move |j: usize| if i == j { 1.0 - 2.0 * beside } else { beside };
    (0..size).map(|i| Taps::new(i.saturating_sub(1), (i + 2).min(size), weight(i))).collect()
}

/// From `from` texels to `to`, more or fewer: the mean of what of them lies in each.
pub(super) fn averaged(from: usize, to: usize) -> Filter {
    let edge = |i: usize| i as f64 * from as f64 / to as f64;
    let taps = |i: usize| {
        let (begin, end) = (edge(i), edge(i + 1));
        // Rounding may move an edge that lies between two texels; a texel of which nothing is inside is left out.
        let last = (end.ceil() as usize).clamp(begin as usize + 1, from);
        Taps::new(begin as usize, last, |j| ((j + 1) as f64).min(end) - (j as f64).max(begin))
    };
    (0..to).map(taps).collect()
}

/// From `from` texels to `to` more, linearly between their middles.
pub(super) fn enlarged(from: usize, to: usize) -> Filter {
    let taps = |i: usize| {
        let middle = ((i as f64 + 0.5) * from as f64 / to as f64 - 0.5).max(0.0).min((from - 1) as f64);
        let first = middle as usize;
        let along = middle - first as f64;
        Taps::new(first, (first + 2).min(from), |j| if j == first { 1.0 - along } else { along })
    };
    (0..to).map(taps).collect()
}

/// By how much [`widened`] has to spread level `level` of `size` texels. Halving makes a kernel of variance
/// `(4^level - 1) / 4` square texels of the image where all sizes are even, which a quarter at either side raises to
/// `(3 4^level - 1) / 4`. Where sizes are odd, texels are longer and halving spreads more; so much less is left to do.
/// A tent of half width s over texels of length t has variance `s^2 / 6 + t^2 / 12`, exact where 2 t = s.
pub(super) fn beside(size: usize, level: usize) -> f64 {
    let length = |level| size as f64 / size_of(size, level) as f64;
    let halves = |level: &usize| size_of(size, *level) > size_of(size, level + 1);
    let halving = |level| length(level + 1).powi(2) / 6.0 + length(level).powi(2) / 12.0;
    let halved: f64 = (0..level).filter(halves).map(halving).sum();
    let wanted = 0.75 * (1_u64 << (2 * level)) as f64 - 0.25;
    ((wanted - halved) / (2.0 * length(level).powi(2))).max(0.0)
}
