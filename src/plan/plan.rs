//! A plan: what a scene needs, the candidates, the choice and what it was measured to be.

use serde::Serialize;

use crate::{
    candidates::{Budget, Candidate, candidates, choose},
    effort::added_error,
    form::Form,
    held::{Held, Stopped},
    needs::Needs,
    prediction::{Nodes, Prediction},
    shipped::shipped,
    without::{Beside, GpuLimit, text_cost_of},
};
use ltcforge_files::{compact, recipe_document::Preset};
use ltcforge_fit::{
    BrdfKind, FITTER_VERSION, Layout, LobeFresnel, PerAxis, Precision, Recipe, StoredTerms, Table, fit_seconds,
};

/// The default table in its compact form; `UPDATE_GOLDEN=whole cargo test -p ltcforge-plan whole` fits it again.
pub(crate) const WHOLE: &[u8] = include_bytes!("whole.compact");

/// A prediction that is off by more is corrected, and the choice made again.
const MOST_OFF: f64 = 0.2;

/// Tables that are fitted for one plan, at most; more than two where a compact form is still too long.
const MOST_FITTED: usize = 5;

/// By how much more than measured a compact form is taken to be too long after the first correction.
const MARGIN: f64 = 1.02;

/// A plan for one table.
#[derive(Debug, Clone)]
pub struct TablePlan<'a> {
    /// What it serves.
    pub needs: Needs<'a>,
    /// The budget.
    pub budget: Budget,
    /// Whether the choice is within it; else it is the nearest that can be had.
    pub is_met: bool,
    /// The choice.
    pub chosen: Candidate,
    /// The candidates, of ascending bytes.
    pub candidates: Vec<Candidate>,
    /// The error that even the finest table has: that of the lobe model, and of the nodes where a layout has one size.
    pub limit: f64,
    /// The choice's table as it was measured.
    pub measured: Option<Measured>,
    /// All tables that were fitted and measured, in their order.
    pub fitted: Vec<Fitted>,
    /// The table of the whole domain, in its default form at preset `paper`.
    pub whole: Whole,
    /// What costs no bytes at all.
    pub beside: Beside,
    form: Form,
    prediction: Prediction,
    first_off: Option<f64>,
    is_corrected: bool,
}

/// A fitted table on the scene.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Measured {
    /// Mean error on the scene's configurations, as a part of the lobe's width.
    pub error: f64,
    /// The error over the predicted one.
    pub off_by: f64,
    /// The same of the first table that was measured; another number where the choice was made again.
    pub first_off_by: f64,
}

/// A candidate that was fitted and measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// As it was predicted.
    pub candidate: Candidate,
    /// Mean error on the scene's configurations, as a part of the lobe's width.
    pub error: f64,
    /// Bytes of matrices and terms.
    pub bytes: u64,
    /// Bytes of the compact form, where that is to ship.
    pub shipped: Option<u64>,
    /// Seconds of all threads together, where the caller took the time.
    pub seconds: Option<f64>,
}

/// The table of the whole domain.
#[derive(Debug, Clone, PartialEq)]
pub struct Whole {
    /// Its recipe.
    pub recipe: Recipe,
    /// Bytes of matrices and terms.
    pub bytes: u64,
    /// Mean error on the same configurations by the table's compact form, which is within a hundredth; `None` of other tables
    /// than the default one.
    pub predicted: Option<f64>,
    /// Mean error on the same configurations, where the table was measured.
    pub error: Option<f64>,
    /// Processor seconds of its fit, where the caller took the time.
    pub seconds: Option<f64>,
}

/// The table of the whole domain at one preset.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct WholeAt {
    /// The preset's name.
    pub preset: &'static str,
    /// Mean error on the same configurations: that of the kept or measured table, with what the preset's effort adds or takes.
    pub error: f64,
    /// Predicted seconds of one thread.
    pub seconds: f64,
}

impl Whole {
    /// The table at each preset, the fastest first; none where its error is not known.
    #[must_use]
    pub fn presets(&self) -> Vec<WholeAt> {
        let Some(error) = self.error.or(self.predicted) else { return Vec::new() };
        let at = |preset: Preset| {
            let recipe = Recipe { fit: preset.fit(), ..self.recipe.clone() };
            let error = error + added_error(&recipe) - added_error(&self.recipe);
            WholeAt { preset: preset.name(), error, seconds: fit_seconds(&recipe) }
        };
        Preset::ALL.map(at).to_vec()
    }

    /// By how much slower this machine fitted it than it was predicted; `None` where the caller took no time.
    fn slower(&self) -> Option<f64> {
        self.seconds.map(|seconds| seconds / fit_seconds(&self.recipe))
    }
}

