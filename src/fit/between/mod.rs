//! Chooses entries that minimise the error *between* nodes.
//!
//! A renderer interpolates the stored numbers. If the best numbers are not linear between nodes, entries fitted at the
//! nodes leave an error in the middle of each cell. The lookup of some layouts is fixed by existing shaders. For these
//! layouts, the fit chooses numbers whose interpolation is nearest to the best lobes over whole cells.
//!
//! The best lobes between nodes need no extra fits: the fitted lobes are interpolated. Relative to the reflection
//! (layout `reflected`), lobes hardly change between neighbouring nodes. Lobes that do not follow the reflection hardly
//! change even in the frame of the surface.
//!
//! The squared distance of a lookup from the best lobe is about a quadratic form in the stored numbers. Let `M` be the
//! lobe's matrix and `N` its inverse. A change `dN` of `N` moves a direction `w` of the lobe by
//!
//! ```text
//! d(w) = -P M dN w,    P = I - w w^T;    and d(w) = P dM N w
//! ```
//!
//! up to higher orders. The mean square of the displacement over the lobe, divided by the square of the fit's error at
//! that point, is `dN^T W dN`. A sliced Wasserstein distance is a mean of absolute displacements. A displacement of `r`
//! times the error therefore increases the error by about the factor `sqrt(1 + r^2)`. Least squares runs in rounds to
//! account for this: each round computes its weights from the `r` of the previous round.

mod distance;
mod five;
mod least_squares;
mod lobes;

use glam::DMat3;

use self::{
    distance::Displacement,
    five::{matrix, numbers},
    least_squares::{Grid, Normal, corners},
    lobes::{InterpolatedLobe, Lobes},
};
use super::{
    brdf::LobeTerms,
    entry::FittedEntry,
    layout::{FreeNumbers, LobeNumbers, THETA_CEILING},
    shard::Plan,
};

/// Larger tables are stored as fitted. Their nodes are so dense that hardly any error remains between nodes.
const MOST_ENTRIES: usize = 65_536;
/// Rounds of least squares. A third round has no measurable effect.
const ROUNDS: usize = 2;
/// Observed positions along each side of a cell.
const POINTS: [f64; 3] = [1.0 / 6.0, 0.5, 5.0 / 6.0];
/// The weight that pulls an entry towards its fitted value, relative to the weight of its observations. An entry that
/// the observations hardly determine keeps its fitted value.
const REGULARISATION: f64 = 1e-3;
/// Views beyond this fraction of a right angle get little weight. Most of their lobe is below the horizon, where it is
/// not visible.
const STEEPEST: f64 = 0.99;
/// The weight of a view beyond [`STEEPEST`].
const STEEP_WEIGHT: f64 = 0.02;

/// The stored numbers of each entry, before rounding. `own` holds the numbers fitted to each entry's own lobe. Returns
/// `None` for a layout whose entries are stored as fitted, and for a table with too many entries or axes.
pub(super) fn chosen(plan: &Plan, entries: &[FittedEntry], own: &[LobeNumbers]) -> Option<Vec<LobeNumbers>> {
    let recipe = plan.recipe();
    let rules = recipe.layout.rules();
    let free = rules.free_numbers()?;
    let counts = plan.nodes().lengths();
    let grid = Grid { rows: counts.alpha, columns: counts.theta };
    if entries.len() != grid.rows * grid.columns || entries.len() > MOST_ENTRIES {
        return None;
    }
    let lobes = Lobes::of(plan, entries);
    let matrices = matrices(plan, grid, &lobes, own, free);
    let terms = terms(grid, &lobes, own);
    let limited = |(matrix, terms)| rules.limited(LobeNumbers { matrix, terms }, recipe.precision);
    Some(matrices.into_iter().zip(terms).map(limited).collect())
}

/// The values to which the numbers of an entry are pinned; `None` for a number that is not pinned.
type Pins = [Option<f64>; 5];
/// Indices of the diagonal among the five numbers.
const DIAGONAL: [usize; 3] = [0, 2, 4];
/// Indices of the two off-diagonal numbers.
const ASIDE: [usize; 2] = [1, 3];
/// The smallest diagonal number that least squares may choose, relative to the fitted number. Without this limit, a
/// number would fall below zero near the smallest roughness, where the numbers curve most.
const LEAST_PART: f64 = 0.25;

