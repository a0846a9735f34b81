//! Gram's polynomials, which are orthonormal on evenly spaced nodes. A smooth function needs few of them, even if its
//! slope at the ends is not zero. Such a function would need many cosines.
//!
//! With `t = i - (n - 1) / 2` and `w_k = sqrt(k^2 (n^2 - k^2) / (4 (4 k^2 - 1)))`, on nodes `i = 0 .. n - 1`,
//!
//! ```text
//! G_0 = 1 / sqrt(n),    w_(k+1) G_(k+1) = t G_k - w_k G_(k-1)
//! ```
//!
//! [Gram 1883; the three-term recurrence in Gautschi 2004, section 1.5]. The code uses only products, quotients and
//! square roots, so the values have the same bits everywhere.

use super::decoder::{Bases, Basis, MOST_POLYNOMIALS, along};

/// The number of polynomials that the recurrence keeps orthonormal: to 1e-12, and in 32 bits to 1e-3. The recurrence
/// loses digits as this number approaches the number of nodes.
pub(super) fn most_polynomials(nodes: usize) -> usize {
    nodes.min(16).max((nodes / 2 + 4).min(MOST_POLYNOMIALS).min(nodes))
}

impl Bases {
    /// The numbers of coefficients of each axis.
    pub(crate) fn counts(&self) -> [usize; 4] {
        std::array::from_fn(|axis| self.0[axis].count())
    }

    /// The numbers of nodes of each axis.
    pub(crate) fn nodes(&self) -> [usize; 4] {
        std::array::from_fn(|axis| self.0[axis].nodes())
    }

    /// The coefficients of the sum of polynomials that is nearest to the values at the nodes.
    pub(super) fn coefficients(&self, mut values: Vec<f64>) -> Vec<f64> {
        for axis in 0..4 {
            let (basis, after) = (&self.0[axis], self.0[axis + 1..].iter().map(Basis::nodes).product());
            values = along(&values, basis.nodes(), basis.count(), after, |k, i| basis.at(k, i));
        }
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_orthonormal() {
        for nodes in [1, 2, 7, 28, 33, 64, 300] {
            let basis = Basis::new(nodes, most_polynomials(nodes));
            for one in 0..basis.count() {
                for other in 0..=one {
                    let product: f64 = (0..nodes).map(|i| basis.at(one, i) * basis.at(other, i)).sum();
                    let wanted = if one == other { 1.0 } else { 0.0 };
                    assert!((product - wanted).abs() < 1e-12, "{nodes}: {one} {other} {product}");
                }
            }
        }
    }

    #[test]
    fn a_polynomial_needs_no_more_coefficients_than_its_degree_says() {
        let (nodes, counts) = ([9, 1, 40, 3], [3, 1, 4, 2]);
        let bases = Bases::new(nodes, counts);
        let values: Vec<f64> = (0..9 * 40 * 3)
            .map(|i| {
                let (a, t, p) = (f64::from(i / 120), f64::from(i / 3 % 40), f64::from(i % 3));
                1.0 + a * a * 0.1 - 0.003 * t * t * t * (1.0 + p) + a * p
            })
            .collect();
        let coefficients = bases.coefficients(values.clone());
        assert_eq!(coefficients.len(), 24);
        for (value, again) in values.iter().zip(bases.values(coefficients)) {
            assert!((value - again).abs() < 1e-10, "{value} {again}");
        }
    }
}
