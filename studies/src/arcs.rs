//! How far beyond the chord the two arcs of half an edge meet: `BULGE` of `src/light/normals/arcs.rs`.
//!
//! Both numbers are searched on a grid for the least mean error of V, the visible part, against the exact integrals.

use ltcforge::light::normals::{BULGE, visible, visible_by_arcs};
use rayon::prelude::*;

use crate::lights::{Case, Kind, cases};

/// Lights of the search: those whose edges are long and near the horizon among them.
const KINDS: [Kind; 5] = [Kind::Random, Kind::Anisotropic, Kind::Huge, Kind::Steep, Kind::Strip];
/// First value, step and number of values of the grid, of each number.
const GRID: [(f64, f64, usize); 2] = [(2.5, 0.1, 16), (-0.6, 0.2, 14)];

/// The result of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// The best place of the grid.
    pub bulge: [f64; 2],
    /// Mean errors of the numbers that stand and of those found, on the lights of the search.
    pub seen: [f64; 2],
    /// The same on as many lights of another seed.
    pub held_out: [f64; 2],
}

/// Lights, and V of each by the exact integrals.
struct Lights(Vec<(Case, f64)>);

impl Lights {
    fn draw(count: usize, seed: u64) -> Self {
        let drawn = (0..).zip(KINDS).flat_map(|(i, kind)| cases(kind, 100 * seed + i, count));
        let with_exact = |case: Case| {
            let exact = visible(case.lit.alpha(), case.lit.wo(), &case.lit.vertices);
            (case, exact)
        };
        Self(drawn.map(with_exact).collect())
    }

    /// The mean error of V by arcs.
    fn error(&self, bulge: [f64; 2]) -> f64 {
        let error = |(Case { lit, .. }, exact): &(Case, f64)| {
            (visible_by_arcs(lit.alpha(), lit.wo(), &lit.vertices, bulge) - exact).abs()
        };
        let errors: Vec<f64> = self.0.par_iter().map(error).collect();
        errors.iter().sum::<f64>() / errors.len() as f64
    }
}

/// Searches on `count` lights of each kind.
#[must_use]
pub fn find(count: usize, seed: u64) -> Found {
    let [seen, held_out] = [seed, seed + 1].map(|seed| Lights::draw(count, seed));
    let values = |(first, step, count): (f64, f64, usize)| (0..count).map(move |i| first + step * i as f64);
    let grid = values(GRID[0]).flat_map(|least| values(GRID[1]).map(move |more| [least, more]));
    let best = grid.map(|bulge| (seen.error(bulge), bulge)).min_by(|a, b| a.0.total_cmp(&b.0));
    let bulge = best.map_or(BULGE, |(_, bulge)| bulge);
    let both = |lights: &Lights| [BULGE, bulge].map(|bulge| lights.error(bulge));
    Found { bulge, seen: both(&seen), held_out: both(&held_out) }
}
