//! How much of a scene's surface has which roughness, and from where it is seen.

use std::{collections::BTreeMap, f64::consts::FRAC_PI_2};

use serde::Serialize;

/// Cells of perceptual roughness and of ratio from 0 to 1. An image's 256 levels fall into different cells.
const CELLS: [f64; 2] = [1024.0, 256.0];
/// Cells of the angle of a view and of its azimuth, over a quarter of a turn each.
const VIEWS: [usize; 2] = [45, 18];

/// A roughness, and how much of a surface has it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spot {
    /// Larger roughness, GGX alpha.
    pub alpha: f64,
    /// Smaller over larger roughness.
    pub ratio: f64,
    /// Surface that has it, weighed by the strength of its lobe.
    pub weight: f64,
}

/// A histogram over roughness and ratio, with the mean of both in each cell: a cell with one value has that value.
#[derive(Debug, Clone, Default)]
pub(crate) struct Histogram {
    cells: BTreeMap<[u16; 2], Cell>,
    /// Weighted sums of the metal part, of metal's reflectance, and of the reflectance of the rest.
    metal: [f64; 2],
    dielectric: [f64; 2],
}

#[derive(Debug, Clone, Copy)]
struct Cell {
    weight: f64,
    /// The first value, and the weighted sum of the differences from it.
    first: [f64; 2],
    moved: [f64; 2],
}

impl Histogram {
    /// Adds surface of a roughness.
    pub(crate) fn add(&mut self, alpha: f64, ratio: f64, weight: f64) {
        if weight <= 0.0 {
            return;
        }
        let key = [(alpha.sqrt(), CELLS[0]), (ratio, CELLS[1])].map(|(x, cells)| (x * cells).round() as u16);
        let cell = self.cells.entry(key).or_insert(Cell { weight: 0.0, first: [alpha, ratio], moved: [0.0; 2] });
        cell.weight += weight;
        for (moved, difference) in cell.moved.iter_mut().zip([alpha - cell.first[0], ratio - cell.first[1]]) {
            *moved += weight * difference;
        }
    }

    /// Adds reflectance seen from above: `metal` is the part that is metal, with its own.
    pub(crate) fn add_f0(&mut self, [part, of_metal]: [f64; 2], of_rest: f64, weight: f64) {
        for (sum, [weight, f0]) in
            [(&mut self.metal, [weight * part, of_metal]), (&mut self.dielectric, [weight * (1.0 - part), of_rest])]
        {
            sum[0] += weight;
            sum[1] += weight * f0;
        }
    }

    /// Adds all of another histogram.
    pub(crate) fn merge(&mut self, other: &Self) {
        for (key, of) in &other.cells {
            let cell = self.cells.entry(*key).or_insert(Cell { weight: 0.0, moved: [0.0; 2], ..*of });
            cell.weight += of.weight;
            for i in 0..2 {
                cell.moved[i] += of.moved[i] + of.weight * (of.first[i] - cell.first[i]);
            }
        }
        for (sums, others) in [(&mut self.metal, other.metal), (&mut self.dielectric, other.dielectric)] {
            sums.iter_mut().zip(others).for_each(|(sum, other)| *sum += other);
        }
    }

    /// The cells, the smoothest first.
    pub(crate) fn spots(&self) -> Vec<Spot> {
        let spot = |cell: &Cell| Spot {
            alpha: cell.first[0] + cell.moved[0] / cell.weight,
            ratio: cell.first[1] + cell.moved[1] / cell.weight,
            weight: cell.weight,
        };
        self.cells.values().map(spot).collect()
    }

    /// Reflectance seen from above with its weight, of metal and of dielectrics.
    pub(crate) fn f0(&self) -> Vec<[f64; 2]> {
        let mean = |[weight, sum]: [f64; 2]| (weight > 0.0).then(|| [sum / weight, weight]);
        [self.dielectric, self.metal].into_iter().filter_map(mean).collect()
    }
}

/// From where a surface is seen.
#[derive(Debug, Clone, PartialEq)]
pub struct Views {
    /// Cells of theta, and in each of them cells of phi; none where every view counts.
    weights: Vec<f64>,
    /// The least and the greatest angle.
    theta: [f64; 2],
    phi: [f64; 2],
}

