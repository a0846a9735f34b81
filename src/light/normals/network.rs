//! A small network of smooth units.

use ltcforge_fit::math::Scalar;

/// A network with one layer of smooth units: `outputs = O (h + sqrt(h h + 1)) + o` with `h = H inputs + b`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Network<'a> {
    /// The rows of H, one for each unit. The last number of a row is the unit's bias in b.
    pub units: &'a [&'a [f64]],
    /// The rows of O, one for each output. The last number of a row is the output's bias in o.
    pub outputs: &'a [&'a [f64]],
}

impl Network<'_> {
    /// Evaluates the network. Domain: a row of H has at most one number more than there are inputs. Outputs without
    /// a row are zero.
    #[must_use]
    pub fn at<T: Scalar, const OUTPUTS: usize>(&self, inputs: &[T]) -> [T; OUTPUTS] {
        let sum = |row: &[f64], of: &[T]| {
            let (last, row) = row.split_last().map_or((0.0, row), |(last, row)| (*last, row));
            row.iter().zip(of).fold(T::of(last), |sum, (x, of)| sum + T::of(*x) * *of)
        };
        let unit = |row: &&[f64]| {
            let h = sum(row, inputs);
            h + (h * h + T::ONE).sqrt()
        };
        let units: Vec<T> = self.units.iter().map(unit).collect();
        std::array::from_fn(|i| self.outputs.get(i).map_or(T::ZERO, |row| sum(row, &units)))
    }
}