impl<'a> TablePlan<'a> {
    /// Plans a table for what a scene needs. Runs on the current rayon pool, whose size changes nothing; `go_on` may
    /// stop it.
    ///
    /// # Errors
    /// [`Stopped`] where `go_on` says no.
    pub fn new(
        needs: Needs<'a>,
        budget: Budget,
        form: Form,
        go_on: &(dyn Fn() -> bool + Sync),
    ) -> Result<Self, Stopped> {
        let default = Layout::ALL.iter().copied().find(|layout| layout.takes(&needs.brdf().into()));
        let layout = form.layout.or(default).unwrap_or(Layout::ALL[0]);
        let held = Held::new(&needs);
        let prediction = Prediction::new((&needs, &held), layout, form, Preset::Standard.fit(), go_on)?;
        let mut whole = whole(prediction.base());
        whole.predicted = default_table(&whole.recipe).map(|table| held.error(&table));
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
        let beside = Beside::new(&needs, &chosen.recipe, form.gpu);
        Self {
            needs,
            budget,
            is_met,
            chosen,
            candidates,
            limit,
            measured: None,
            fitted: Vec::new(),
            beside,
            whole,
            form,
            prediction,
            first_off: None,
            is_corrected: false,
        }
    }

    /// The plan of the same scene within another budget and other limits of a GPU. Domain: limits that allow two lobes an entry
    /// where those of this plan do.
    #[cfg(test)]
    pub(crate) fn within(&self, budget: Budget, gpu: GpuLimit) -> Self {
        let form = Form { gpu, ..self.form };
        Self::chosen_by(self.needs.clone(), budget, form, self.prediction.clone(), self.whole.clone())
    }

    /// Notes what the fit of the table of the whole domain took, in processor seconds: by that the speed of this machine is known.
    pub fn time_whole(&mut self, seconds: f64) {
        self.whole.seconds = Some(seconds);
    }

    /// The processor seconds of a fit over those that were predicted for it, on this machine: the table of the whole domain
    /// tells its speed. `None` where the caller took no time of both.
    #[must_use]
    pub fn seconds_off_by(&self, fitted: &Fitted) -> Option<f64> {
        Some(fitted.seconds? / (fitted.candidate.seconds * self.whole.slower()?))
    }

