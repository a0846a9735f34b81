//! A plan: the needs of a scene, the candidates, the choice, and the measured error of its table.

use serde::Serialize;

use crate::{
    candidates::{Budget, Candidate, candidates, choose},
    effort::added_error,
    form::Form,
    needs::Needs,
    prediction::{Nodes, Prediction, nodes_within},
    probes::{Probes, Stopped},
    shipped::shipped,
    without::{Shading, text_cost_of},
};
use ltcforge_files::{compact, recipe_document::Preset};
use ltcforge_fit::{BrdfKind, GoOn, Layout, LobeFresnel, PerAxis, Precision, Recipe, StoredTerms, Table, fit_seconds};

/// The default table in its compact form. `UPDATE_GOLDEN=whole cargo test -p ltcforge-plan whole` fits it again.
pub(crate) const WHOLE: &[u8] = include_bytes!("whole.compact");

/// If the measured error differs from the prediction by more than this fraction, the choice is made again with
/// corrected predictions.
const MOST_OFF: f64 = 0.2;

/// Maximum number of tables that are fitted for one plan. More than two are fitted only if a compact form is still too
/// long.
const MOST_FITTED: usize = 5;

/// After the first correction, compact forms are predicted to be this factor longer than measured.
const MARGIN: f64 = 1.02;

/// A plan for one table.
#[derive(Debug, Clone)]
pub struct TablePlan<'a> {
    /// The lobes that the table covers.
    pub needs: Needs<'a>,
    /// The budget.
    pub budget: Budget,
    /// Whether the choice is within the budget and the GPU limits; otherwise it is the nearest candidate.
    pub is_met: bool,
    /// The choice.
    pub chosen: Candidate,
    /// The candidates. Candidates of the same kind are in the order of ascending bytes.
    pub(crate) candidates: Vec<Candidate>,
    /// The error of the finest table. It comes from the lobe model, and from the nodes if the layout has a fixed size.
    pub(crate) limit: f64,
    /// All tables that were fitted and measured, in order.
    pub fitted: Vec<Fitted>,
    /// The table of the whole domain, in its default form at preset `paper`.
    pub whole: Whole,
    /// The costs of the table's shader and of rules without a table.
    pub(crate) shading: Shading,
    pub(crate) form: Form,
    prediction: Prediction,
}

/// A candidate that was fitted and measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// The candidate as predicted.
    pub candidate: Candidate,
    /// Mean error on the scene's configurations, as a fraction of the lobe's width.
    pub error: f64,
    /// Bytes of the compact form, if the budget counts them.
    pub shipped: Option<u64>,
    /// Processor seconds of the fit, if the caller measured them.
    pub seconds: Option<f64>,
}

impl Fitted {
    /// The measured error divided by the predicted error.
    #[must_use]
    pub fn off_by(&self) -> f64 {
        self.error / self.candidate.error
    }
}

/// The table of the whole domain.
#[derive(Debug, Clone, PartialEq)]
pub struct Whole {
    /// The recipe of the table.
    pub recipe: Recipe,
    /// Bytes of matrices and terms.
    pub bytes: u64,
    /// Mean error on the scene's configurations, predicted from the stored compact form, whose error is within 1 % of
    /// the table's. `None` for any table except the default table.
    pub predicted: Option<f64>,
    /// Mean error on the scene's configurations, if the table was measured.
    pub error: Option<f64>,
    /// Processor seconds of the fit, if the caller measured them.
    pub seconds: Option<f64>,
}

/// The table of the whole domain at one preset.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct WholeAt {
    pub(crate) preset: &'static str,
    /// Mean error on the scene's configurations: the error of the stored or measured table, corrected for the preset's
    /// effort.
    pub(crate) error: f64,
    /// Predicted seconds of one thread.
    pub(crate) seconds: f64,
}

impl Whole {
    /// The measured error, or else the predicted error.
    pub(crate) fn known_error(&self) -> Option<f64> {
        self.error.or(self.predicted)
    }

    /// The table at each preset, fastest first; empty if its error is not known.
    pub(crate) fn presets(&self) -> Vec<WholeAt> {
        let Some(error) = self.known_error() else { return Vec::new() };
        let at = |preset: Preset| {
            let recipe = Recipe { fit: preset.fit(), ..self.recipe.clone() };
            let error = error + added_error(&recipe) - added_error(&self.recipe);
            WholeAt { preset: preset.name(), error, seconds: fit_seconds(&recipe) }
        };
        Preset::ALL.map(at).to_vec()
    }
}

