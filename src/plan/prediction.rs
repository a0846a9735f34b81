//! Predicts the error of tables of any resolution from one coarse table.
//!
//! A table over the scene's own ranges is fitted once and measured at configurations of the scene. For each axis, it is
//! then read with fewer nodes along this axis only. This also shows whether nodes coincide with the scene's
//! roughnesses. The errors due to each axis and to the effort of the fit add up, as in `ltcforge_fit::expectation` for
//! the whole domain. Between the numbers of nodes that were read, and beyond them, the error that an axis adds is
//! linear in the square of the step between its nodes.
//!
//! If tables may have two lobes per entry, the coarse table has two lobes. Read at one reflectance, it is a table of
//! one lobe. One lobe and two lobes have separate curves: a single lobe is far from plastic or from metal, and this
//! error hides the interpolation error.

use std::ops::Range;

use crate::{
    curve::{Curve, squared_steps},
    form::Form,
    lobes::{Lobes, fitted, lobes},
    needs::Needs,
    probes::{Probes, Stopped},
};
use ltcforge_files::{
    compact::{self, CompactBytes},
    recipe_document::Preset,
};
use ltcforge_fit::{
    FITTER_VERSION, FitSettings, GivenNodes, GoOn, Layout, LobeModel, PerAxis, Precision, Recipe, StoredTerms, Table,
    expectation,
};
use ltcforge_shaders::GpuCost;
use ltcforge_textures::Engine;

/// Nodes of the coarse table if all lobes are isotropic, and if some are not.
const ISOTROPIC: PerAxis<u32> = PerAxis { alpha: 33, ratio: 1, theta: 33, phi: 1 };
const ANISOTROPIC: PerAxis<u32> = PerAxis { alpha: 11, ratio: 5, theta: 11, phi: 7 };

/// Predicts the errors of tables of one layout over a scene's ranges.
#[derive(Debug, Clone)]
pub(crate) struct Prediction {
    /// The recipe of the coarse table. Predicted recipes have its model and ranges. They may differ in nodes, lobes,
    /// effort and precision, and may have layout `materials`.
    pub(crate) base: Recipe,
    /// All choices of lobes; those of the coarse table first.
    pub(crate) lobes: Vec<Lobes>,
    /// The errors of the lobes that a table may have; those of the coarse table first.
    pub(crate) curves: Vec<Curve>,
    /// The coarse table.
    table: Table,
    /// Error on the scene for each unit of expected error.
    scale: f64,
    /// The engine whose files the budget counts.
    engine: Option<Engine>,
    /// The bytes of compact forms, if the budget counts them.
    compact: Option<CompactBytes>,
    /// Factors on all errors, and on the bytes that are shipped: corrections after a table was measured.
    pub(crate) of_errors: f64,
    pub(crate) of_bytes: f64,
    /// The scene's pairs of alpha and ratio; empty if a table cannot have them as materials.
    pub(crate) materials: Vec<[f64; 2]>,
}

/// The expected error that the limits on samples and directions add.
fn added_error(recipe: &Recipe) -> f64 {
    let endless = FitSettings { samples: u32::MAX, directions: u32::MAX, ..recipe.fit };
    expectation(recipe).error - expectation(&Recipe { fit: endless, ..recipe.clone() }).error
}

/// The number of nodes on each axis: one if the range is a single value.
pub(crate) fn nodes_within(range: &PerAxis<[f64; 2]>, resolution: PerAxis<u32>) -> PerAxis<u32> {
    let nodes = |[low, high]: [f64; 2], n: u32| if low < high { n } else { 1 };
    PerAxis {
        alpha: nodes(range.alpha, resolution.alpha),
        ratio: nodes(range.ratio, resolution.ratio),
        theta: nodes(range.theta, resolution.theta),
        phi: nodes(range.phi, resolution.phi),
    }
}

