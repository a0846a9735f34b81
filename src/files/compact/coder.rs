//! An adaptive binary range coder, as in LZMA [Pavlov 1999; Martin 1979]. Likely bits cost less space.
//!
//! A model stores the probability of a 0 in units of 2^-11, and moves it by a sixteenth of the way to each coded bit.
//! All arithmetic uses integers.

use super::decoder::{Chance, NARROW};

/// Writes bits.
pub(super) struct Encoder {
    low: u64,
    range: u32,
    /// The last byte that a carry can still change, and the number of 255s after it.
    pending: u8,
    ones: usize,
    /// Whether there is a pending byte. At first there is none, because the output would begin with a useless 0.
    begun: bool,
    bytes: Vec<u8>,
}

impl Encoder {
    pub(super) fn new() -> Self {
        Self { low: 0, range: u32::MAX, pending: 0, ones: 0, begun: false, bytes: Vec::new() }
    }

    pub(super) fn write(&mut self, chance: &mut Chance, bit: bool) {
        let bound = chance.bound(self.range);
        if bit {
            self.low += u64::from(bound);
            self.range -= bound;
        } else {
            self.range = bound;
        }
        chance.saw(bit);
        while self.range < NARROW {
            self.range <<= 8;
            self.shift();
        }
    }

    /// The bytes of all coded bits.
    pub(super) fn finish(mut self) -> Vec<u8> {
        for _ in 0..5 {
            self.shift();
        }
        self.bytes
    }

    /// Outputs the highest byte of `low` as soon as no carry can change it.
    fn shift(&mut self) {
        let (carry, next) = ((self.low >> 32) as u8, (self.low >> 24) as u8);
        if next != 0xff || carry != 0 {
            if self.begun {
                self.bytes.push(self.pending.wrapping_add(carry));
            }
            self.bytes.resize(self.bytes.len() + self.ones, 0xff_u8.wrapping_add(carry));
            (self.pending, self.ones, self.begun) = (next, 0, true);
        } else {
            self.ones += 1;
        }
        self.low = u64::from((self.low as u32) << 8);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::{super::decoder::Decoder, *};

    proptest! {
        #[test]
        fn bits_round_trip(bits in prop::collection::vec((0_usize..4, prop::bool::weighted(0.03)), 0..4000)) {
            let mut chances = [Chance::EVEN; 4];
            let mut encoder = Encoder::new();
            for (model, bit) in &bits {
                encoder.write(&mut chances[*model], *bit);
            }
            let bytes = encoder.finish();
            let mut chances = [Chance::EVEN; 4];
            let mut decoder = Decoder::new(&bytes).expect("four bytes");
            for (model, bit) in &bits {
                prop_assert_eq!(decoder.read(&mut chances[*model]), Some(*bit));
            }
            prop_assert_eq!(decoder.bytes.len(), 0);
        }
    }

    #[test]
    fn a_likely_bit_costs_less() {
        let mut chance = Chance::EVEN;
        let mut encoder = Encoder::new();
        for _ in 0..8000 {
            encoder.write(&mut chance, false);
        }
        assert!(encoder.finish().len() < 20);
    }

    #[test]
    fn bytes_that_end_early_are_an_error() {
        assert!(Decoder::new(&[1, 2, 3]).is_none());
        let mut decoder = Decoder::new(&[0x80, 2, 3, 4]).expect("four bytes");
        let mut chance = Chance::EVEN;
        assert!((0..100).any(|_| decoder.read(&mut chance).is_none()));
    }
}
