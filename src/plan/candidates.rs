//! Tables that could serve a scene, with their predicted errors and their costs, and the choice among them.

use serde::Serialize;

use crate::{
    effort::efforts,
    prediction::{Nodes, Prediction},
};
use ltcforge_fit::{FitSettings, LobeFresnel, PerAxis, Precision, Recipe, fit_seconds};

/// Nodes that an axis of several values may have.
const NODES: PerAxis<[u32; 2]> = PerAxis { alpha: [2, 24], ratio: [2, 12], theta: [2, 24], phi: [2, 12] };
/// Errors that differ by less are equal: a smaller or faster table is taken then.
const EQUAL: f64 = 1.005;
/// Where the front bends: the smallest table whose error is within 5 % of the least.
const KNEE: f64 = 1.05;

/// What may be spent. Seconds are of one thread, on the machine of `ltcforge_fit::fit_seconds`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Budget {
    /// The smallest table whose error is at most this.
    Error(f64),
    /// The best table of at most as many bytes.
    Bytes(u64),
    /// The best table whose fit takes at most as long.
    Seconds(f64),
    /// The smallest table that is nearly as good as any.
    Knee,
}

/// A table that could serve a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// Its recipe.
    pub recipe: Recipe,
    /// Predicted mean error on the scene, as a part of the lobe's width.
    pub error: f64,
    /// Bytes of matrices and terms.
    pub bytes: u64,
    /// Predicted bytes of the compact form, where that is to ship.
    pub shipped: Option<u64>,
    /// Predicted seconds of one thread.
    pub seconds: f64,
}

impl Candidate {
    /// The table of some nodes and effort, as it is predicted. Its numbers are halves, which are as good as longer ones.
    pub(crate) fn of(prediction: &Prediction, nodes: Nodes, fit: FitSettings) -> Self {
        let recipe = Recipe { fit, precision: Precision::F16, ..prediction.recipe(nodes) };
        let (error, bytes, seconds) = (prediction.error(nodes, &recipe), recipe.bytes(), fit_seconds(&recipe));
        let shipped = prediction.shipped(&recipe);
        Self { recipe, error, bytes, shipped, seconds }
    }

    /// The bytes that a budget is of: those to ship, or those on a GPU.
    #[must_use]
    pub fn spent(&self) -> u64 {
        self.shipped.unwrap_or(self.bytes)
    }

    /// Candidates of equal kind differ by their nodes alone.
    pub(crate) fn kind(&self) -> (&FitSettings, &LobeFresnel) {
        (&self.recipe.fit, self.recipe.brdf.fresnel())
    }
}

/// The nodes for which none of fewer entries have less error, each with all efforts, of the best single lobes and of two.
#[must_use]
pub(crate) fn candidates(prediction: &Prediction) -> Vec<Candidate> {
    let base = prediction.base();
    let is_free = base.layout.only_ranges().is_none();
    let efforts = efforts(base);
    let mut found = Vec::new();
    for lobes in 0..prediction.curves().len() {
        let all = if is_free { choices(prediction, lobes) } else { vec![Nodes::even(lobes, base.resolution)] };
        let priced = |nodes: Nodes| (nodes.entries(), prediction.of_nodes(nodes), nodes);
        let mut priced: Vec<(u64, f64, Nodes)> = all.into_iter().map(priced).collect();
        priced.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let mut least = f64::INFINITY;
        priced.retain(|(_, error, _)| {
            let is_better = *error < least;
            least = least.min(*error);
            is_better
        });
        for (_, _, nodes) in priced {
            found.extend(efforts.iter().map(|fit| Candidate::of(prediction, nodes, *fit)));
        }
    }
    found
}

