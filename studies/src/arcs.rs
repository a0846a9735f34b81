//! Finds `BULGE` of `src/light/normals/arcs.rs`. Two arcs replace each half of an edge's image, and `BULGE` sets how
//! far beyond the chord they meet.
//!
//! A grid search finds the two numbers of `BULGE` with the least mean error of V, the visible part, against the exact
//! integrals.

use ltcforge::light::normals::{BULGE, visible, visible_by_arcs};
use rayon::prelude::*;

use crate::lights::{Case, Kind, cases};

/// Kinds of lights in the search. Some lights have long edges near the horizon.
const KINDS: [Kind; 5] = [Kind::Random, Kind::Anisotropic, Kind::Huge, Kind::Steep, Kind::Strip];
/// First value, step and number of values on the grid, for both numbers.
const GRID: [(f64, f64, usize); 2] = [(2.5, 0.1, 16), (-0.6, 0.2, 14)];

/// The result of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// The best point on the grid.
    pub bulge: [f64; 2],
    /// Mean errors of the current and the found numbers on the lights of the search.
    pub training: [f64; 2],
    /// The same mean errors, on lights from another seed.
    pub held_out: [f64; 2],
}

/// Lights, each with V from the exact integrals.
struct Lights(Vec<(Case, f64)>);

impl Lights {
    fn draw(count: usize, seed: u64) -> Self {
        let all = (0..).zip(KINDS).flat_map(|(i, kind)| cases(kind, 100 * seed + i, count));
        let with_exact = |case: Case| {
            let exact = visible(case.lit.alpha(), case.lit.wo(), &case.lit.vertices);
            (case, exact)
        };
        Self(all.map(with_exact).collect())
    }

    /// The mean error of V with arcs.
    fn error(&self, bulge: [f64; 2]) -> f64 {
        let error = |(Case { lit, .. }, exact): &(Case, f64)| {
            (visible_by_arcs(lit.alpha(), lit.wo(), &lit.vertices, bulge) - exact).abs()
        };
        let errors: Vec<f64> = self.0.par_iter().map(error).collect();
        errors.iter().sum::<f64>() / errors.len() as f64
    }
}

/// Runs the search on `count` lights of each kind.
#[must_use]
pub fn find(count: usize, seed: u64) -> Found {
    let [training, held_out] = [seed, seed + 1].map(|seed| Lights::draw(count, seed));
    let values = |(first, step, count): (f64, f64, usize)| (0..count).map(move |i| first + step * i as f64);
    let grid = values(GRID[0]).flat_map(|least| values(GRID[1]).map(move |more| [least, more]));
    let best = grid.map(|bulge| (training.error(bulge), bulge)).min_by(|a, b| a.0.total_cmp(&b.0));
    let bulge = best.map_or(BULGE, |(_, bulge)| bulge);
    let both = |lights: &Lights| [BULGE, bulge].map(|bulge| lights.error(bulge));
    Found { bulge, training: both(&training), held_out: both(&held_out) }
}
