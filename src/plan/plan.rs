//! A plan: what a scene needs, the candidates, the choice and what it was measured to be.

use serde::Serialize;

use crate::without::Beside;
use crate::{
    candidates::{Budget, Candidate, candidates, choose},
    needs::Needs,
    prediction::{Nodes, POINTS, Prediction, Stopped, error},
};
use ltcforge_files::recipe_document::Preset;
use ltcforge_fit::{FITTER_VERSION, Layout, PerAxis, Precision, Recipe, Table};

/// A prediction that is off by more is corrected, and the choice made again.
const MOST_OFF: f64 = 0.2;

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
    /// The error that even the finest table has: that of the lobe model.
    pub limit: f64,
    /// The choice's table as it was measured.
    pub measured: Option<Measured>,
    /// The table of the whole domain, in its default form at preset `paper`.
    pub whole: Whole,
    /// What costs no bytes at all.
    pub beside: Beside,
    prediction: Prediction,
    first_off: Option<f64>,
    is_corrected: bool,
}

/// What a table may be.
#[derive(Debug, Clone, Copy, Default)]
pub struct Form {
    /// Its layout; the scattering model's default one where there is none.
    pub layout: Option<Layout>,
    /// Whether nodes may stand on the scene's own values of alpha and ratio, for readers that search for nodes.
    pub any_nodes: bool,
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

/// The table of the whole domain.
#[derive(Debug, Clone, PartialEq)]
pub struct Whole {
    /// Its recipe.
    pub recipe: Recipe,
    /// Bytes of matrices and terms.
    pub bytes: u64,
    /// Mean error on the same configurations, where it was measured.
    pub error: Option<f64>,
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
        let default = Layout::ALL.iter().copied().find(|layout| layout.takes(needs.brdf()));
        let layout = form.layout.or(default).unwrap_or(Layout::ALL[0]);
        let prediction = Prediction::new(&needs, layout, form.any_nodes, Preset::Standard.fit(), go_on)?;
        let whole = whole(prediction.base());
        Ok(Self::chosen_by(needs, budget, prediction, whole))
    }

    fn chosen_by(needs: Needs<'a>, budget: Budget, prediction: Prediction, whole: Whole) -> Self {
        let candidates = candidates(&prediction);
        let choice = choose(&candidates, budget);
        let is_met = choice.is_ok();
        let chosen = choice.unwrap_or_else(|nearest| nearest).clone();
        let limit = prediction.limit();
        let beside = Beside::new(&needs, chosen.recipe.layout.name());
        Self {
            needs,
            budget,
            is_met,
            chosen,
            candidates,
            limit,
            measured: None,
            beside,
            whole,
            prediction,
            first_off: None,
            is_corrected: false,
        }
    }

    /// Measures the fitted table of the choice, and that of the whole domain if it is given. The choice is made again, once,
    /// where the prediction was off by more than a fifth, by corrected predictions; or where the table of the whole
    /// domain is better and half of its bytes are within the budget, with its nodes over the scene's ranges. If the choice
    /// differs then, the plan is no longer [measured](TablePlan::is_measured): its new choice is to be fitted too.
    pub fn measure(&mut self, table: &Table, whole: Option<&Table>) {
        let places = self.needs.draw(POINTS);
        let measured = error(table, &places);
        if let Some(whole) = whole {
            // Both tables are held to the lobes of the scene's materials.
            let held = Table { brdf: self.needs.brdf().clone(), ..whole.clone() };
            self.whole.error = Some(error(&held, &places));
        }
        let factor = measured / self.chosen.error;
        let first_off = *self.first_off.get_or_insert(factor);
        self.measured = Some(Measured { error: measured, off_by: factor, first_off_by: first_off });
        if !std::mem::replace(&mut self.is_corrected, true) {
            let before = self.chosen.recipe.clone();
            if (factor - 1.0).abs() > MOST_OFF {
                let corrected = self.prediction.corrected(factor);
                let again = Self::chosen_by(self.needs.clone(), self.budget, corrected, self.whole.clone());
                *self = Self { measured: self.measured, first_off: Some(first_off), is_corrected: true, ..again };
            } else if self.whole.error.is_some_and(|whole| whole < measured) {
                let nodes = self.of_default_nodes();
                if matches!(self.budget, Budget::Bytes(most) if nodes.bytes <= most) {
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
        Candidate::of(&self.prediction, Nodes::even(resolution), Precision::F16, Preset::Paper)
    }

    /// The candidates of the choice's effort and number format: the front of error against bytes.
    pub fn front(&self) -> impl Iterator<Item = &Candidate> {
        let of = |candidate: &Candidate| (candidate.preset, candidate.recipe.precision);
        self.candidates.iter().filter(move |candidate| of(candidate) == of(&self.chosen))
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
        precision: Precision::F32,
        ..base.clone()
    };
    Whole { bytes: recipe.bytes(), recipe, error: None }
}
