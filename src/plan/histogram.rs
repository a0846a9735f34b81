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
/// Alpha and ratio are rounded to multiples of `1 / DECIMALS`. This removes the rounding errors in the last digits of
/// squares.
const DECIMALS: f64 = 1e12;
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

/// A histogram over alpha and ratio with the mean of both in each cell: a cell with one value has that value.
#[derive(Debug, Clone, Default)]
pub(crate) struct Histogram {
    cells: BTreeMap<[u16; 2], Cell>,
    /// The weight, and the weighted sum of the reflectance: of dielectrics, then of metal.
    f0: [[f64; 2]; 2],
    /// Weighted sums of the reflectances at normal and at grazing incidence, and the weight: of dielectrics, then of
    /// metal.
    formula: [[f64; 3]; 2],
}

#[derive(Debug, Clone, Copy)]
struct Cell {
    weight: f64,
    /// The first pair, and the weighted sum of the differences from it.
    first: [f64; 2],
    moved: [f64; 2],
}

impl Histogram {
    /// Adds a pair of alpha and ratio with its weight. `f0` lists the reflectances of dielectrics and of metal, each
    /// with its part of the surface.
    pub(crate) fn add(&mut self, pair: [f64; 2], f0: [[f64; 2]; 2], weight: f64) {
        if weight <= 0.0 {
            return;
        }
        let key = [pair[0].sqrt() * CELLS[0], pair[1] * CELLS[1]].map(|cell| cell.round() as u16);
        let cell = self.cells.entry(key).or_insert(Cell { weight: 0.0, first: pair, moved: [0.0; 2] });
        cell.weight += weight;
        for i in 0..2 {
            cell.moved[i] += weight * (pair[i] - cell.first[i]);
            let [f0, part] = f0[i];
            self.f0[i][0] += weight * part;
            self.f0[i][1] += weight * part * f0;
        }
    }

    /// Adds a reflectance at normal and at grazing incidence by the specification.
    pub(crate) fn add_formula(&mut self, [f0, f90]: [f64; 2], weight: f64) {
        let sums = &mut self.formula[usize::from(f0 >= LEAST_METAL * f90)];
        for (sum, value) in sums.iter_mut().zip([f0, f90, 1.0]) {
            *sum += weight * value;
        }
    }

    /// Means of the reflectances, and their weights.
    pub(crate) fn formula(&self) -> Vec<[f64; 3]> {
        let mean = |[f0, f90, weight]: &[f64; 3]| [f0 / weight, f90 / weight, *weight];
        self.formula.iter().filter(|[_, f90, _]| *f90 > 0.0).map(mean).collect()
    }

    /// Adds all of another histogram.
    pub(crate) fn merge(&mut self, other: &Self) {
        for (key, added) in &other.cells {
            let cell = self.cells.entry(*key).or_insert(Cell { weight: 0.0, moved: [0.0; 2], ..*added });
            cell.weight += added.weight;
            for i in 0..2 {
                cell.moved[i] += added.moved[i] + added.weight * (added.first[i] - cell.first[i]);
            }
        }
        let formula = self.formula.iter_mut().flatten().zip(other.formula.iter().flatten());
        self.f0
            .iter_mut()
            .flatten()
            .zip(other.f0.iter().flatten())
            .chain(formula)
            .for_each(|(sum, other)| *sum += other);
    }

    /// The cells, smoothest first.
    pub(crate) fn spots(&self) -> Vec<Spot> {
        let spot = |cell: &Cell| {
            let [alpha, ratio] = [0, 1].map(|i| cell.first[i] + cell.moved[i] / cell.weight);
            Spot { alpha, ratio, weight: cell.weight }
        };
        self.cells.values().map(spot).collect()
    }

    /// Mean reflectance at normal incidence and its weight, of dielectrics and of metal.
    pub(crate) fn f0(&self) -> Vec<[f64; 2]> {
        self.f0.iter().filter(|[weight, _]| *weight > 0.0).map(|[weight, sum]| [sum / weight, *weight]).collect()
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
        self.widen([theta; 2], [phi; 2]);
    }

    /// Adds other views.
    pub(crate) fn merge(&mut self, other: &Self) {
        if self.is_all() {
            self.clone_from(other);
        } else if !other.is_all() {
            self.weights.iter_mut().zip(&other.weights).for_each(|(weight, other)| *weight += other);
            self.widen(other.theta, other.phi);
        }
    }

    fn widen(&mut self, theta: [f64; 2], phi: [f64; 2]) {
        self.theta = span(self.theta.into_iter().chain(theta));
        self.phi = span(self.phi.into_iter().chain(phi));
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
        assert_eq!((spots[1].alpha, spots[1].ratio), (0.3, 1.0 / 3.0));
        assert!((spots[1].weight - 100.0).abs() < 1e-9);
    }

    #[test]
    fn merged_parts_equal_the_whole() {
        let values = [(0.3, 1.0, 0.5), (0.3002, 1.0, 1.5), (0.1, 0.25, 2.0), (0.3001, 1.0, 0.25)];
        let (mut whole, mut merged) = (Histogram::default(), Histogram::default());
        let (mut all_views, mut merged_views) = (Views::default(), Views::default());
        for part in values.chunks(2) {
            let (mut histogram, mut views) = (Histogram::default(), Views::default());
            for (alpha, ratio, weight) in part {
                for each in [&mut histogram, &mut whole] {
                    each.add([*alpha, *ratio], [[0.04, 1.0 - ratio], [0.9, *ratio]], *weight);
                }
                for each in [&mut views, &mut all_views] {
                    each.add(*alpha, *ratio, *weight);
                }
            }
            merged.merge(&histogram);
            merged_views.merge(&views);
        }
        assert_eq!((merged.spots().len(), merged_views), (2, all_views));
        for (merged, whole) in merged.spots().iter().zip(whole.spots()) {
            let near = |a: f64, b: f64| (a - b).abs() < 1e-15;
            assert!(near(merged.alpha, whole.alpha) && near(merged.weight, whole.weight), "{merged:?} {whole:?}");
        }
        assert_eq!(merged.f0(), whole.f0());
        let mut none = Views::default();
        none.merge(&Views::default());
        assert!(none.is_all());
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