/// All nodes that a table may have: one for a single value, else so many evenly spaced ones, or those that are given; and the
/// scene's materials.
fn choices(prediction: &Prediction, lobes: usize) -> Vec<Nodes> {
    let range = &prediction.base().range;
    let counts = |[low, high]: [f64; 2], [from, to]: [u32; 2]| if low < high { from..=to } else { 1..=1 };
    let surface = |axis: usize, range, limits| -> Vec<(u32, Option<usize>)> {
        let given = prediction.curves()[lobes].given[axis].iter().enumerate();
        let given = given.map(|(number, placed)| (placed.nodes.len() as u32, Some(number)));
        counts(range, limits).map(|n| (n, None)).chain(given).collect()
    };
    let ratios = surface(1, range.ratio, NODES.ratio);
    let mut all = Vec::new();
    for (alpha, given_alpha) in surface(0, range.alpha, NODES.alpha) {
        for (ratio, given_ratio) in &ratios {
            for theta in counts(range.theta, NODES.theta) {
                all.extend(counts(range.phi, NODES.phi).map(|phi| Nodes {
                    lobes,
                    resolution: PerAxis { alpha, ratio: *ratio, theta, phi },
                    given: [given_alpha, *given_ratio],
                    of_materials: false,
                }));
            }
        }
    }
    let materials = prediction.materials().len() as u32;
    for theta in counts(range.theta, NODES.theta).filter(|_| materials > 0) {
        all.extend(counts(range.phi, NODES.phi).map(|phi| Nodes {
            lobes,
            resolution: PerAxis { alpha: materials, ratio: 1, theta, phi },
            given: [None; 2],
            of_materials: true,
        }));
    }
    all
}

/// What a candidate costs, or its error.
type Price = fn(&Candidate) -> f64;

const ERROR: Price = |candidate| candidate.error;
const BYTES: Price = |candidate| candidate.spent() as f64;
const SECONDS: Price = |candidate| candidate.seconds;

/// The candidate that a budget chooses; the error is the nearest one, where no candidate is within the budget. Domain:
/// at least one candidate.
///
/// # Errors
/// The candidate that comes nearest to the budget.
pub(crate) fn choose(candidates: &[Candidate], budget: Budget) -> Result<&Candidate, &Candidate> {
    let all = || candidates.iter().collect();
    let (price, most, then) = match budget {
        Budget::Error(most) => (ERROR, most, [(BYTES, 1.0), (SECONDS, 1.0), (ERROR, 1.0)]),
        Budget::Bytes(most) => (BYTES, most as f64, [(ERROR, EQUAL), (SECONDS, 1.0), (BYTES, 1.0)]),
        Budget::Seconds(most) => (SECONDS, most, [(ERROR, EQUAL), (BYTES, 1.0), (SECONDS, 1.0)]),
        Budget::Knee => {
            let least = candidates.iter().map(ERROR).fold(f64::INFINITY, f64::min);
            (ERROR, KNEE * least, [(BYTES, 1.0), (SECONDS, 1.0), (ERROR, 1.0)])
        }
    };
    let within: Vec<&Candidate> = candidates.iter().filter(|candidate| price(candidate) <= most).collect();
    if within.is_empty() {
        return Err(least(all(), [(price, 1.0), (ERROR, EQUAL), (BYTES, 1.0)]));
    }
    Ok(least(within, then))
}

/// The candidate of the least first price, among those that are nearly that by each price's slack the one of the least
/// next price. Domain: at least one candidate.
fn least(mut left: Vec<&Candidate>, prices: [(Price, f64); 3]) -> &Candidate {
    for (price, slack) in prices {
        let most = left.iter().map(|candidate| price(candidate)).fold(f64::INFINITY, f64::min) * slack;
        left.retain(|candidate| price(candidate) <= most);
    }
    left[0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use ltcforge_files::recipe_document::{DEFAULT_ENTRY_LIMIT, parse};

    fn candidate(error: f64, bytes: u64, seconds: f64) -> Candidate {
        let recipe = parse(b"{}", DEFAULT_ENTRY_LIMIT).expect("a recipe");
        Candidate { recipe, error, bytes, shipped: None, seconds }
    }

    #[test]
    fn a_budget_takes_the_cheapest_of_what_it_allows_or_names_the_nearest() {
        let all = [
            candidate(0.20, 100, 0.1),
            candidate(0.10, 200, 0.2),
            candidate(0.0502, 400, 0.3),
            candidate(0.0501, 400, 0.9),
            candidate(0.05, 900, 1.0),
        ];
        let chosen = |budget| choose(&all, budget).map(|c| c.bytes).map_err(|c| c.bytes);
        assert_eq!(chosen(Budget::Bytes(250)), Ok(200));
        assert_eq!(choose(&all, Budget::Bytes(500)).expect("one").seconds, 0.3);
        assert_eq!(chosen(Budget::Bytes(99)), Err(100));
        assert_eq!(chosen(Budget::Error(0.1)), Ok(200));
        assert_eq!(chosen(Budget::Error(0.01)), Err(900));
        assert_eq!(chosen(Budget::Seconds(0.25)), Ok(200));
        assert_eq!(chosen(Budget::Seconds(0.01)), Err(100));
        assert_eq!(chosen(Budget::Knee), Ok(400));
    }
}
