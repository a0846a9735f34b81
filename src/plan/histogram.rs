//! The roughnesses of a surface and the directions from which it is seen, each with its weight.

use std::{collections::BTreeMap, f64::consts::FRAC_PI_2};

use serde::Serialize;

use ltcforge_fit::{ALPHA_FLOOR, RATIO_FLOOR};

/// Numbers of cells of perceptual roughness and of ratio from 0 to 1. Each of an image's 256 levels has its own cell.
const CELLS: [f64; 2] = [1024.0, 256.0];
/// Numbers of cells of a view's polar angle and of its azimuth, over a quarter turn each.
const VIEWS: [usize; 2] = [45, 18];
/// The most grazing view that [`Views::draw`] returns: 89 degrees, as in the report of a table.
pub(crate) const STEEPEST: f64 = 0.99 * FRAC_PI_2;
/// Alpha and ratio are rounded to multiples of `1 / DECIMALS`. This removes the rounding errors of sums and
/// squares, which are below 1e-10.
const DECIMALS: f64 = 1e9;
/// The smallest reflectance at normal incidence that counts as metal. It is the reflectance of diamond.
pub(crate) const LEAST_METAL: f64 = 0.17;

/// A roughness with its weight.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spot {
    /// Larger roughness, GGX alpha.
    pub alpha: f64,
    /// Smaller over larger roughness.
    pub ratio: f64,
    /// The area with this roughness, times the strength of its lobe.
    pub weight: f64,
}

impl Spot {
    /// Alpha and ratio for a recipe: rounded, and within the limits of the fit.
    pub(crate) fn pair(&self) -> [f64; 2] {
        [self.alpha.max(ALPHA_FLOOR), self.ratio.max(RATIO_FLOOR)].map(decimal)
    }
}

/// A number without rounding errors in its last digits.
pub(crate) fn decimal(x: f64) -> f64 {
    (x * DECIMALS).round() / DECIMALS
}

/// The minimum and the maximum of some numbers.
pub(crate) fn span(numbers: impl Iterator<Item = f64>) -> [f64; 2] {
    numbers.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
}

/// Weighted sums of two values, and the weight.
type Sums = [f64; 3];

fn add(sums: &mut Sums, added: Sums) {
    sums.iter_mut().zip(added).for_each(|(sum, added)| *sum += added);
}

/// The means of the values, and the weight.
fn means([a, b, weight]: &Sums) -> [f64; 3] {
    [a / weight, b / weight, *weight]
}

/// A histogram over alpha and ratio with the mean of both in each cell.
#[derive(Debug, Clone, Default)]
pub(crate) struct Histogram {
    cells: BTreeMap<[u16; 2], Sums>,
    /// The reflectances at normal and at grazing incidence that lobes are fitted to: of dielectrics, then of metal.
    fitted: [Sums; 2],
    /// The same reflectances by the specification.
    formula: [Sums; 2],
}

impl Histogram {
    /// Adds a pair of alpha and ratio with its weight. `f0` lists the reflectances of dielectrics and of metal, each
    /// with its part of the surface.
    pub(crate) fn add(&mut self, [alpha, ratio]: [f64; 2], f0: [[f64; 2]; 2], weight: f64) {
        if weight <= 0.0 {
            return;
        }
        let key = [alpha.sqrt() * CELLS[0], ratio * CELLS[1]].map(|cell| cell.round() as u16);
        add(self.cells.entry(key).or_default(), [weight * alpha, weight * ratio, weight]);
        for (sums, [f0, part]) in self.fitted.iter_mut().zip(f0) {
            add(sums, [weight * part * f0, weight * part, weight * part]);
        }
    }

    /// Adds a reflectance at normal and at grazing incidence by the specification.
    pub(crate) fn add_formula(&mut self, [f0, f90]: [f64; 2], weight: f64) {
        let sums = &mut self.formula[usize::from(f0 >= LEAST_METAL * f90)];
        add(sums, [weight * f0, weight * f90, weight]);
    }

    /// The cells, smoothest first. Rounding removes the rounding errors of sums: a cell with one value has that value.
    pub(crate) fn spots(&self) -> Vec<Spot> {
        let spot = |[alpha, ratio, weight]: [f64; 3]| Spot { alpha: decimal(alpha), ratio: decimal(ratio), weight };
        self.cells.values().map(means).map(spot).collect()
    }

    /// Mean reflectance at normal incidence and its weight, of dielectrics and of metal.
    pub(crate) fn f0(&self) -> Vec<[f64; 2]> {
        self.fitted.iter().filter(|sums| sums[2] > 0.0).map(means).map(|[f0, _, weight]| [f0, weight]).collect()
    }

