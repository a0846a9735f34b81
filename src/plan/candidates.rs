//! Tables that could serve a scene, with their predicted errors and costs, and the choice among them.

use std::cmp::Ordering;

use crate::{curve::Curve, prediction::Prediction};
use ltcforge_files::recipe_document::Preset;
use ltcforge_fit::{FitSettings, GivenNodes, Layout, LobeFresnel, PerAxis, Precision, Recipe, fit_seconds};

/// Minimum and maximum number of nodes on an axis with several values.
const NODES: PerAxis<[u32; 2]> = PerAxis { alpha: [2, 24], ratio: [2, 12], theta: [2, 24], phi: [2, 12] };
/// Errors within this factor count as equal, so that a smaller or faster table is chosen. Factors apply to the part of
/// the error that more nodes or more effort can remove. Tables of one size have no slack.
const EQUAL: f64 = 1.05;
/// The front bends at the smallest table whose error is within this factor of the least error.
const KNEE: f64 = 3.0;

/// The budget of a table. Seconds are those of one thread on the machine of `ltcforge_fit::fit_seconds`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Budget {
    /// The smallest table with at most this error.
    Error(f64),
    /// The best table with at most this many bytes.
    Bytes(u64),
    /// The best table that one thread fits in at most this many seconds.
    Seconds(f64),
    /// The smallest table that is nearly as good as the best.
    Knee,
}

/// A table that could serve a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// The recipe of the table.
    pub recipe: Recipe,
    /// Predicted mean error on the scene, as a fraction of the lobe's width.
    pub error: f64,
    /// Bytes of matrices and terms.
    pub bytes: u64,
    /// The part of the error that remains with any nodes and any effort; `None` for the default table.
    pub(crate) limit: Option<f64>,
    /// Predicted bytes of the compact form or of the engine's files, if the budget counts them.
    pub shipped: Option<u64>,
    /// Predicted seconds of one thread.
    pub seconds: f64,
}

impl Candidate {
    /// The candidate with a recipe.
    pub(crate) fn of(prediction: &Prediction, recipe: Recipe) -> Self {
        let (error, bytes, seconds) = (prediction.error(&recipe), recipe.bytes(), fit_seconds(&recipe));
        let (limit, shipped) = (prediction.limit(&recipe).min(error), prediction.shipped(&recipe));
        Self { recipe, error, bytes, limit: Some(limit), shipped, seconds }
    }

    /// The bytes that the budget counts: of the compact form or the engine's files, or else of the table on a GPU.
    pub(crate) fn spent(&self) -> u64 {
        self.shipped.unwrap_or(self.bytes)
    }

    /// The effort and the lobes. Candidates that share both differ only in their nodes.
    pub(crate) fn kind(&self) -> (&FitSettings, &LobeFresnel) {
        (&self.recipe.fit, self.recipe.brdf.fresnel())
    }
}

/// All candidates. For each choice of lobes, we keep the nodes whose table has less error than all tables with fewer
/// entries, and combine them with every preset.
pub(crate) fn candidates(prediction: &Prediction) -> Vec<Candidate> {
    let mut found = Vec::new();
    for curve in &prediction.curves {
        let priced = choices(prediction, curve).into_iter().map(|recipe| (prediction.of_nodes(&recipe), recipe));
        let mut priced: Vec<(f64, Recipe)> = priced.collect();
        priced.sort_by(|a, b| a.1.entries().cmp(&b.1.entries()).then(a.0.total_cmp(&b.0)));
        let mut least = f64::INFINITY;
        for (added, recipe) in priced {
            if added >= least {
                continue;
            }
            least = added;
            let one = Candidate::of(prediction, recipe);
            found.extend(Preset::ALL.map(|preset| {
                let recipe = Recipe { fit: preset.fit(), ..one.recipe.clone() };
                Candidate { error: prediction.error(&recipe), seconds: fit_seconds(&recipe), recipe, ..one }
            }));
        }
    }
    found
}

/// Recipes with all nodes that a table may have: evenly spaced, listed, or the scene's materials. Numbers have 16 bits,
/// because more bits would not reduce the error.
fn choices(prediction: &Prediction, curve: &Curve) -> Vec<Recipe> {
    let brdf = prediction.base.brdf.clone().with_fresnel(curve.fresnel.clone());
    let base = Recipe { brdf, precision: Precision::F16, ..prediction.base.clone() };
    if base.layout.only_ranges().is_some() {
        return vec![base];
    }
    let range = base.range;
    let counts = |[low, high]: [f64; 2], [from, to]: [u32; 2]| if low < high { from..=to } else { 1..=1 };
    // The numbers of nodes of an axis, each with the nodes that are listed.
    let of_axis = |axis: usize, range, limits| -> Vec<(u32, Vec<f64>)> {
        let listed = curve.given[axis].iter().map(|nodes| (nodes.len() as u32, nodes.clone()));
        counts(range, limits).map(|n| (n, Vec::new())).chain(listed).collect()
    };
    let ratios = of_axis(1, range.ratio, NODES.ratio);
    let mut surfaces = Vec::new();
    for (count, alpha) in of_axis(0, range.alpha, NODES.alpha) {
        surfaces.extend(ratios.iter().cloned().map(|(of_ratio, ratio)| {
            let nodes = PerAxis { alpha: alpha.clone(), ratio, theta: Vec::new(), phi: Vec::new() };
            (count, of_ratio, Recipe { given: GivenNodes::new(nodes), ..base.clone() })
        }));
    }
    if !prediction.materials.is_empty() {
        let given = GivenNodes::default().with_materials(&prediction.materials);
        let recipe = Recipe { layout: Layout::Materials, given, ..base };
        surfaces.push((prediction.materials.len() as u32, 1, recipe));
    }
    let mut all = Vec::new();
    for (alpha, ratio, recipe) in surfaces {
        for theta in counts(range.theta, NODES.theta) {
            all.extend(counts(range.phi, NODES.phi).map(|phi| {
                let resolution = PerAxis { alpha, ratio, theta, phi };
                Recipe { resolution, ..recipe.clone() }
            }));
        }
    }
    all
}

