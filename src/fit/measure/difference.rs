//! Compares the lookups of two tables.

use glam::DMat3;
use serde::Serialize;

use super::places;
use crate::{Configuration, PerAxis, Table, math::from_row_major};

/// The differences between the lookups of two tables, over all compared points.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Difference {
    /// The number of points at which both tables were looked up.
    pub places: usize,
    /// Absolute difference of the elements of the matrices; [`difference`] explains how matrices are compared.
    pub matrix: Gap,
    /// Absolute difference of the amplitudes, if both tables have terms.
    pub amplitude: Option<Gap>,
    /// Absolute difference of the Fresnel terms, if both tables have terms.
    pub fresnel: Option<Gap>,
}

/// Differences of one quantity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Gap {
    /// Mean over all points.
    pub mean: f64,
    /// Largest difference.
    pub max: f64,
    /// The configuration of the largest difference: GGX roughness along x.
    pub alpha_x: f64,
    /// GGX roughness along y.
    pub alpha_y: f64,
    /// Polar angle of the view direction, radians.
    pub theta: f64,
    /// Azimuth of the view direction, radians.
    pub phi: f64,
}

/// Looks up two tables at up to `points` nodes of each, and at `points` configurations between nodes, in the ranges
/// that both tables cover. `None` if the tables have no range in common.
///
/// Matrices are compared by their distributions. A positive factor does not change the distribution, and neither does
/// turning or mirroring the clamped cosine about its axis. Each matrix is therefore divided by its Frobenius norm. The
/// first two columns of the second matrix are then turned or mirrored to be nearest to the first matrix (least
/// squares). The result is the largest difference of an element, at most 2. If both tables have second lobes, the
/// larger difference of the two lobes counts.
#[must_use]
pub fn difference(a: &Table, b: &Table, points: usize) -> Option<Difference> {
    let common = common(a, b)?;
    let of_materials: Vec<&Table> = [a, b].into_iter().filter(|table| table.layout.is_of_materials()).collect();
    let covered = |at: &Configuration| {
        let within = |(x, nodes): (&f64, &Vec<f64>)| nodes.iter().any(|n| n <= x) && nodes.iter().any(|n| n >= x);
        let folded = at.folded();
        let is_in_ranges =
            folded.named().iter().map(|(_, x)| *x).zip(common.named().map(|(_, nodes)| nodes)).all(within);
        is_in_ranges && of_materials.iter().all(|table| has_material(table, &folded))
    };
    let nodes = [a, b].map(|table| places::nodes(table.layout, &table.axes, points)).into_iter().flatten();
    // Tables of materials are compared only at their materials.
    let between = if of_materials.is_empty() {
        places::between(&common, points)
    } else {
        of_materials.iter().flat_map(|table| places::within(table, points)).filter(covered).collect()
    };
    let places = nodes.filter(covered).chain(between);
    let (mut matrix, mut amplitude, mut fresnel) = (Sum::default(), Sum::default(), Sum::default());
    for at in places {
        let [a, b] = [a, b].map(|table| table.lookup(&at));
        let lobes = [Some((a.matrix, b.matrix)), a.second.zip(b.second)];
        let gaps = lobes.into_iter().flatten().map(|(a, b)| apart(&from_row_major(&a), &from_row_major(&b)));
        matrix.add(gaps.reduce(|most, gap| if gap > most || gap.is_nan() { gap } else { most }).unwrap_or(0.0), at);
        for (sum, pair) in [(&mut amplitude, (a.amplitude, b.amplitude)), (&mut fresnel, (a.fresnel, b.fresnel))] {
            if let (Some(a), Some(b)) = pair {
                sum.add((a - b).abs(), at);
            }
        }
    }
    let places = matrix.count;
    let (amplitude, fresnel) = (amplitude.gap(), fresnel.gap());
    Some(Difference { places, matrix: matrix.gap()?, amplitude, fresnel })
}

/// True if a point has the roughness of a material of the table, up to rounding.
fn has_material(table: &Table, place: &PerAxis<f64>) -> bool {
    let is_it = |[alpha, ratio]: [f64; 2]| (alpha - place.alpha).abs() + (ratio - place.ratio).abs() < 1e-9;
    table.materials().any(is_it)
}

/// The ranges that the axes of both tables cover. A table with one phi that is valid for every phi does not limit phi.
fn common(a: &Table, b: &Table) -> Option<PerAxis<Vec<f64>>> {
    let ends = |a: &[f64], b: &[f64]| {
        let [[a_low, a_high], [b_low, b_high]] = [a, b].map(places::extent);
        let (low, high) = (a_low.max(b_low), a_high.min(b_high));
        (low <= high).then(|| vec![low, high])
    };
    let phi = match (a.serves_every_phi(), b.serves_every_phi()) {
        (true, _) => b.axes.phi.clone(),
        (false, true) => a.axes.phi.clone(),
        (false, false) => ends(&a.axes.phi, &b.axes.phi)?,
    };
    let (alpha, ratio) = (ends(&a.axes.alpha, &b.axes.alpha)?, ends(&a.axes.ratio, &b.axes.ratio)?);
    Some(PerAxis { alpha, ratio, theta: ends(&a.axes.theta, &b.axes.theta)?, phi })
}