fn matrices(plan: &Plan, grid: Grid, lobes: &Lobes, own: &[LobeNumbers], free: FreeNumbers) -> Vec<DMat3> {
    let rules = plan.recipe().layout.rules();
    let fitted: Vec<DMat3> = own.iter().map(|stored| stored.matrix).collect();
    let own: Vec<[f64; 5]> = fitted.iter().map(numbers).collect();
    let mut pins: Vec<Pins> = own.iter().enumerate().map(|(node, own)| from_above(grid, node, own, free)).collect();
    let mut found = own.clone();
    let displacement = Displacement::new();
    for _ in 0..ROUNDS {
        let mut normal = Normal::new(grid);
        for (cell, at) in observed(grid) {
            let InterpolatedLobe { place, lobe, error } = lobes.between(cell, at);
            let stored = if free.is_inverse { lobe.matrix.inverse() } else { lobe.matrix };
            let stored = stored * (1.0 / rules.norm(&stored));
            let (target, mut weight) = (numbers(&stored), displacement.form(&stored, free));
            let off: [f64; 5] = std::array::from_fn(|k| {
                let of = |(down, right, phi): (usize, usize, f64)| {
                    phi * found[(cell[0] + down) * grid.columns + cell[1] + right][k]
                };
                corners(at).map(of).iter().sum::<f64>() - target[k]
            });
            let moved2: f64 = (0..25).map(|i| off[i / 5] * weight[i / 5][i % 5] * off[i % 5]).sum();
            // On average, the projection of a displacement on a random direction has half the length of the
            // displacement.
            let errors2 = 0.25 * moved2.max(0.0) / (error * error);
            let factor = view_weight(place.theta) * lobes.angle(cell[1]) / (error * error * (1.0 + errors2).sqrt());
            weight.iter_mut().flatten().for_each(|weight| *weight *= factor);
            normal.observe(cell, at, &weight, &target);
        }
        normal.regularise(&own, REGULARISATION, &pins);
        found = normal.solve(found);
        for ((found, own), pins) in found.iter_mut().zip(&own).zip(&mut pins) {
            for k in DIAGONAL {
                let least = LEAST_PART * own[k];
                if found[k] < least {
                    (found[k], pins[k]) = (least, Some(least));
                }
            }
        }
    }
    let upright_or_own = |(node, (found, own))| upright(grid, node, found, own);
    let found: Vec<DMat3> = found.iter().zip(&own).enumerate().map(upright_or_own).collect();
    let errors = |stored: &[DMat3]| errors_between(grid, lobes, stored, free, &displacement);
    if errors(&found) < errors(&fitted) { found } else { fitted }
}

/// The sum over the cells of the errors between the nodes, with the weights of the fit. The quadratic form holds for
/// small displacements. On a coarse grid displacements are large, and the minimum of the form can be worse than the
/// fitted entries.
fn errors_between(grid: Grid, lobes: &Lobes, stored: &[DMat3], free: FreeNumbers, displacement: &Displacement) -> f64 {
    let error = |(cell, at): ([usize; 2], [f64; 2])| {
        let InterpolatedLobe { place, lobe, error } = lobes.between(cell, at);
        let of =
            |(down, right, phi): (usize, usize, f64)| stored[(cell[0] + down) * grid.columns + cell[1] + right] * phi;
        let found = corners(at).into_iter().map(of).fold(DMat3::ZERO, |sum, part| sum + part);
        let found = if free.is_inverse { found.inverse() } else { found };
        let errors2 = 0.25 * displacement.mean_square(&found, &lobe.matrix) / (error * error);
        view_weight(place.theta) * lobes.angle(cell[1]) * (1.0 + errors2).sqrt()
    };
    observed(grid).map(error).sum()
}

/// The weight of a view.
fn view_weight(theta: f64) -> f64 {
    if theta > STEEPEST * THETA_CEILING { STEEP_WEIGHT } else { 1.0 }
}

fn is_from_above(grid: Grid, node: usize) -> bool {
    node.is_multiple_of(grid.columns)
}

/// The pins of an entry. The lobe of a view from above is round, so the off-diagonal numbers are pinned to zero. If the
/// layout fixes one of the first two diagonal numbers, both keep their fitted value. Other views have no pins.
fn from_above(grid: Grid, node: usize, own: &[f64; 5], free: FreeNumbers) -> Pins {
    let mut pins = [None; 5];
    if is_from_above(grid, node) {
        for k in &ASIDE {
            pins[*k] = Some(0.0);
        }
        for k in [0, 2] {
            if free.fixed.is_some_and(|fixed| fixed != [2, 2]) {
                pins[k] = Some(own[k]);
            }
        }
    }
    pins
}

/// The chosen matrix of an entry, made round for a view from above. If the chosen matrix is mirrored or nearly flat,
/// returns the fitted matrix instead.
fn upright(grid: Grid, node: usize, found: &[f64; 5], own: &[f64; 5]) -> DMat3 {
    let mut found = *found;
    if is_from_above(grid, node) {
        let radius = 0.5 * (found[0] + found[2]);
        found = [radius, 0.0, radius, 0.0, found[4]];
    }
    let area = |n: &[f64; 5]| n[0] * n[4] - n[1] * n[3];
    if area(&found) > LEAST_PART * LEAST_PART * area(own) { matrix(&found) } else { matrix(own) }
}

/// The chosen amplitude and Fresnel term of each entry. Their errors are weighted only by the view and by the range of
/// theta in the cell.
fn terms(grid: Grid, lobes: &Lobes, own: &[LobeNumbers]) -> Vec<LobeTerms> {
    let own: Vec<[f64; 2]> = own.iter().map(|stored| [stored.terms.amplitude, stored.terms.fresnel]).collect();
    let mut normal = Normal::new(grid);
    for (cell, at) in observed(grid) {
        let InterpolatedLobe { place, lobe, .. } = lobes.between(cell, at);
        let weight = view_weight(place.theta) * lobes.angle(cell[1]);
        normal.observe(cell, at, &[[weight, 0.0], [0.0, weight]], &[lobe.terms.amplitude, lobe.terms.fresnel]);
    }
    normal.regularise(&own, REGULARISATION, &vec![[None; 2]; own.len()]);
    let found = normal.solve(own).into_iter();
    found.map(|[amplitude, fresnel]| LobeTerms { amplitude: amplitude.max(0.0), fresnel: fresnel.max(0.0) }).collect()
}

/// The observed points of all cells: the first node of the cell, and the position in the cell.
fn observed(grid: Grid) -> impl Iterator<Item = ([usize; 2], [f64; 2])> {
    (1..grid.rows).flat_map(move |row| {
        (1..grid.columns).flat_map(move |column| {
            POINTS.into_iter().flat_map(move |down| POINTS.map(|right| ([row - 1, column - 1], [down, right])))
        })
    })
}

#[cfg(test)]
mod tests;
