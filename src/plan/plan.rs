//! A plan: the needs of a scene, the candidates, the choice, and the measured error of its table.

use std::sync::Arc;

use crate::{
    candidates::{Budget, Candidate, candidates, choose},
    figures::{Figure, add_helps, figures, lighting},
    form::Form,
    needs::Needs,
    prediction::{Prediction, nodes_within},
    probes::{POINTS, Probes, Stopped},
    without::{FAR_NEARER, WithoutTable, best, text_cost_of, without_table},
};
use ltcforge_files::{compact, recipe_document::Preset};
use ltcforge_fit::{BrdfKind, GoOn, Layout, PerAxis, Precision, Recipe, StoredTerms, Table, fit_seconds};
use ltcforge_textures::Engine;

/// The default table in its compact form. `UPDATE_GOLDEN=whole cargo test -p ltcforge-plan whole` fits it again.
pub(crate) const WHOLE: &[u8] = include_bytes!("whole.compact");

/// If the measured error differs from the prediction by more than this fraction, the choice is made again with
/// corrected predictions.
const MOST_OFF: f64 = 0.2;

/// Maximum number of tables that are fitted for one plan. More than two are fitted only if a compact form is still too
/// long.
const MOST_FITTED: usize = 5;

/// Maximum number of candidates that are read from the coarse table.
const MOST_READ: usize = 16;

/// After a correction, compact forms are predicted to be this factor longer than measured.
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
    /// All tables that were fitted and measured, in order.
    pub fitted: Vec<Fitted>,
    /// The table of the whole domain, in its default form at preset `paper`.
    pub whole: Whole,
    /// The models without a table.
    pub(crate) without_table: Vec<WithoutTable>,
    pub(crate) form: Form,
    /// The figures on each lobe: predicted from the coarse table, or measured.
    pub figures: Vec<Figure>,
    /// Mean absolute error of the light: by the table, by the engine's or the default table, and by the closed form.
    pub light: [Option<f64>; 3],
    /// The scene's light with the largest error, and this error.
    pub worst_light: Option<(&'a str, f64)>,
    pub(crate) probes: Arc<Probes>,
    /// The errors of the light with the engine's table, or with the default table.
    pub(crate) stock: Option<Vec<f64>>,
    pub(crate) prediction: Prediction,
}

/// A candidate that was fitted and measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// The candidate as predicted.
    pub candidate: Candidate,
    /// Mean error on the scene: as a fraction of the lobe's width, or of light under the scene's own lights.
    pub error: f64,
    /// Bytes of the compact form or of the engine's files, if the budget counts them.
    pub shipped: Option<u64>,
}

impl Fitted {
    /// The measured error divided by the predicted error.
    #[must_use]
    pub fn off_by(&self) -> f64 {
        self.error / self.candidate.error
    }
}

