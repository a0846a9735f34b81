//! The difference of two cumulative distributions of weighted samples on a line.

/// The steps of `F - G` along a line: up by the weight at each sample of F, down at each sample of G.
///
/// Each step is one word. Its upper half has the bits of the position, changed to sort like the number. Its lower half
/// has the bits of the weight.
#[derive(Debug, Default)]
pub(super) struct Steps {
    steps: Vec<u64>,
    spare: Vec<u64>,
}

/// The integrals that [`Steps::areas`] returns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Areas {
    /// The integral of `|F - G|`, the Wasserstein-1 distance.
    pub(super) between: f64,
    /// The integral of `min(F, 1 - F)`: the mean absolute deviation of F's samples from their median.
    pub(super) deviation: f64,
}

/// Digits of the radix sort, by their lowest bit.
const DIGITS: [u32; 3] = [32, 43, 54];
/// Bits of a digit. The last digit has ten bits.
const DIGIT_BITS: u32 = 11;
const SIGN: u32 = 1 << 31;

impl Steps {
    pub(super) fn clear(&mut self) {
        self.steps.clear();
    }

    /// Adds steps with position and weight. Weights of F are positive, weights of G negative. Domain: finite numbers.
    pub(super) fn extend(&mut self, steps: impl Iterator<Item = (f32, f32)>) {
        self.steps
            .extend(steps.map(|(position, weight)| u64::from(ordered(position)) << 32 | u64::from(weight.to_bits())));
    }

    /// Sorts the steps and integrates over them. Domain: the weights of F and of G sum to 1 and -1.
    pub(super) fn areas(&mut self) -> Areas {
        self.sort();
        let (mut f, mut difference) = (0.0, 0.0);
        let mut areas = Areas { between: 0.0, deviation: 0.0 };
        let mut last = self.steps.first().map_or(0.0, |step| position(*step));
        for step in &self.steps {
            let (x, weight) = (position(*step), f64::from(f32::from_bits(*step as u32)));
            let gap = x - last;
            areas.between += f64::abs(difference) * gap;
            areas.deviation += f64::min(f, 1.0 - f).max(0.0) * gap;
            difference += weight;
            f += weight.max(0.0);
            last = x;
        }
        areas
    }

    /// Sorts by position. This is a radix sort from the lowest digit up.
    fn sort(&mut self) {
        let digit = |step: u64, lowest: u32| (step >> lowest) as usize & ((1 << DIGIT_BITS) - 1);
        let mut starts = vec![[0_u32; 1 << DIGIT_BITS]; DIGITS.len()];
        for step in &self.steps {
            for (counts, lowest) in starts.iter_mut().zip(DIGITS) {
                counts[digit(*step, lowest)] += 1;
            }
        }
        self.spare.resize(self.steps.len(), 0);
        for (starts, lowest) in starts.iter_mut().zip(DIGITS) {
            let mut before = 0;
            for start in starts.iter_mut() {
                before += std::mem::replace(start, before);
            }
            for step in &self.steps {
                let start = &mut starts[digit(*step, lowest)];
                self.spare[*start as usize] = *step;
                *start += 1;
            }
            std::mem::swap(&mut self.steps, &mut self.spare);
        }
    }
}

/// The bits of a number, changed to sort like the number. All bits of a negative number are inverted. For other numbers
/// only the sign bit is inverted.
fn ordered(x: f32) -> u32 {
    let bits = x.to_bits();
    if bits & SIGN == 0 { bits | SIGN } else { !bits }
}

fn position(step: u64) -> f64 {
    let bits = (step >> 32) as u32;
    f64::from(f32::from_bits(if bits & SIGN == 0 { !bits } else { bits & !SIGN }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn areas(f: &[(f32, f32)], g: &[(f32, f32)]) -> Areas {
        let mut steps = Steps::default();
        // Steps of an earlier call are discarded.
        steps.extend([(7.0, 1.0), (-7.0, -1.0)].into_iter());
        steps.areas();
        steps.clear();
        steps.extend(f.iter().copied());
        steps.extend(g.iter().map(|(position, weight)| (*position, -weight)));
        steps.areas()
    }

    #[test]
    fn a_few_planted_samples_have_their_closed_form() {
        // A quarter moves up by a half, three quarters move down by a half. The median is 1.
        let found = areas(&[(1.0, 0.75), (0.0, 0.25)], &[(0.5, 1.0)]);
        assert_eq!(found, Areas { between: 0.5, deviation: 0.25 });
        // Samples on both sides of zero: 0.5 moves to -3, 0.25 to -1 and 0.25 to 1.
        let found = areas(&[(-2.0, 0.5), (2.0, 0.5)], &[(1.0, 0.25), (-1.0, 0.25), (-3.0, 0.5)]);
        assert_eq!(found, Areas { between: 0.5 + 0.75 + 0.25, deviation: 2.0 });
        // Both signs of zero are the same position, and equal distributions have a distance of zero.
        assert_eq!(areas(&[(-0.0, 0.5), (0.0, 0.5)], &[(0.0, 1.0)]), Areas { between: 0.0, deviation: 0.0 });
    }

    /// Compares with cumulative distributions that are counted separately at each position, for numbers of all sizes.
    #[test]
    fn many_samples_have_the_areas_that_counting_gives() {
        let fraction = |i: u32, step: f64| (f64::from(i) * step).fract();
        let numbers = |n: u32, step: f64| -> Vec<(f32, f32)> {
            let weights: Vec<f64> = (1..=n).map(|i| fraction(i, 0.754_877_666_246_693)).collect();
            let total: f64 = weights.iter().sum();
            let position = |i: u32| (fraction(i, step) - 0.4) * 10_f64.powi(-(i.cast_signed() % 12));
            (1..=n).zip(weights).map(|(i, weight)| (position(i) as f32, (weight / total) as f32)).collect()
        };
        let (f, g) = (numbers(300, 0.569_840_290_998_053), numbers(170, 0.618_033_988_749_895));
        let mut places: Vec<f64> = f.iter().chain(&g).map(|(x, _)| f64::from(*x)).collect();
        places.sort_by(f64::total_cmp);
        let below = |samples: &[(f32, f32)], x: f64| -> f64 {
            samples.iter().filter(|sample| f64::from(sample.0) <= x).map(|sample| f64::from(sample.1)).sum()
        };
        let (mut between, mut deviation) = (0.0, 0.0);
        for pair in places.windows(2) {
            let gap = pair[1] - pair[0];
            between += (below(&f, pair[0]) - below(&g, pair[0])).abs() * gap;
            deviation += below(&f, pair[0]).min(1.0 - below(&f, pair[0])) * gap;
        }
        let found = areas(&f, &g);
        assert!(between > 1e-3 && deviation > 1e-3, "{between} {deviation}");
        assert!((found.between - between).abs() < 1e-7, "{found:?} {between}");
        assert!((found.deviation - deviation).abs() < 1e-7, "{found:?} {deviation}");
    }
}