impl Prediction {
    /// Fits the coarse table and measures it. Runs on the current rayon pool. The size of the pool does not change the
    /// result.
    ///
    /// # Errors
    /// [`Stopped`] if `go_on` returns `false`.
    pub(crate) fn new(
        (needs, probes, stock): (&Needs<'_>, &Probes, Option<&[f64]>),
        layout: Layout,
        form: Form,
        go_on: &GoOn<'_>,
    ) -> Result<Self, Stopped> {
        let coarse = if needs.is_isotropic() { ISOTROPIC } else { ANISOTROPIC };
        // Readers of some layouts expect one domain and one size.
        let only = layout.only_ranges();
        let mut base = Recipe {
            fitter: FITTER_VERSION,
            brdf: needs.brdf.into(),
            lobe: LobeModel::Ltc,
            layout,
            resolution: only.map_or(nodes_within(&needs.range, coarse), |_| layout.default_resolution()),
            range: only.unwrap_or(needs.range),
            fit: Preset::Standard.fit(),
            terms: if form.no_terms { StoredTerms::None } else { StoredTerms::Schlick },
            precision: Precision::F32,
            given: GivenNodes::default(),
        };
        // Engines cannot read a second lobe, and a blend needs terms.
        let may_be_two = only.is_none() && base.terms.any() && form.gpu.allows(GpuCost::of_layout(layout.name(), true));
        let lobes = lobes(needs, may_be_two, (probes, stock), &base, go_on)?;
        base.brdf = base.brdf.with_fresnel(lobes[0].fresnel.clone());
        let table = fitted(&base, go_on)?;
        // A table may also have the best single lobe instead of two.
        let choices = if lobes[0].fresnel.second().is_some() { 2 } else { 1 };
        let choices = lobes[..choices].iter().map(|choice| choice.fresnel.clone());
        // Compact forms need the evenly spaced nodes of a layout.
        let is_even = form.ship && compact::LAYOUTS.contains(&layout);
        let curves = Curve::read((&table, &base), choices, (needs, probes), form.any_nodes && !is_even, go_on)?;
        // Tables of materials have at least two theta nodes.
        let may_be_materials = layout == Layout::Reflected && base.range.theta[0] < base.range.theta[1] && !is_even;
        let materials = if may_be_materials { needs.pairs() } else { Vec::new() };
        let compact = if form.ship { CompactBytes::of(&table, &base) } else { None };
        let scale = if probes.are_lit() { curves[0].of_base / expectation(&base).error } else { 1.0 };
        Ok(Self {
            base,
            lobes,
            curves,
            table,
            scale,
            engine: form.engine,
            compact,
            of_errors: 1.0,
            of_bytes: 1.0,
            materials,
        })
    }

    /// The error of a recipe's table on the scene. Domain: see [`Prediction::base`].
    pub(crate) fn error(&self, recipe: &Recipe) -> f64 {
        self.of_errors * (self.curve(recipe).of_base + self.of_nodes(recipe) + self.of_effort(recipe))
    }

    /// The errors of a recipe's lobes.
    fn curve(&self, recipe: &Recipe) -> &Curve {
        self.curves.iter().find(|curve| curve.fresnel == *recipe.brdf.fresnel()).unwrap_or(&self.curves[0])
    }

    /// The error of a recipe's table, measured on the coarse table at its nodes.
    pub(crate) fn read_error(&self, probes: &Probes, recipe: &Recipe) -> f64 {
        self.of_errors * (probes.error(&self.read(recipe, 0..4)) + self.of_effort(recipe))
    }

    /// The error that an effort adds to the coarse table's error.
    fn of_effort(&self, recipe: &Recipe) -> f64 {
        self.scale * (added_error(recipe) - added_error(&self.base))
    }

    /// The error of the finest table with the lobes of a recipe.
    pub(crate) fn limit(&self, recipe: &Recipe) -> f64 {
        let curve = self.curve(recipe);
        self.of_errors * (curve.of_base + curve.interpolation([0.0; 4]) - self.scale * added_error(&self.base))
    }

    /// The bytes of a recipe's compact form or of an engine's files, if the budget counts them.
    pub(crate) fn shipped(&self, recipe: &Recipe) -> Option<u64> {
        let bytes = match self.engine {
            Some(engine) => engine.predicted_bytes(&self.table, recipe),
            None => self.compact.as_ref().map(|compact| compact.bytes(recipe)),
        };
        bytes.map(|bytes| (bytes as f64 * self.of_bytes).ceil() as u64)
    }

    /// The coarse table, read at the nodes of another table on some axes. Nodes that are the scene's own values stay
    /// those of the coarse table.
    pub(crate) fn read(&self, recipe: &Recipe, axes: Range<usize>) -> Table {
        let (nodes, is_of_materials) = (recipe.nodes(), recipe.layout.is_of_materials());
        let is_read = |axis: &usize| self.base.layout.only_ranges().is_none() && (*axis > 1 || !is_of_materials);
        let axes = axes.filter(is_read);
        let read = axes.fold(self.table.clone(), |table, axis| table.resampled(axis, nodes.named()[axis].1.clone()));
        let fresnel = recipe.brdf.fresnel();
        if fresnel == self.base.brdf.fresnel() { read } else { read.with_one_lobe(fresnel) }
    }

    /// The error that the nodes of a recipe add to the coarse table's error. Nodes that are the scene's own values need
    /// no interpolation.
    pub(crate) fn of_nodes(&self, recipe: &Recipe) -> f64 {
        let mut squared = squared_steps(self.base.layout, &self.base.range, &recipe.resolution);
        for (squared, (_, given)) in squared.iter_mut().zip(recipe.given.axes().named()) {
            *squared = if given.is_empty() { *squared } else { 0.0 };
        }
        self.curve(recipe).interpolation(squared)
    }
}