/// The largest difference of an element, after the best turn or mirror.
///
/// `|A - B Q|` is least for the turn or mirror `Q` of the first two columns that maximises the sum of `a_i . (B Q)_i`.
/// With `g_ij = a_i . b_j` this sum is `c (g00 + g11) + s (g01 - g10)` for a turn by an angle of cosine c and sine s,
/// and `c (g00 - g11) + s (g01 + g10)` for a mirror.
fn apart(a: &DMat3, b: &DMat3) -> f64 {
    let norm = |m: &DMat3| (0..3).map(|i| m.col(i).length_squared()).sum::<f64>().sqrt();
    let (a, b) = (*a * norm(a).recip(), *b * norm(b).recip());
    let g = |i: usize, j: usize| a.col(i).dot(b.col(j));
    let turn = (g(0, 0) + g(1, 1), g(0, 1) - g(1, 0), 1.0);
    let mirror = (g(0, 0) - g(1, 1), g(0, 1) + g(1, 0), -1.0);
    let length = |(c, s, _): (f64, f64, f64)| c.hypot(s);
    let best = if length(turn) >= length(mirror) { turn } else { mirror };
    let (c, s) = if length(best) > 0.0 { (best.0 / length(best), best.1 / length(best)) } else { (1.0, 0.0) };
    let x = c * b.x_axis + s * b.y_axis;
    let y = best.2 * (c * b.y_axis - s * b.x_axis);
    let gap = a - DMat3::from_cols(x, y, b.z_axis);
    gap.to_cols_array().into_iter().map(f64::abs).fold(0.0, |most, x| if is_worse(x, most) { x } else { most })
}

/// True if a difference is worse than the worst so far. NaN is worse than every number.
fn is_worse(gap: f64, worst: f64) -> bool {
    gap > worst || gap.is_nan()
}

#[derive(Debug, Default)]
struct Sum {
    count: usize,
    total: f64,
    worst: Option<(f64, Configuration)>,
}

impl Sum {
    fn add(&mut self, gap: f64, at: Configuration) {
        self.count += 1;
        self.total += gap;
        if self.worst.is_none_or(|(worst, _)| is_worse(gap, worst)) {
            self.worst = Some((gap, at));
        }
    }

    fn gap(self) -> Option<Gap> {
        let (max, Configuration { alpha_x, alpha_y, theta, phi }) = self.worst?;
        Some(Gap { mean: self.total / self.count as f64, max, alpha_x, alpha_y, theta, phi })
    }
}

#[cfg(test)]
mod tests {
    use std::{f64::consts::FRAC_PI_2, ops::ControlFlow};

    use super::*;
    use crate::{
        BrdfKind, FITTER_VERSION, FitSettings, Layout, LobeModel, Metric, Plan, Precision, Recipe, Solver, StoredTerms,
        Terms, fit_plan,
    };

    fn fitted() -> Table {
        let quarter = [0.0, FRAC_PI_2];
        let recipe = Recipe {
            fitter: FITTER_VERSION,
            given: crate::GivenNodes::default(),
            brdf: BrdfKind::Ggx.into(),
            lobe: LobeModel::Ltc,
            layout: Layout::Kt2022,
            resolution: PerAxis { alpha: 3, ratio: 2, theta: 3, phi: 2 },
            range: PerAxis { alpha: [0.1, 1.0], ratio: [0.2, 1.0], theta: quarter, phi: quarter },
            fit: FitSettings {
                metric: Metric::Sw1,
                solver: Solver::Bfgs,
                samples: 64,
                directions: 4,
                steps: 5,
                seed: 0,
                simplex: None,
            },
            terms: StoredTerms::Schlick,
            precision: Precision::F32,
        };
        fit_plan(&Plan::new(&recipe), &|_| ControlFlow::Continue(())).expect("a table")
    }

    #[test]
    fn a_planted_difference_is_found_where_it_is() {
        let a = fitted();
        let same = difference(&a, &a, 64).expect("a common range");
        assert!(same.matrix.max < 1e-15 && same.amplitude.is_some_and(|gap| gap.max == 0.0), "{same:?}");

        // A factor, a turn and a mirror do not change a distribution.
        let turned = |m: &[f32; 9]| {
            let (c, s) = (0.6, 0.8);
            let mut turned = *m;
            for row in turned.chunks_mut(3) {
                (row[0], row[1], row[2]) =
                    (7.0 * (c * row[0] + s * row[1]), 7.0 * (s * row[0] - c * row[1]), 7.0 * row[2]);
            }
            turned
        };
        let b = Table { matrix: a.matrix.iter().map(turned).collect(), ..a.clone() };
        let gap = difference(&a, &b, 64).expect("a common range").matrix;
        assert!(gap.max < 1e-5, "{gap:?}");

        // Changes the lobe's direction at one node: the roughest surface at the horizon.
        let mut b = a.clone();
        let last = b.matrix.len() - 1;
        b.matrix[last][2] += 1.0;
        let Some(Terms { amplitude, .. }) = &mut b.terms else { panic!("no terms") };
        amplitude[last] += 0.25;
        let found = difference(&a, &b, 512).expect("a common range");
        assert!(found.matrix.max > 0.1, "{found:?}");
        let amplitude = found.amplitude.expect("both have terms");
        assert!((amplitude.max - 0.25).abs() < 1e-3 && amplitude.mean < 0.1, "{amplitude:?}");
        assert!(amplitude.alpha_x == 1.0 && amplitude.theta > 1.5, "{amplitude:?}");
        assert_eq!(found.fresnel.map(|gap| gap.max), Some(0.0));
    }

    #[test]
    fn numbers_of_only_one_table_are_not_compared() {
        let a = fitted();
        let none = difference(&a, &Table { terms: None, ..a.clone() }, 64).expect("a common range");
        assert!(none.amplitude.is_none() && none.fresnel.is_none());
        let mut far = a.clone();
        for alpha in &mut far.axes.alpha {
            *alpha += 2.0;
        }
        assert_eq!(difference(&a, &far, 64), None);
        // NaN is the largest difference.
        let mut b = a.clone();
        b.matrix[0][0] = f32::NAN;
        assert!(difference(&a, &b, 512).expect("a common range").matrix.max.is_nan());
    }
}
