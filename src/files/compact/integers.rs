//! Arrays of small integers as bits. Most integers are zero, and large integers have large neighbours.
//!
//! An integer is coded as the number of bits of its magnitude, in unary, then the magnitude's bits below the highest,
//! then its sign. The probability of each unary bit depends on the neighbours that were read before: on the number of
//! bits of `sum over the axes of 2 |one step back| + |two steps back|`.

use super::{
    coder::Encoder,
    decoder::{Models, neighbourhood},
};

impl Models {
    /// Writes integers for [`Models::read`]. Domain: magnitudes below 2^[`MOST_BITS`](super::decoder::MOST_BITS).
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
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::{
        super::decoder::{Decoder, MOST_BITS},
        *,
    };

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
            prop_assert_eq!(decoder.bytes.len(), 0);
        }
    }
}