/// The table of the whole domain.
#[derive(Debug, Clone)]
pub struct Whole {
    /// The recipe of the table.
    pub recipe: Recipe,
    /// Mean error on the scene's configurations: measured, or for the default table that of its stored compact form,
    /// whose error is within 3 % of the table's.
    pub error: Option<f64>,
    /// The table that has this error.
    table: Option<Arc<Table>>,
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
        let probes = Probes::new(&needs, POINTS);
        let kept = compact::decode(WHOLE).ok().filter(|_| needs.brdf == BrdfKind::Ggx);
        let whole_table = kept.clone().filter(|_| layout == Layout::ALL[0]);
        let own = form.engine.and_then(Engine::stock);
        let stock = own.clone().or(kept).and_then(|table| probes.light_errors(lighting(&table)));
        let of_engine = stock.as_deref().filter(|_| own.is_some());
        let prediction = Prediction::new((&needs, &probes, of_engine), layout, form, go_on)?;
        let plan = Self {
            budget,
            is_met: false,
            chosen: Candidate::of(&prediction, prediction.base.clone()),
            candidates: Vec::new(),
            fitted: Vec::new(),
            figures: Vec::new(),
            light: [None; 3],
            worst_light: None,
            whole: Whole {
                recipe: whole_recipe(&prediction.base),
                error: whole_table.as_ref().map(|table| probes.error(table)),
                table: whole_table.map(Arc::new),
            },
            without_table: without_table(&needs, &probes),
            form,
            needs,
            probes: Arc::new(probes),
            stock,
            prediction,
        };
        Ok(plan.choose())
    }

    pub(crate) fn choose(mut self) -> Self {
        let all = candidates(&self.prediction).into_iter().chain(self.of_whole());
        let (readable, others): (Vec<_>, Vec<_>) = all.partition(|candidate| self.is_readable(candidate));
        let is_any_readable = !readable.is_empty();
        self.candidates = if is_any_readable { readable } else { others };
        // Errors of light do not add up exactly: under the scene's lights, the best candidates are read from the coarse
        // table.
        let mut read: Vec<Recipe> = Vec::new();
        loop {
            let choice = choose(&self.candidates, self.budget);
            self.is_met = choice.is_ok() && is_any_readable;
            self.chosen = choice.unwrap_or_else(|nearest| nearest).clone();
            let Candidate { recipe, limit, .. } = &self.chosen;
            if !self.probes.are_lit() || limit.is_none() || read.contains(recipe) || read.len() == MOST_READ {
                break;
            }
            let error = self.prediction.read_error(&self.probes, recipe);
            for each in self.candidates.iter_mut().filter(|each| each.recipe == *recipe) {
                (each.error, each.limit) = (error, each.limit.map(|limit| limit.min(error)));
            }
            read.push(recipe.clone());
        }
        let whole = self.whole.table.clone().filter(|_| self.chosen.limit.is_none());
        let read = whole.unwrap_or_else(|| Arc::new(self.prediction.read(&self.chosen.recipe, 0..4)));
        self.show(&read);
        self
    }

    /// Computes the figures of each lobe for a table of the choice.
    fn show(&mut self, table: &Table) {
        let of_table = self.probes.light_errors(lighting(table));
        self.worst_light = self.probes.worst_light(lighting(table), &self.needs.scene.lights);
        self.light[0] = of_table.as_ref().map(|errors| self.probes.mean(errors));
        let light = [of_table, self.stock.clone(), self.without().and_then(|form| form.light.clone())];
        self.light = light.each_ref().map(|errors| Some(self.probes.mean(errors.as_ref()?)));
        self.figures = figures(&self.needs, &self.probes, (table, self.chosen.recipe.brdf.fresnel()), &light);
        // The default table has other ranges.
        let prediction = self.chosen.limit.is_some().then_some(&self.prediction);
        add_helps(&mut self.figures, &self.probes, prediction, &self.chosen.recipe);
    }

    /// The figures of the lobe on which the light is farthest off.
    #[must_use]
    pub fn worst(&self) -> Option<&Figure> {
        self.figures.iter().max_by(|a, b| a.shown().total_cmp(&b.shown()))
    }

    /// Measures the fitted table of the choice and, if given, the table of the whole domain. The measured error or
    /// bytes decide whether the budget is met.
    ///
    /// The choice is made again with corrected predictions if the table has too many bytes, or the first time if the
    /// prediction was off by more than a fifth or the table misses the budget. Otherwise, if the table of the whole
    /// domain is better, and its halves are within a budget of bytes, it becomes the choice. If the choice changes, the
    /// plan is not [measured](TablePlan::measured): fit the new choice too.
    pub fn measure(&mut self, table: &Table, whole: Option<&Table>) {
        // A table to ship is measured after decoding.
        let (decoded, shipped) = match self.form.engine {
            Some(engine) => (None, engine.bytes(table, &self.chosen.recipe)),
            None => self.chosen.shipped.and_then(|_| compact::encoded_and_decoded(table)).unzip(),
        };
        let error = self.probes.error(decoded.as_ref().unwrap_or(table));
        if let Some(whole) = whole {
            self.whole.error = Some(self.probes.error(whole));
            self.whole.table = Some(Arc::new(whole.clone()));
        }
        let is_first = self.fitted.is_empty();
        let fitted = Fitted { candidate: self.chosen.clone(), error, shipped };
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
        self.is_met = is_met && self.is_readable(&self.chosen);
        let is_off = match self.budget {
            Budget::Bytes(most) if self.chosen.shipped.is_some() && spent > most => self.fitted.len() < MOST_FITTED,
            _ => is_first && ((factor - 1.0).abs() > MOST_OFF || misses),
        };
        if is_off {
            let of_bytes = shipped.zip(self.chosen.shipped).map_or(1.0, |(is, was)| MARGIN * is as f64 / was as f64);
            let mut again = self.clone();
            again.prediction.of_errors *= factor;
            again.prediction.of_bytes *= of_bytes;
            let again = again.choose();
            let is_met = if again.chosen.recipe == self.chosen.recipe { self.is_met } else { again.is_met };
            *self = Self { is_met, ..again };
        } else if let Some(whole) = self.of_whole().filter(|whole| is_first && whole.error < error)
            && matches!(self.budget, Budget::Bytes(most) if whole.spent() <= most)
        {
            self.chosen = whole;
        }
        if self.measured().is_some() {
            self.show(table);
        }
    }

    /// Whether the cost of the shader that reads a candidate's table is within the limits.
    pub(crate) fn is_readable(&self, candidate: &Candidate) -> bool {
        self.form.gpu.allows(text_cost_of(&candidate.recipe))
    }

    /// The best model without a table within the limits.
    pub(crate) fn without(&self) -> Option<&WithoutTable> {
        best(&self.without_table, self.form.gpu, self.light[0])
    }

    /// The best model without a table and its error, if it serves the scene better than the table.
    #[must_use]
    pub fn form_first(&self) -> Option<(&WithoutTable, f64)> {
        let [table, _, form] = self.light;
        self.without().zip(form).filter(|(_, error)| table.is_some_and(|table| *error <= FAR_NEARER * table))
    }

    /// The engine with its own table.
    pub(crate) fn engine_table(&self) -> Option<Engine> {
        self.form.engine.filter(|engine| engine.layout().is_some())
    }

    /// The default table of the whole domain in halves, as a candidate whose error is known.
    fn of_whole(&self) -> Option<Candidate> {
        let error = self.whole.error.filter(|_| !self.form.ship && !self.form.no_terms)?;
        let recipe = Recipe { precision: Precision::F16, ..self.whole.recipe.clone() };
        let (bytes, seconds) = (recipe.bytes(), fit_seconds(&recipe));
        Some(Candidate { shipped: self.prediction.shipped(&recipe), recipe, error, bytes, limit: None, seconds })
    }

    /// The candidates with the effort and lobes of the choice: the front of error against bytes.
    pub(crate) fn front(&self) -> impl Iterator<Item = &Candidate> {
        self.candidates.iter().filter(move |candidate| candidate.kind() == self.chosen.kind())
    }

    /// The measurement of the choice, if it was the last to be fitted and measured.
    #[must_use]
    pub fn measured(&self) -> Option<&Fitted> {
        self.fitted.last().filter(|fitted| fitted.candidate.recipe == self.chosen.recipe)
    }
}

/// The recipe of the scattering model's default table, over its whole domain.
fn whole_recipe(base: &Recipe) -> Recipe {
    let quarter = [0.0, std::f64::consts::FRAC_PI_2];
    let anisotropic = PerAxis { alpha: [0.0, 1.0], ratio: [0.0, 1.0], theta: quarter, phi: quarter };
    let isotropic = PerAxis { ratio: [1.0; 2], phi: [0.0; 2], ..anisotropic };
    let of_model = if base.brdf().is_isotropic() { isotropic } else { anisotropic };
    let range = base.layout.only_ranges().unwrap_or(of_model);
    Recipe {
        brdf: base.brdf().into(),
        resolution: nodes_within(&range, base.layout.default_resolution()),
        range,
        fit: Preset::Paper.fit(),
        terms: StoredTerms::Schlick,
        precision: Precision::F32,
        ..base.clone()
    }
}