    /// What the error of [`TablePlan::limit`] stays with.
    #[must_use]
    pub(crate) fn limit_stays_with(&self) -> &'static str {
        let is_of_one_size = self.chosen.recipe.layout().only_ranges().is_some();
        if is_of_one_size { "any samples and directions" } else { "any number of nodes" }
    }

    /// Measures the fitted table of the choice, and that of the whole domain if it is given; `seconds` is what the fit took.
    /// Whether the budget is met is then told by what was measured. The choice is made again, once, by corrected predictions
    /// where the prediction was off by more than a fifth or the table misses the error that was asked for; or, where the table of
    /// the whole domain is better and half of its bytes are within the budget, with its nodes over the scene's ranges. If the
    /// choice differs then, the plan is no longer [measured](TablePlan::is_measured): its new choice is to be fitted too.
    pub fn measure(&mut self, table: &Table, whole: Option<&Table>, seconds: Option<f64>) {
        let held = Held::new(&self.needs);
        // What is shipped is measured as it decodes.
        let (decoded, shipped) = self.chosen.shipped.and_then(|_| shipped(table)).unzip();
        let measured = held.error(decoded.as_ref().unwrap_or(table));
        if let Some(whole) = whole {
            self.whole.error = Some(held.error(whole));
        }
        let factor = measured / self.chosen.error;
        let first_off = *self.first_off.get_or_insert(factor);
        let bytes = bytes_of(table, self.chosen.recipe.precision);
        self.fitted.push(Fitted { candidate: self.chosen.clone(), error: measured, bytes, shipped, seconds });
        let spent = if self.chosen.shipped.is_some() { shipped.unwrap_or(u64::MAX) } else { bytes };
        self.measured = Some(Measured { error: measured, off_by: factor, first_off_by: first_off });
        let is_met = match self.budget {
            Budget::Error(most) => measured <= most,
            Budget::Bytes(most) => spent <= most,
            // Other machines take other times: seconds are held to the prediction.
            Budget::Seconds(_) | Budget::Knee => self.is_met,
        };
        let misses = self.is_met && !is_met;
        self.is_met = is_met && self.beside.is_table_readable;
        let is_first = !std::mem::replace(&mut self.is_corrected, true);
        // How long a compact form gets is known to a few percent, which may be all that there is too much.
        let is_too_long = matches!(self.budget, Budget::Bytes(most) if self.chosen.shipped.is_some() && spent > most)
            && self.fitted.len() < MOST_FITTED;
        if is_first || is_too_long {
            let before = self.chosen.recipe.clone();
            if is_too_long || (factor - 1.0).abs() > MOST_OFF || misses {
                let of_bytes = shipped.zip(self.chosen.shipped).map_or(1.0, |(is, was)| is as f64 / was as f64);
                let of_bytes = if is_first { of_bytes } else { of_bytes * MARGIN };
                let corrected = self.prediction.corrected(if is_first { factor } else { 1.0 }, of_bytes);
                let again = Self::chosen_by(self.needs.clone(), self.budget, self.form, corrected, self.whole.clone());
                let is_met = if again.chosen.recipe == before { self.is_met } else { again.is_met };
                let (measured, fitted) = (self.measured, std::mem::take(&mut self.fitted));
                let first_off = Some(first_off);
                *self = Self { is_met, measured, fitted, first_off, is_corrected: true, ..again };
            } else if self.whole.error.is_some_and(|whole| whole < measured) {
                let nodes = self.of_default_nodes();
                if matches!(self.budget, Budget::Bytes(most) if nodes.spent() <= most) {
                    self.chosen = nodes;
                }
            }
            self.measured = self.measured.filter(|_| self.chosen.recipe == before);
        }
        if self.is_measured() {
            // A table whose light cannot be told has no figure of it.
            let _ = self.beside.measure(&self.needs, table);
        }
    }

    /// The nodes of the default table over the scene's ranges, as halves.
    fn of_default_nodes(&self) -> Candidate {
        let base = self.prediction.base();
        let of = base.layout.default_resolution();
        let nodes = |n: u32, [low, high]: [f64; 2]| if low < high { n } else { 1 };
        let range = &base.range;
        let resolution = PerAxis {
            alpha: nodes(of.alpha, range.alpha),
            ratio: nodes(of.ratio, range.ratio),
            theta: nodes(of.theta, range.theta),
            phi: nodes(of.phi, range.phi),
        };
        let fresnel = self.chosen.recipe.brdf.fresnel();
        let lobes = self.prediction.curves().iter().position(|curve| curve.fresnel == *fresnel).unwrap_or(0);
        Candidate::of(&self.prediction, Nodes::even(lobes, resolution), Preset::Paper.fit())
    }

    /// The candidates of the choice's effort and lobes: the front of error against bytes.
    pub fn front(&self) -> impl Iterator<Item = &Candidate> {
        self.candidates.iter().filter(move |candidate| candidate.kind() == self.chosen.kind())
    }

    /// What the lobes that a table of the scene may have differ in, by their errors: whose they are, and the error of lobes that
    /// are fitted at configurations of the scene alone. Empty where there is no choice.
    pub fn lobes(&self) -> impl Iterator<Item = (&LobeFresnel, f64)> {
        let all = self.prediction.lobes();
        all.iter().filter(|_| all.len() > 1).map(|lobes| (&lobes.fresnel, lobes.error))
    }

    /// Whether a compact form was asked for.
    #[must_use]
    pub fn ships(&self) -> bool {
        self.form.ship
    }

    /// The limits of what a GPU may spend.
    #[must_use]
    pub fn gpu(&self) -> GpuLimit {
        self.form.gpu
    }

    /// Whether the choice is fitted and measured.
    #[must_use]
    pub fn is_measured(&self) -> bool {
        self.measured.is_some()
    }
}

/// The default table of the scattering model, over all of its domain.
fn whole(base: &Recipe) -> Whole {
    let quarter = [0.0, std::f64::consts::FRAC_PI_2];
    let anisotropic = PerAxis { alpha: [0.0, 1.0], ratio: [0.0, 1.0], theta: quarter, phi: quarter };
    let isotropic = PerAxis { ratio: [1.0; 2], phi: [0.0; 2], ..anisotropic };
    let of_model = if base.brdf().is_isotropic() { isotropic } else { anisotropic };
    let range = base.layout.only_ranges().unwrap_or(of_model);
    let of = base.layout.default_resolution();
    let resolution = if range.ratio == [1.0; 2] { PerAxis { ratio: 1, phi: 1, ..of } } else { of };
    let recipe = Recipe {
        fitter: FITTER_VERSION,
        brdf: base.brdf().into(),
        resolution,
        range,
        fit: Preset::Paper.fit(),
        terms: StoredTerms::Schlick,
        precision: Precision::F32,
        ..base.clone()
    };
    Whole { bytes: recipe.bytes(), recipe, predicted: None, error: None, seconds: None }
}

/// The default table as it is kept here; `None` for another recipe than its.
fn default_table(recipe: &Recipe) -> Option<Table> {
    let is_default = recipe.brdf == BrdfKind::Ggx && recipe.layout == Layout::ALL[0];
    is_default.then(|| compact::decode(WHOLE).ok()).flatten()
}

/// The bytes of a table's matrices and terms.
fn bytes_of(table: &Table, precision: Precision) -> u64 {
    let width = if precision == Precision::F16 { 2 } else { 4 };
    let matrices = table.matrices().len() + table.second_matrices().map_or(0, <[_]>::len);
    let terms = table.terms().map_or(0, |terms| terms.amplitude().len() + terms.fresnel().len());
    width * (9 * matrices + terms) as u64
}
