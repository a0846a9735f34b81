//! Gram's polynomials: those that are orthonormal on evenly spaced nodes. Smooth functions need few of them, and unlike
//! cosines they need no more where a function ends in a slope.
//!
//! With `t = i - (n - 1) / 2` and `w_k = sqrt(k^2 (n^2 - k^2) / (4 (4 k^2 - 1)))`, on nodes `i = 0 .. n - 1`,
//!
//! ```text
//! G_0 = 1 / sqrt(n),    w_(k+1) G_(k+1) = t G_k - w_k G_(k-1)
//! ```
//!
//! [Gram 1883; the three terms in Gautschi 2004, section 1.5]. Only products, quotients and square roots occur, so that
//! the values have the same bits everywhere.

/// The most polynomials of any axis.
pub(super) const MOST_POLYNOMIALS: usize = 28;

/// As many polynomials as the three terms keep orthonormal: to 1e-12, and in 32 bits to 1e-3. The recurrence loses
/// digits as their number comes near that of the nodes.
pub(super) fn most_polynomials(nodes: usize) -> usize {
    nodes.min(16).max((nodes / 2 + 4).min(MOST_POLYNOMIALS).min(nodes))
}

/// The polynomials of one axis.
pub(super) struct Basis {
    nodes: usize,
    /// One row of `nodes` values for each polynomial.
    values: Vec<f64>,
}

impl Basis {
    /// The first `count` polynomials. Domain: `1 <= count <= nodes`.
    pub(super) fn new(nodes: usize, count: usize) -> Self {
        let n = nodes as f64;
        let mut values = vec![1.0 / n.sqrt(); nodes];
        let mut previous_weight = 0.0;
        for k in 1..count {
            let square = (k * k) as f64;
            let weight = (square * (n * n - square) / (4.0 * (4.0 * square - 1.0))).sqrt();
            for i in 0..nodes {
                let t = i as f64 - 0.5 * (n - 1.0);
                let last = values[(k - 1) * nodes + i];
                let before = if k > 1 { values[(k - 2) * nodes + i] } else { 0.0 };
                values.push((t * last - previous_weight * before) / weight);
            }
            previous_weight = weight;
        }
        Self { nodes, values }
    }

    fn count(&self) -> usize {
        self.values.len() / self.nodes
    }

    /// How many nodes there are.
    pub(super) fn nodes(&self) -> usize {
        self.nodes
    }

    /// The polynomial `k` at the node `i`.
    fn at(&self, k: usize, i: usize) -> f64 {
        self.values[k * self.nodes + i]
    }
}

/// The bases of the four axes.
pub(super) struct Bases([Basis; 4]);

impl Bases {
    /// Domain: as of [`Basis::new`].
    pub(super) fn new(nodes: [usize; 4], counts: [usize; 4]) -> Self {
        Self(std::array::from_fn(|axis| Basis::new(nodes[axis], counts[axis])))
    }

    /// Coefficients of each axis.
    pub(super) fn counts(&self) -> [usize; 4] {
        std::array::from_fn(|axis| self.0[axis].count())
    }

    /// Nodes of each axis.
    pub(super) fn nodes(&self) -> [usize; 4] {
        std::array::from_fn(|axis| self.0[axis].nodes())
    }

    /// The coefficients that come nearest to values at the nodes.
    pub(super) fn coefficients(&self, mut values: Vec<f64>) -> Vec<f64> {
        for axis in 0..4 {
            let (basis, after) = (&self.0[axis], self.0[axis + 1..].iter().map(Basis::nodes).product());
            values = along(&values, basis.nodes(), basis.count(), after, |k, i| basis.at(k, i));
        }
        values
    }

    /// The values at the nodes of coefficients.
    pub(super) fn values(&self, mut coefficients: Vec<f64>) -> Vec<f64> {
        for axis in (0..4).rev() {
            let (basis, after) = (&self.0[axis], self.0[axis + 1..].iter().map(Basis::nodes).product());
            coefficients = along(&coefficients, basis.count(), basis.nodes(), after, |i, k| basis.at(k, i));
        }
        coefficients
    }
}

/// Multiplies an array along one axis, of `from` elements with `after` numbers each, by a matrix of `to` rows.
fn along(array: &[f64], from: usize, to: usize, after: usize, matrix: impl Fn(usize, usize) -> f64) -> Vec<f64> {
    let before = array.len() / (from * after);
    let mut product = vec![0.0; before * to * after];
    for (block, sums) in array.chunks_exact(from * after).zip(product.chunks_exact_mut(to * after)) {
        for (row, sums) in sums.chunks_exact_mut(after).enumerate() {
            for (column, numbers) in block.chunks_exact(after).enumerate() {
                let factor = matrix(row, column);
                for (sum, number) in sums.iter_mut().zip(numbers) {
                    *sum += factor * number;
                }
            }
        }
    }
    product
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