/// A cost of a candidate, or its error.
type Price = fn(&Candidate) -> f64;

const ERROR: Price = |candidate| candidate.error;
const BYTES: Price = |candidate| candidate.spent() as f64;
const SECONDS: Price = |candidate| candidate.seconds;

/// The candidate that fits a budget best. Domain: at least one candidate.
///
/// # Errors
/// The nearest candidate, if no candidate is within the budget.
pub(crate) fn choose(candidates: &[Candidate], budget: Budget) -> Result<&Candidate, &Candidate> {
    let all: Vec<&Candidate> = candidates.iter().collect();
    let (price, most) = match budget {
        Budget::Error(most) => (ERROR, most),
        Budget::Bytes(most) => (BYTES, most as f64),
        Budget::Seconds(most) => (SECONDS, most),
        Budget::Knee => (ERROR, highest(&all, KNEE)),
    };
    let mut allowed: Vec<&Candidate> = candidates.iter().filter(|candidate| price(candidate) <= most).collect();
    if allowed.is_empty() {
        return Err(cheapest(&all, [price, ERROR, BYTES]));
    }
    if let Budget::Bytes(_) | Budget::Seconds(_) = budget {
        // Nothing above the default table's error is chosen.
        if let Some(whole) = allowed.iter().find(|candidate| candidate.limit.is_none()).copied() {
            allowed.retain(|candidate| candidate.error <= whole.error);
        }
        let most = highest(&allowed, EQUAL);
        allowed.retain(|candidate| candidate.error <= most);
    }
    let prices = if let Budget::Bytes(_) = budget { [SECONDS, BYTES, ERROR] } else { [BYTES, SECONDS, ERROR] };
    Ok(cheapest(&allowed, prices))
}

/// The highest error within a factor of the least. The factor applies to the part that nodes and effort remove from the
/// error of the scene's own tables. This part of the default table's error is not known. Tables of one size have no
/// slack. Domain: at least one candidate.
fn highest(candidates: &[&Candidate], factor: f64) -> f64 {
    let least = candidates.iter().map(|candidate| candidate.error).fold(f64::INFINITY, f64::min);
    let own = candidates.iter().filter_map(|candidate| Some((candidate.error, candidate.limit?)));
    let (error, limit) = own.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or_default();
    if candidates.iter().all(|candidate| candidate.bytes == candidates[0].bytes) {
        least
    } else if error > limit {
        least + (factor - 1.0) * (error - limit)
    } else {
        // Under a few lights, a table may be nearer than the error that should remain.
        EQUAL * least
    }
}

/// The candidate with the lowest first price, then the lowest second price, and so on. Domain: at least one candidate.
fn cheapest<'a>(candidates: &[&'a Candidate], prices: [Price; 3]) -> &'a Candidate {
    let order = |a: &Candidate, b: &Candidate| {
        prices.iter().fold(Ordering::Equal, |order, price| order.then(price(a).total_cmp(&price(b))))
    };
    candidates.iter().copied().min_by(|a, b| order(a, b)).unwrap_or(candidates[0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use ltcforge_files::recipe_document::{DEFAULT_ENTRY_LIMIT, parse};

    fn candidate(error: f64, bytes: u64, seconds: f64) -> Candidate {
        let recipe = parse(b"{}", DEFAULT_ENTRY_LIMIT).expect("a recipe");
        Candidate { recipe, error, bytes, limit: Some(0.049), shipped: None, seconds }
    }

    #[test]
    fn a_budget_takes_the_cheapest_candidate_within_it_or_the_nearest() {
        let all = [
            candidate(0.20, 100, 0.1),
            candidate(0.10, 200, 0.2),
            candidate(0.05012, 400, 0.3),
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
        // Among tables of one size, nothing is saved by a larger error.
        let one_size = [candidate(0.0502, 400, 0.3), candidate(0.0501, 400, 0.9)];
        for budget in [Budget::Knee, Budget::Bytes(500)] {
            assert_eq!(choose(&one_size, budget).expect("one").error, 0.0501);
        }
    }

    /// The default table neither removes the slack of the scene's own tables, nor loses to a worse table.
    #[test]
    fn the_default_table_sets_no_slack() {
        let whole = |error: f64| Candidate { limit: None, ..candidate(error, 800, 2.0) };
        let own = [candidate(0.055, 200, 0.2), candidate(0.0505, 400, 0.3), candidate(0.05, 700, 0.9)];
        let chosen = |whole: Candidate, budget| {
            choose(&[&own[..], &[whole]].concat(), budget).map(|c| c.bytes).map_err(|c| c.bytes)
        };
        let without = choose(&own, Budget::Knee).expect("one").bytes;
        assert_eq!((without, chosen(whole(0.0495), Budget::Knee)), (400, Ok(400)));
        // A default table that is far nearer than any own table is chosen.
        assert_eq!(chosen(whole(0.02), Budget::Knee), Ok(800));
        assert_eq!(chosen(whole(0.0495), Budget::Bytes(900)), Ok(800));
        assert_eq!(chosen(whole(0.0495), Budget::Bytes(750)), Ok(700));
        assert_eq!(chosen(whole(0.06), Budget::Bytes(900)), Ok(700));
    }
}
