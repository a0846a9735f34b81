//! Counts samples in cells with integers. Integer sums are exact, so the order of the samples does not matter.

use super::cells::{CELLS, FRACTION_BITS};

/// Bits of a sample's position inside its cell. With this number, a sample of weight [`WHOLE`] fits both halves of a
/// word.
const PLACE_BITS: u32 = 14;
/// The largest total weight of all samples.
pub(super) const WHOLE: u32 = 1 << 30;
/// The weight of a sample if all samples have the same weight. With this weight, the lower half of a word is simply the
/// sum of the positions inside the cell.
pub(super) const EQUAL: u32 = 1 << PLACE_BITS;
/// The largest number of samples of this weight.
pub(super) const MOST_SAMPLES: usize = (WHOLE / EQUAL) as usize;

/// The weight in each cell, and the cumulative weight below the node after it.
///
/// The two nodes around a sample share its weight in proportion (cloud-in-cell). For a sample at the fraction `f` of
/// its cell, the node before it gets `1 - f` of the weight and the node after it gets `f`. The cumulative weight below
/// the node after a cell is the weight of all samples up to and in the cell, minus the weight times `f` of the samples
/// in the cell. One update of a word adds both: the weight in its upper half, and the weight times `f` in its lower
/// half.
#[derive(Debug)]
pub(super) struct Histogram {
    words: Box<[u64; CELLS]>,
    below: Vec<i32>,
}

impl Default for Histogram {
    fn default() -> Self {
        Self { words: Box::new([0; CELLS]), below: Vec::new() }
    }
}

/// The positions of samples in cells.
#[derive(Debug, Default)]
pub(super) struct Places {
    pub(super) cells: Vec<u32>,
    /// The positions inside the cells, in units of `2^-PLACE_BITS`.
    pub(super) parts: Vec<u32>,
}

impl Places {
    pub(super) fn resize(&mut self, count: usize) {
        self.cells.resize(count, 0);
        self.parts.resize(count, 0);
    }
}

/// Splits a fixed-point position into a cell and a position inside the cell. Domain: not negative.
#[inline]
pub(super) fn split(position: i32) -> (u32, u32) {
    let position = position.cast_unsigned();
    (position >> FRACTION_BITS, (position >> (FRACTION_BITS - PLACE_BITS)) & ((1 << PLACE_BITS) - 1))
}

impl Histogram {
    /// Adds samples with weights. Domain: the total weight is at most [`WHOLE`], up to the rounding of each weight.
    pub(super) fn add(&mut self, places: &Places, weights: &[u32]) {
        for ((cell, part), weight) in places.cells.iter().zip(&places.parts).zip(weights) {
            let (weight, part) = (u64::from(*weight), u64::from(*part));
            self.words[*cell as usize & (CELLS - 1)] += (weight << 32) | (weight * part) >> PLACE_BITS;
        }
    }

    /// Adds the first `count` samples, each of the weight [`EQUAL`].
    pub(super) fn add_equal(&mut self, places: &Places, count: usize) {
        for (cell, part) in places.cells[..count].iter().zip(&places.parts) {
            self.words[*cell as usize & (CELLS - 1)] += (u64::from(EQUAL) << 32) + u64::from(*part);
        }
    }

    /// Accumulates the first `cells` cells and clears them.
    pub(super) fn drain(&mut self, cells: usize) {
        self.below.resize(cells, 0);
        let mut upto = 0;
        for (word, below) in self.words.iter_mut().zip(&mut self.below) {
            upto += (*word >> 32) as i32;
            *below = upto - *word as i32;
            *word = 0;
        }
    }

    /// The cumulative weights below the node after each drained cell.
    pub(super) fn below(&self) -> &[i32] {
        &self.below
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn below(histogram: &mut Histogram) -> [f64; 4] {
        histogram.drain(4);
        std::array::from_fn(|cell| f64::from(histogram.below()[cell]))
    }

    #[test]
    fn a_sample_is_shared_between_the_nodes_around_it() {
        let places = Places { cells: vec![1, 2, 1], parts: vec![0, EQUAL / 4, EQUAL / 2] };
        let mut histogram = Histogram::default();
        let whole = f64::from(EQUAL);
        histogram.add_equal(&places, 3);
        assert_eq!(below(&mut histogram), [0.0, 1.5 * whole, 2.75 * whole, 3.0 * whole]);
        histogram.add(&places, &[2 * EQUAL, EQUAL, 0]);
        assert_eq!(below(&mut histogram), [0.0, 2.0 * whole, 2.75 * whole, 3.0 * whole]);
        assert_eq!(below(&mut histogram), [0.0; 4]);
    }

    /// Nothing carries from one half of a word into the other half or beyond the word.
    #[test]
    fn all_samples_fit_one_cell() {
        let mut histogram = Histogram::default();
        let places = Places { cells: vec![1; MOST_SAMPLES], parts: vec![EQUAL - 1; MOST_SAMPLES] };
        histogram.add_equal(&places, MOST_SAMPLES);
        assert_eq!(below(&mut histogram), [0.0, MOST_SAMPLES as f64, f64::from(WHOLE), f64::from(WHOLE)]);
        histogram.add(&Places { cells: vec![3], parts: vec![EQUAL - 1] }, &[WHOLE]);
        assert_eq!(below(&mut histogram), [0.0, 0.0, 0.0, f64::from(WHOLE / EQUAL)]);
    }
}
