//! Arrays of small integers as bits: most are zero, and large ones stand beside large ones.
//!
//! An integer is the length of its magnitude in bits, unary; the magnitude's bits below the highest; and its sign. The
//! chance of each bit of the length depends on the neighbours that were read before: on the length in bits of
//! `sum over the axes of 2 |one step back| + |two steps back|`.

use super::coder::{Chance, Decoder, Encoder};

/// The longest magnitude in bits.
pub(super) const MOST_BITS: usize = 24;
/// Neighbourhoods that are told apart.
const NEIGHBOURHOODS: usize = 13;

/// The adaptive models of one kind of array.
pub(super) struct Models {
    /// By neighbourhood and bits so far: whether the magnitude is longer.
    lengths: [[Chance; MOST_BITS]; NEIGHBOURHOODS],
    /// By length: the bit below the highest.
    seconds: [Chance; MOST_BITS + 1],
    /// The bits below that.
    low: Chance,
    sign: Chance,
}

impl Models {
    pub(super) fn new() -> Self {
        Self {
            lengths: [[Chance::EVEN; MOST_BITS]; NEIGHBOURHOODS],
            seconds: [Chance::EVEN; MOST_BITS + 1],
            low: Chance::EVEN,
            sign: Chance::EVEN,
        }
    }

    /// Writes an array of these lengths, the last axis fastest. Domain: magnitudes below 2^[`MOST_BITS`].
    pub(super) fn write(&mut self, lengths: [usize; 4], numbers: &[i32], to: &mut Encoder) {
        for (i, number) in numbers.iter().enumerate() {
            let neighbourhood = neighbourhood(lengths, numbers, i);
            let magnitude = number.unsigned_abs();
            let bits = (u32::BITS - magnitude.leading_zeros()) as usize;
            let longer = &mut self.lengths[neighbourhood];
            for (length, chance) in longer.iter_mut().enumerate().take(bits + 1) {
                to.write(chance, length < bits);
            }
            for place in (0..bits.saturating_sub(1)).rev() {
                let chance = if place + 2 == bits { &mut self.seconds[bits] } else { &mut self.low };
                to.write(chance, magnitude >> place & 1 == 1);
            }
            if bits > 0 {
                to.write(&mut self.sign, *number < 0);
            }
        }
    }

    /// The inverse of [`Self::write`]; `None` where the bytes end.
    pub(super) fn read(&mut self, lengths: [usize; 4], from: &mut Decoder<'_>) -> Option<Vec<i32>> {
        let mut numbers = vec![0; lengths.iter().product()];
        for i in 0..numbers.len() {
            let longer = &mut self.lengths[neighbourhood(lengths, &numbers, i)];
            let mut bits = 0;
            while bits < MOST_BITS && from.read(&mut longer[bits])? {
                bits += 1;
            }
            if bits == 0 {
                continue;
            }
            let mut magnitude = 1;
            for place in (0..bits - 1).rev() {
                let chance = if place + 2 == bits { &mut self.seconds[bits] } else { &mut self.low };
                magnitude = 2 * magnitude + i32::from(from.read(chance)?);
            }
            numbers[i] = if from.read(&mut self.sign)? { -magnitude } else { magnitude };
        }
        Some(numbers)
    }
}

/// Which neighbourhood the element `i` has.
fn neighbourhood([_, ratio, theta, phi]: [usize; 4], numbers: &[i32], i: usize) -> usize {
    let steps = [(i / (phi * theta * ratio), phi * theta * ratio), (i / (phi * theta) % ratio, phi * theta)];
    let steps = steps.into_iter().chain([(i / phi % theta, phi), (i % phi, 1)]);
    let mut sum = 0;
    for (place, step) in steps {
        for (back, weight) in [(1, 2), (2, 1)] {
            if place >= back {
                sum += weight * numbers[i - back * step].unsigned_abs();
            }
        }
    }
    ((u32::BITS - sum.leading_zeros()) as usize).min(NEIGHBOURHOODS - 1)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn numbers() -> impl Strategy<Value = ([usize; 4], Vec<i32>)> {
        let most = (1 << MOST_BITS) - 1;
        prop::array::uniform4(1_usize..5).prop_flat_map(move |lengths| {
            let number = prop_oneof![4 => Just(0), 2 => -3..=3, 1 => -most..=most];
            (Just(lengths), prop::collection::vec(number, lengths.iter().product::<usize>()))
        })
    }

    proptest! {
        #[test]
        fn arrays_round_trip((lengths, numbers) in numbers()) {
            let mut encoder = Encoder::new();
            Models::new().write(lengths, &numbers, &mut encoder);
            let bytes = encoder.finish();
            let mut decoder = Decoder::new(&bytes).expect("bytes");
            prop_assert_eq!(Models::new().read(lengths, &mut decoder), Some(numbers));
            prop_assert_eq!(decoder.left(), 0);
        }
    }
}