impl<'a> TablePlan<'a> {
    /// Plans a table for the needs of a scene. Runs on the current rayon pool. The size of the pool does not change the
    /// result.
    ///
    /// # Errors
    /// [`Stopped`] if `go_on` returns `false`.
    pub fn new(needs: Needs<'a>, budget: Budget, form: Form, go_on: &GoOn<'_>) -> Result<Self, Stopped> {
        let default = Layout::ALL.iter().copied().find(|layout| layout.takes(&needs.brdf.into()));
        let layout = form.layout.or(default).unwrap_or(Layout::ALL[0]);
        let probes = Probes::new(&needs);
        let prediction = Prediction::new((&needs, &probes), layout, form, go_on)?;
        let mut whole = whole(&prediction.base);
        if whole.recipe.brdf == BrdfKind::Ggx && layout == Layout::ALL[0] {
            whole.predicted = compact::decode(WHOLE).ok().map(|table| probes.error(&table));
        }
        Ok(Self::chosen_by(needs, budget, form, prediction, whole))
    }

    fn chosen_by(needs: Needs<'a>, budget: Budget, form: Form, prediction: Prediction, whole: Whole) -> Self {
        let mut candidates = candidates(&prediction);
        let is_readable = |candidate: &Candidate| form.gpu.allows(text_cost_of(&candidate.recipe));
        let is_any_readable = candidates.iter().any(is_readable);
        if is_any_readable {
            candidates.retain(is_readable);
        }
        let choice = choose(&candidates, budget);
        let is_met = choice.is_ok() && is_any_readable;
        let chosen = choice.unwrap_or_else(|nearest| nearest).clone();
        let limit = prediction.limit(chosen.recipe.brdf.fresnel());
        let shading = Shading::new(&needs, &chosen.recipe, form.gpu);
        let fitted = Vec::new();
        Self { needs, budget, is_met, chosen, candidates, limit, fitted, whole, shading, form, prediction }
    }

    /// The same plan with another budget and other GPU limits. Domain: limits that allow two lobes per entry if the
    /// limits of this plan allow them.
    #[cfg(test)]
    pub(crate) fn within(&self, budget: Budget, gpu: crate::GpuLimit) -> Self {
        let form = Form { gpu, ..self.form };
        Self::chosen_by(self.needs.clone(), budget, form, self.prediction.clone(), self.whole.clone())
    }

    /// Sets the processor seconds of the fit of the whole domain's table, which show how fast this machine is.
    pub fn time_whole(&mut self, seconds: f64) {
        self.whole.seconds = Some(seconds);
    }

    /// The processor seconds of a fit, divided by the prediction for this machine. `None` if the caller did not measure
    /// both fits.
    pub(crate) fn seconds_off_by(&self, fitted: &Fitted) -> Option<f64> {
        let slower = self.whole.seconds? / fit_seconds(&self.whole.recipe);
        Some(fitted.seconds? / (fitted.candidate.seconds * slower))
    }

