//! Weighted least squares over a grid. It finds the numbers at the nodes such that their bilinear interpolation is
//! nearest to given numbers between the nodes.

/// Nodes of a grid, in storage order: the second axis varies fastest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Grid {
    pub(super) rows: usize,
    pub(super) columns: usize,
}

/// The largest number of conjugate gradient steps. A few dozen are usually enough.
const MOST_STEPS: usize = 200;
/// The iteration stops when the squared residual, in the norm of the preconditioner, has fallen by this factor.
const CONVERGED: f64 = 1e-20;
/// The weight of a pinned number, relative to the weight of its observations.
const PINNED: f64 = 1e8;

/// The normal equations `A x = b` with `D` numbers per node.
///
/// An observation at a point has target numbers `t`, a symmetric weight `W`, and the interpolation weights `phi` of the
/// four nodes around the point. It adds `phi_i phi_j W` to the block of `A` for each pair of nodes, and `phi_i W t` to
/// `b`.
pub(super) struct Normal<const D: usize> {
    grid: Grid,
    /// The blocks of each node with itself and its eight neighbours, in storage order.
    blocks: Vec<[[[f64; D]; D]; 9]>,
    right: Vec<[f64; D]>,
}

impl<const D: usize> Normal<D> {
    pub(super) fn new(grid: Grid) -> Self {
        let nodes = grid.rows * grid.columns;
        Self { grid, blocks: vec![[[[0.0; D]; D]; 9]; nodes], right: vec![[0.0; D]; nodes] }
    }

    /// Adds an observation in the cell whose first corner is the node at `row` and `column`. `at` is the position in
    /// the cell, in [0, 1].
    pub(super) fn observe(
        &mut self,
        [row, column]: [usize; 2],
        at: [f64; 2],
        weight: &[[f64; D]; D],
        target: &[f64; D],
    ) {
        let corners = corners(at);
        let weighed: [f64; D] = std::array::from_fn(|k| dot(&weight[k], target));
        for (down, right, phi) in corners {
            let node = (row + down) * self.grid.columns + column + right;
            for (k, sum) in self.right[node].iter_mut().enumerate() {
                *sum += phi * weighed[k];
            }
            for (other_down, other_right, other_phi) in corners {
                let neighbour = 3 * (1 + other_down - down) + 1 + other_right - right;
                let both = phi * other_phi;
                for (sums, weights) in self.blocks[node][neighbour].iter_mut().zip(weight) {
                    for (sum, weight) in sums.iter_mut().zip(weights) {
                        *sum += both * weight;
                    }
                }
            }
        }
    }

    /// Pulls each number of a node towards `x`. The weight is `part` times the weight of the number's observations. A
    /// pinned number is pulled strongly towards its pin.
    pub(super) fn regularise(&mut self, x: &[[f64; D]], part: f64, pins: &[[Option<f64>; D]]) {
        for (((blocks, right), x), pins) in self.blocks.iter_mut().zip(&mut self.right).zip(x).zip(pins) {
            for k in 0..D {
                // A number without observations gets a weight of one and keeps its value.
                let own = blocks[OWN][k][k];
                let part = pins[k].map_or(part, |_| PINNED);
                let weight = if own > 0.0 { part * own } else { 1.0 };
                let x = pins[k].unwrap_or(x[k]);
                blocks[OWN][k][k] += weight;
                right[k] += weight * x;
            }
        }
    }

    /// Solves the equations by conjugate gradients from the initial guess `x`. The preconditioner consists of the
    /// diagonal blocks.
    pub(super) fn solve(&self, mut x: Vec<[f64; D]>) -> Vec<[f64; D]> {
        let factors: Vec<[[f64; D]; D]> = self.blocks.iter().map(|blocks| cholesky(&blocks[OWN])).collect();
        let precondition =
            |r: &[[f64; D]]| -> Vec<[f64; D]> { r.iter().zip(&factors).map(|(r, factor)| solved(factor, r)).collect() };
        let mut residual = self.right.clone();
        for (r, ax) in residual.iter_mut().zip(self.times(&x)) {
            r.iter_mut().zip(ax).for_each(|(r, ax)| *r -= ax);
        }
        let mut z = precondition(&residual);
        let mut direction = z.clone();
        let mut size = inner(&residual, &z);
        let enough = size * CONVERGED;
        for _ in 0..MOST_STEPS {
            if size <= enough || size == 0.0 {
                break;
            }
            let moved = self.times(&direction);
            let step = size / inner(&direction, &moved);
            add(&mut x, &direction, step);
            add(&mut residual, &moved, -step);
            z = precondition(&residual);
            let next = inner(&residual, &z);
            for (d, z) in direction.iter_mut().zip(&z) {
                d.iter_mut().zip(z).for_each(|(d, z)| *d = z + next / size * *d);
            }
            size = next;
        }
        x
    }

    /// `A x`.
    fn times(&self, x: &[[f64; D]]) -> Vec<[f64; D]> {
        let Grid { rows, columns } = self.grid;
        let product = |node: usize| {
            let (row, column) = (node / columns, node % columns);
            let mut sum = [0.0; D];
            for neighbour in 0..9 {
                let (down, right) = (row + neighbour / 3, column + neighbour % 3);
                if (1..=rows).contains(&down) && (1..=columns).contains(&right) {
                    let x = &x[(down - 1) * columns + right - 1];
                    for (sum, weights) in sum.iter_mut().zip(&self.blocks[node][neighbour]) {
                        *sum += dot(weights, x);
                    }
                }
            }
            sum
        };
        (0..rows * columns).map(product).collect()
    }
}

/// The index of a node's block with itself among its nine blocks.
const OWN: usize = 4;