    /// Mean reflectances by the specification at normal and at grazing incidence, and their weights.
    pub(crate) fn formula(&self) -> Vec<[f64; 3]> {
        self.formula.iter().filter(|sums| sums[1] > 0.0).map(means).collect()
    }
}

/// The directions from which a surface is seen.
#[derive(Debug, Clone, PartialEq)]
pub struct Views {
    /// The weights of cells: rows of theta, columns of phi. Empty if every view counts the same.
    weights: Vec<f64>,
    /// The ranges of the polar angle, and of the azimuth in the first quadrant.
    pub(crate) theta: [f64; 2],
    pub(crate) phi: [f64; 2],
}

/// Every view.
impl Default for Views {
    fn default() -> Self {
        Self { weights: Vec::new(), theta: [0.0, FRAC_PI_2], phi: [0.0, FRAC_PI_2] }
    }
}

impl Views {
    /// Adds a view. The first view replaces the default.
    pub(crate) fn add(&mut self, theta: f64, phi: f64, weight: f64) {
        if self.is_all() {
            *self = Self { weights: vec![0.0; VIEWS[0] * VIEWS[1]], theta: [theta; 2], phi: [phi; 2] };
        }
        let cell = |x: f64, cells: usize| ((x / FRAC_PI_2 * cells as f64) as usize).min(cells - 1);
        self.weights[cell(theta, VIEWS[0]) * VIEWS[1] + cell(phi, VIEWS[1])] += weight;
        self.theta = span(self.theta.into_iter().chain([theta]));
        self.phi = span(self.phi.into_iter().chain([phi]));
    }

    /// Whether every view counts the same.
    pub(crate) fn is_all(&self) -> bool {
        self.weights.is_empty()
    }

    /// Draws a view from two numbers in [0, 1).
    pub(crate) fn draw(&self, u: f64, v: f64) -> [f64; 2] {
        if self.is_all() {
            return [u * STEEPEST, v * FRAC_PI_2];
        }
        let rows: Vec<f64> = self.weights.chunks_exact(VIEWS[1]).map(|row| row.iter().sum()).collect();
        let (row, u) = pick(&rows, u);
        let (column, v) = pick(&self.weights[row * VIEWS[1]..(row + 1) * VIEWS[1]], v);
        let at = |cell: usize, part: f64, cells: usize| (cell as f64 + part) / cells as f64 * FRAC_PI_2;
        let theta = at(row, u, VIEWS[0]).clamp(self.theta[0], self.theta[1]).min(STEEPEST);
        [theta, at(column, v, VIEWS[1]).clamp(self.phi[0], self.phi[1])]
    }
}

/// The index of the weighted item at `u` in [0, 1), and the position of `u` within the item. Domain: at least one item.
pub(crate) fn pick(weights: &[f64], u: f64) -> (usize, f64) {
    let total: f64 = weights.iter().sum();
    let (mut left, mut last) = (u * total, 0);
    for (index, weight) in weights.iter().enumerate().filter(|(_, weight)| **weight > 0.0) {
        if left < *weight {
            return (index, (left / weight).clamp(0.0, 1.0));
        }
        left -= weight;
        last = index;
    }
    (last, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const F0: [[f64; 2]; 2] = [[0.04, 1.0], [0.0; 2]];

    #[test]
    fn a_cell_with_one_value_has_that_value() {
        let mut histogram = Histogram::default();
        for _ in 0..1000 {
            histogram.add([0.3, 1.0 / 3.0], F0, 0.1);
        }
        histogram.add([0.1, 1.0], F0, 3.0);
        let spots = histogram.spots();
        assert_eq!((spots[0].alpha, spots[0].ratio, spots[0].weight), (0.1, 1.0, 3.0));
        assert_eq!((spots[1].alpha, spots[1].ratio), (0.3, decimal(1.0 / 3.0)));
        assert!((spots[1].weight - 100.0).abs() < 1e-9);
    }

    #[test]
    fn views_are_drawn_by_their_weights() {
        let mut views = Views::default();
        assert!(views.is_all());
        views.add(0.2, 0.1, 3.0);
        views.add(1.2, 1.0, 1.0);
        let drawn: Vec<[f64; 2]> = (0..400).map(|i| views.draw((f64::from(i) + 0.5) / 400.0, 0.5)).collect();
        assert_eq!(drawn.iter().filter(|[theta, _]| *theta < 0.7).count(), 300);
        assert!(drawn.iter().all(|[theta, phi]| (0.2..=1.2).contains(theta) && (0.1..=1.0).contains(phi)));
    }
}