impl Default for Views {
    fn default() -> Self {
        Self { weights: Vec::new(), theta: [FRAC_PI_2, 0.0], phi: [FRAC_PI_2, 0.0] }
    }
}

/// Most grazing view that is drawn: 89 degrees, as for a table's own report.
const STEEPEST: f64 = 0.99 * FRAC_PI_2;

impl Views {
    /// Adds a view, phi in the first quadrant.
    pub(crate) fn add(&mut self, theta: f64, phi: f64, weight: f64) {
        if self.weights.is_empty() {
            self.weights = vec![0.0; VIEWS[0] * VIEWS[1]];
        }
        let cell = |x: f64, cells: usize| ((x / FRAC_PI_2 * cells as f64) as usize).min(cells - 1);
        self.weights[cell(theta, VIEWS[0]) * VIEWS[1] + cell(phi, VIEWS[1])] += weight;
        for (range, x) in [(&mut self.theta, theta), (&mut self.phi, phi)] {
            *range = [range[0].min(x), range[1].max(x)];
        }
    }

    /// Adds all of other views.
    pub(crate) fn merge(&mut self, other: &Self) {
        if self.weights.is_empty() {
            self.weights.clone_from(&other.weights);
        } else {
            self.weights.iter_mut().zip(&other.weights).for_each(|(weight, other)| *weight += other);
        }
        for (range, [low, high]) in [(&mut self.theta, other.theta), (&mut self.phi, other.phi)] {
            *range = [range[0].min(low), range[1].max(high)];
        }
    }

    /// Whether every view counts the same.
    #[must_use]
    pub fn is_all(&self) -> bool {
        self.weights.is_empty()
    }

    /// The range of theta.
    #[must_use]
    pub fn theta(&self) -> [f64; 2] {
        if self.is_all() { [0.0, FRAC_PI_2] } else { self.theta }
    }

    /// The range of phi.
    #[must_use]
    pub fn phi(&self) -> [f64; 2] {
        if self.is_all() { [0.0, FRAC_PI_2] } else { self.phi }
    }

    /// The view at two numbers in [0, 1).
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

/// The item that `u` in [0, 1) falls on among weighted ones, and how far it lies within. Domain: one item at least.
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

    #[test]
    fn a_cell_with_one_value_has_that_value() {
        let mut histogram = Histogram::default();
        for _ in 0..1000 {
            histogram.add(0.3, 1.0 / 3.0, 0.1);
        }
        histogram.add(0.1, 1.0, 3.0);
        let spots = histogram.spots();
        assert_eq!((spots[0].alpha, spots[0].ratio, spots[0].weight), (0.1, 1.0, 3.0));
        assert_eq!((spots[1].alpha, spots[1].ratio), (0.3, 1.0 / 3.0));
        assert!((spots[1].weight - 100.0).abs() < 1e-9);
    }

    #[test]
    fn parts_that_are_merged_are_as_one() {
        let values = [(0.3, 1.0, 0.5), (0.3002, 1.0, 1.5), (0.1, 0.25, 2.0), (0.3001, 1.0, 0.25)];
        let (mut whole, mut merged) = (Histogram::default(), Histogram::default());
        let (mut all_views, mut merged_views) = (Views::default(), Views::default());
        for part in values.chunks(2) {
            let (mut histogram, mut views) = (Histogram::default(), Views::default());
            for (alpha, ratio, weight) in part {
                for of in [&mut histogram, &mut whole] {
                    of.add(*alpha, *ratio, *weight);
                    of.add_f0([*ratio, 0.9], 0.04, *weight);
                }
                for of in [&mut views, &mut all_views] {
                    of.add(*alpha, *ratio, *weight);
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
    fn views_are_drawn_as_often_as_they_weigh() {
        let mut views = Views::default();
        assert!(views.is_all());
        views.add(0.2, 0.1, 3.0);
        views.add(1.2, 1.0, 1.0);
        let drawn: Vec<[f64; 2]> = (0..400).map(|i| views.draw((f64::from(i) + 0.5) / 400.0, 0.5)).collect();
        assert_eq!(drawn.iter().filter(|[theta, _]| *theta < 0.7).count(), 300);
        assert!(drawn.iter().all(|[theta, phi]| (0.2..=1.2).contains(theta) && (0.1..=1.0).contains(phi)));
    }
}
