//! A small network of rectified linear units.

use ltcforge_fit::math::Scalar;

/// A network with one layer of rectified linear units: `outputs = O max(H inputs + h, 0) + o`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Network<'a> {
    /// The rows of H, one for each unit. The last number of a row is the unit's bias in h.
    pub units: &'a [&'a [f64]],
    /// The rows of O, one for each output. The last number of a row is the output's bias in o.
    pub outputs: &'a [&'a [f64]],
}

impl Network<'_> {
    /// Evaluates the network. Domain: each row of H has one more number than there are inputs, and O has OUTPUTS rows.
    #[must_use]
    pub fn at<T: Scalar, const OUTPUTS: usize>(&self, inputs: &[T]) -> [T; OUTPUTS] {
        let sum = |row: &[f64], of: &[T]| {
            let (last, row) = row.split_last().map_or((0.0, row), |(last, row)| (*last, row));
            row.iter().zip(of).fold(T::of(last), |sum, (x, of)| sum + T::of(*x) * *of)
        };
        let units: Vec<T> = self.units.iter().map(|row| sum(row, inputs).max(T::ZERO)).collect();
        std::array::from_fn(|i| self.outputs.get(i).map_or(T::ZERO, |row| sum(row, &units)))
    }
}