    /// The settings that cannot reduce the error of [`TablePlan::limit`].
    pub(crate) fn limit_remains_with(&self) -> &'static str {
        let is_of_one_size = self.chosen.recipe.layout.only_ranges().is_some();
        if is_of_one_size { "any samples and directions" } else { "any number of nodes" }
    }

    /// Measures the fitted table of the choice and, if given, the table of the whole domain. `seconds` is the time of
    /// the fit. The measured error or bytes decide whether the budget is met.
    ///
    /// The first time, the choice is made again with corrected predictions if the prediction was off by more than a
    /// fifth or the table misses the budget. Otherwise, if the table of the whole domain is better, and a table with
    /// the same number of nodes over the scene's ranges is within a budget of bytes, this table becomes the choice. A
    /// choice whose compact form is too long is corrected several times. If the choice changes, the plan is not
    /// [measured](TablePlan::is_measured): fit the new choice too.
    pub fn measure(&mut self, table: &Table, whole: Option<&Table>, seconds: Option<f64>) {
        let probes = Probes::new(&self.needs);
        // A table to ship is measured after decoding.
        let (decoded, shipped) = self.chosen.shipped.and_then(|_| shipped(table)).unzip();
        let error = probes.error(decoded.as_ref().unwrap_or(table));
        if let Some(whole) = whole {
            self.whole.error = Some(probes.error(whole));
        }
        let is_first = self.fitted.is_empty();
        let fitted = Fitted { candidate: self.chosen.clone(), error, shipped, seconds };
        let factor = fitted.off_by();
        self.fitted.push(fitted);
        let spent = self.chosen.shipped.map_or(self.chosen.bytes, |_| shipped.unwrap_or(u64::MAX));
        let is_met = match self.budget {
            Budget::Error(most) => error <= most,
            Budget::Bytes(most) => spent <= most,
            // Seconds are compared as predicted, because other machines take other times.
            Budget::Seconds(_) | Budget::Knee => self.is_met,
        };
        let misses = self.is_met && !is_met;
        self.is_met = is_met && self.shading.is_table_readable;
        // Predicted bytes of compact forms are off by a few percent, so the form may exceed the budget.
        let is_too_long = self.chosen.shipped.is_some()
            && self.fitted.len() < MOST_FITTED
            && matches!(self.budget, Budget::Bytes(most) if spent > most);
        if is_too_long || is_first && ((factor - 1.0).abs() > MOST_OFF || misses) {
            let of_bytes = shipped.zip(self.chosen.shipped).map_or(1.0, |(is, was)| is as f64 / was as f64);
            let (factor, margin) = if is_first { (factor, 1.0) } else { (1.0, MARGIN) };
            let corrected = self.prediction.corrected(factor, of_bytes * margin);
            let again = Self::chosen_by(self.needs.clone(), self.budget, self.form, corrected, self.whole.clone());
            let is_met = if again.chosen.recipe == self.chosen.recipe { self.is_met } else { again.is_met };
            *self = Self { is_met, fitted: std::mem::take(&mut self.fitted), ..again };
        } else if is_first && self.whole.error.is_some_and(|whole| whole < error) {
            let nodes = self.of_default_nodes();
            if matches!(self.budget, Budget::Bytes(most) if nodes.spent() <= most) {
                self.chosen = nodes;
            }
        }
        if self.is_measured() {
            // A table that cannot light surfaces has no light error.
            let _ = self.shading.measure(&self.needs, table);
        }
    }

    /// The candidate with the default table's numbers of nodes over the scene's ranges, in halves.
    fn of_default_nodes(&self) -> Candidate {
        let base = &self.prediction.base;
        let resolution = nodes_within(&base.range, base.layout.default_resolution());
        let fresnel = self.chosen.recipe.brdf.fresnel();
        let lobes = self.prediction.curves.iter().position(|curve| curve.fresnel == *fresnel).unwrap_or(0);
        Candidate::of(&self.prediction, Nodes::even(lobes, resolution), Preset::Paper.fit())
    }

    /// The candidates with the effort and lobes of the choice: the front of error against bytes.
    pub(crate) fn front(&self) -> impl Iterator<Item = &Candidate> {
        self.candidates.iter().filter(move |candidate| candidate.kind() == self.chosen.kind())
    }

    /// The choices of lobes for the scene's table, each with the error of lobes that are fitted at configurations of
    /// the scene. Empty if there is only one choice.
    pub(crate) fn lobes(&self) -> impl Iterator<Item = (&LobeFresnel, f64)> {
        let all = &self.prediction.lobes;
        all.iter().filter(|_| all.len() > 1).map(|lobes| (&lobes.fresnel, lobes.error))
    }

    /// The measurement of the choice, if it was the last to be fitted and measured.
    #[must_use]
    pub fn measured(&self) -> Option<&Fitted> {
        self.fitted.last().filter(|fitted| fitted.candidate.recipe == self.chosen.recipe)
    }

    /// Whether the choice is fitted and measured.
    #[must_use]
    pub fn is_measured(&self) -> bool {
        self.measured().is_some()
    }
}

/// The default table of the scattering model, over its whole domain.
fn whole(base: &Recipe) -> Whole {
    let quarter = [0.0, std::f64::consts::FRAC_PI_2];
    let anisotropic = PerAxis { alpha: [0.0, 1.0], ratio: [0.0, 1.0], theta: quarter, phi: quarter };
    let isotropic = PerAxis { ratio: [1.0; 2], phi: [0.0; 2], ..anisotropic };
    let of_model = if base.brdf().is_isotropic() { isotropic } else { anisotropic };
    let range = base.layout.only_ranges().unwrap_or(of_model);
    let recipe = Recipe {
        brdf: base.brdf().into(),
        resolution: nodes_within(&range, base.layout.default_resolution()),
        range,
        fit: Preset::Paper.fit(),
        terms: StoredTerms::Schlick,
        precision: Precision::F32,
        ..base.clone()
    };
    Whole { bytes: recipe.bytes(), recipe, predicted: None, error: None, seconds: None }
}