/// The corners of a cell, as steps down and to the right, with their bilinear weights at a point.
pub(super) fn corners([down, right]: [f64; 2]) -> [(usize, usize, f64); 4] {
    [
        (0, 0, (1.0 - down) * (1.0 - right)),
        (0, 1, (1.0 - down) * right),
        (1, 0, down * (1.0 - right)),
        (1, 1, down * right),
    ]
}

fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn inner<const D: usize>(a: &[[f64; D]], b: &[[f64; D]]) -> f64 {
    a.iter().zip(b).map(|(a, b)| dot(a, b)).sum()
}

fn add<const D: usize>(x: &mut [[f64; D]], y: &[[f64; D]], factor: f64) {
    for (x, y) in x.iter_mut().zip(y) {
        x.iter_mut().zip(y).for_each(|(x, y)| *x += factor * y);
    }
}

/// The lower triangle `L` of a symmetric, positive definite block `L L^T`.
fn cholesky<const D: usize>(block: &[[f64; D]; D]) -> [[f64; D]; D] {
    let mut lower = [[0.0; D]; D];
    for i in 0..D {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| lower[i][k] * lower[j][k]).sum();
            let left = block[i][j] - known;
            // In a direction without weight, rounding could otherwise make the pivot negative.
            lower[i][j] = if i == j { left.max(1e-12 * block[i][i]).sqrt() } else { left / lower[j][j] };
        }
    }
    lower
}

/// The solution of `L L^T x = b`.
fn solved<const D: usize>(lower: &[[f64; D]; D], b: &[f64; D]) -> [f64; D] {
    let mut x = *b;
    for i in 0..D {
        let known: f64 = (0..i).map(|k| lower[i][k] * x[k]).sum();
        x[i] = (x[i] - known) / lower[i][i];
    }
    for i in (0..D).rev() {
        let known: f64 = (i + 1..D).map(|k| lower[k][i] * x[k]).sum();
        x[i] = (x[i] - known) / lower[i][i];
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRID: Grid = Grid { rows: 5, columns: 7 };
    const THIRDS: [f64; 3] = [1.0 / 6.0, 0.5, 5.0 / 6.0];

    /// Observes `f` at nine points of each cell. The weight is not diagonal and differs from cell to cell.
    fn observed(f: impl Fn(f64, f64) -> [f64; 2]) -> Normal<2> {
        let mut normal = Normal::new(GRID);
        for (row, column) in (0..4).flat_map(|row| (0..6).map(move |column| (row, column))) {
            let much = [1.0, 10.0, 100.0, 1e3, 1e4][(row * 3 + column) % 5];
            for at in THIRDS.iter().flat_map(|x| THIRDS.map(|y| [*x, y])) {
                let target = f(row as f64 + at[0], column as f64 + at[1]);
                normal.observe([row, column], at, &[[2.0 * much, 0.5 * much], [0.5 * much, much]], &target);
            }
        }
        normal
    }

    #[test]
    fn functions_of_the_grid_are_recovered() {
        let f = |x: f64, y: f64| [1.0 + 2.0 * x - y + 0.3 * x * y, y - 4.0];
        let found = observed(f).solve(vec![[0.0; 2]; 35]);
        for (node, found) in found.iter().enumerate() {
            let wanted = f((node / 7) as f64, (node % 7) as f64);
            assert!((0..2).all(|k| (found[k] - wanted[k]).abs() < 1e-5), "{node}: {found:?} {wanted:?}");
        }
    }

    /// A convex function lies below its chords, so the best numbers at the nodes are below the function.
    #[test]
    fn the_solution_is_nearer_between_nodes_than_the_nodes_numbers() {
        let f = |x: f64, y: f64| [x * x, (0.5 * y).exp()];
        let own: Vec<[f64; 2]> = (0..35).map(|node: i32| f(f64::from(node / 7), f64::from(node % 7))).collect();
        let found = observed(f).solve(own.clone());
        let between = |nodes: &[[f64; 2]]| -> f64 {
            let mut sum = 0.0;
            for (row, column) in (0..4).flat_map(|row| (0..6).map(move |column| (row, column))) {
                for at in THIRDS.iter().flat_map(|x| THIRDS.map(|y| [*x, y])) {
                    let target = f(row as f64 + at[0], column as f64 + at[1]);
                    for k in 0..2 {
                        let of =
                            |(down, right, phi): (usize, usize, f64)| phi * nodes[(row + down) * 7 + column + right][k];
                        sum += (corners(at).map(of).iter().sum::<f64>() - target[k]).powi(2);
                    }
                }
            }
            sum
        };
        assert!(between(&found) < 0.5 * between(&own), "{} {}", between(&found), between(&own));
        let middle = 3 * 7 + 3;
        assert!(found[middle][0] < own[middle][0] && found[middle][1] < own[middle][1]);
    }

    #[test]
    fn numbers_without_observations_are_regularised_and_pins_win() {
        let mut normal = Normal::<2>::new(GRID);
        normal.observe([0, 0], [0.0, 0.0], &[[1.0, 0.0], [0.0, 0.0]], &[3.0, 9.0]);
        let regular = vec![[1.0, 2.0]; 35];
        let mut pins = vec![[None; 2]; 35];
        pins[20][1] = Some(7.0);
        normal.regularise(&regular, 0.0, &pins);
        let found = normal.solve(vec![[0.0; 2]; 35]);
        assert!((found[0][0] - 3.0).abs() < 1e-9 && (found[0][1] - 2.0).abs() < 1e-9, "{:?}", found[0]);
        assert!((found[20][0] - 1.0).abs() < 1e-9 && (found[20][1] - 7.0).abs() < 1e-6, "{:?}", found[20]);
        assert!((found[34][0] - 1.0).abs() < 1e-9 && (found[34][1] - 2.0).abs() < 1e-9, "{:?}", found[34]);
    }
}
