//! A small network of rectified linear units.

use ltcforge_fit::math::Scalar;

/// `outputs = O max(H inputs + h, 0) + o`: one layer of rectified linear units between its inputs and outputs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Network<'a> {
    /// Rows of H, each with its number of h behind it: one row a unit.
    pub units: &'a [&'a [f64]],
    /// Rows of O, each with its number of o behind it: one row an output.
    pub outputs: &'a [&'a [f64]],
}

impl Network<'_> {
    /// The outputs. Domain: as many inputs as a row of the units has numbers but one, and OUTPUTS rows of outputs.
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
