//! The error of tables of any resolution, told from one coarse table.
//!
//! A table over the scene's own ranges is fitted once and measured at configurations of the scene. For each axis it is then
//! read with fewer nodes along that axis alone, which tells, too, whether they fall on the scene's roughnesses. Errors of
//! different axes and of the fit's effort add up, as `ltcforge_fit::expectation` takes them to over the whole domain. Between the
//! counts that were read, and beyond them, the error that an axis adds is linear in the square of the step between its nodes.
//!
//! Where tables may have two lobes an entry, the coarse one has. Read at one reflectance it is a table of one lobe. Neither curve
//! stands for the other: one lobe is far from plastic or from metal, and what interpolation adds drowns in that.

use std::ops::ControlFlow;

use crate::{
    curve::{Curve, squared_steps},
    effort::added_error,
    form::Form,
    held::{Held, Stopped},
    lobes::{Lobes, lobes},
    needs::Needs,
    placement::Placed,
    shipped::{ShippedBytes, has_form},
    without::text_cost,
};
use ltcforge_fit::{
    BrdfModel, FITTER_VERSION, FitSettings, GivenNodes, Layout, LobeFresnel, LobeModel, PerAxis, Plan, Precision,
    Recipe, fit_plan,
};

/// Nodes of the coarse table where all lobes are round, and where some are not.
const ROUND: [u32; 4] = [33, 1, 33, 1];
const STRETCHED: [u32; 4] = [11, 5, 11, 7];

/// Predicts the errors of tables over a scene's ranges, of one layout.
#[derive(Debug, Clone)]
pub(crate) struct Prediction {
    base: Recipe,
    /// The lobes that there were to choose from, by their errors; those of the coarse table first.
    lobes: Vec<Lobes>,
    /// The errors of the lobes that a table may have; those of the coarse table first.
    curves: Vec<Curve>,
    /// The bytes of compact forms, where these are what is planned for.
    shipped: Option<ShippedBytes>,
    /// The scene's pairs of alpha and ratio, where they are few and a table may have them as materials.
    materials: Vec<[f64; 2]>,
}

/// The nodes of a table over the ranges of the coarse one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Nodes {
    /// The table's lobes, their number in [`Prediction::curves`].
    pub(crate) lobes: usize,
    /// How many each axis has.
    pub(crate) resolution: PerAxis<u32>,
    /// Those of alpha, and of ratio, that are given one by one: their numbers in [`Curve::given`].
    pub(crate) given: [Option<usize>; 2],
    /// Whether they are the scene's pairs, a table of layout `materials`.
    pub(crate) of_materials: bool,
}

impl Nodes {
    /// Evenly spaced ones.
    pub(crate) fn even(lobes: usize, resolution: PerAxis<u32>) -> Self {
        Self { lobes, resolution, given: [None; 2], of_materials: false }
    }

    /// Entries of the table.
    pub(crate) fn entries(&self) -> u64 {
        self.resolution.named().iter().map(|(_, n)| u64::from(**n)).product()
    }
}

impl Prediction {
    /// Fits the coarse table and measures it. Runs on the current rayon pool, whose size changes nothing; `go_on` may
    /// stop it.
    ///
    /// # Errors
    /// [`Stopped`] where `go_on` says no.
    pub(crate) fn new(
        (needs, held): (&Needs<'_>, &Held),
        layout: Layout,
        form: Form,
        fit: FitSettings,
        go_on: &(dyn Fn() -> bool + Sync),
    ) -> Result<Self, Stopped> {
        let nodes = |n: u32, [low, high]: [f64; 2]| if low < high { n } else { 1 };
        let needed = needs.range();
        let [alpha, ratio, theta, phi] = if needs.is_isotropic() { ROUND } else { STRETCHED };
        let coarse = PerAxis {
            alpha: nodes(alpha, needed.alpha),
            ratio: nodes(ratio, needed.ratio),
            theta: nodes(theta, needed.theta),
            phi: nodes(phi, needed.phi),
        };
        // Readers of some layouts take one domain, and tables of one size.
        let (range, resolution) = match layout.only_ranges() {
            Some(range) => (range, layout.default_resolution()),
            None => (needed, coarse),
        };
        // Compact forms have the evenly spaced nodes of a layout.
        let is_any_layout = !(form.ship && has_form(layout));
        let (any_nodes, terms) = (form.any_nodes && is_any_layout, form.terms());
        // Engines have no place for a second lobe, and terms tell how much of each there is.
        let is_readable = form.gpu.allows(text_cost(layout, true));
        let may_be_two = layout.only_ranges().is_none() && terms.any() && is_readable;
        let lobes = lobes(needs, may_be_two, held, fit, go_on)?;
        let base = Recipe {
            fitter: FITTER_VERSION,
            brdf: BrdfModel::from(needs.brdf()).with_fresnel(lobes[0].fresnel.clone()),
            lobe: LobeModel::Ltc,
            layout,
            resolution,
            range,
            fit,
            terms,
            precision: Precision::F32,
            given: GivenNodes::default(),
        };
        let progress = |_| if go_on() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) };
        let table = fit_plan(&Plan::new(&base), &progress).ok_or(Stopped)?;
        let some = if lobes[0].fresnel.second().is_some() { 2 } else { 1 };
        let some = lobes[..some].iter().map(|of| of.fresnel.clone());
        let curves = Curve::read((&table, &base), some, (needs, held), any_nodes, go_on)?;
        // Tables of materials have two thetas at least.
        let has_thetas = range.theta[0] < range.theta[1];
        let materials =
            if layout == Layout::Reflected && has_thetas && is_any_layout { needs.pairs() } else { Vec::new() };
        let shipped = if form.ship { ShippedBytes::of(&table, &base) } else { None };
        Ok(Self { base, lobes, curves, shipped, materials })
    }

    /// The recipe of the coarse table, from which others differ by their resolution, effort and precision.
    #[must_use]
    pub(crate) fn base(&self) -> &Recipe {
        &self.base
    }

    /// The error of a recipe's table on the scene. Domain: one with these nodes that differs from [`Prediction::base`] as said
    /// there.
    #[must_use]
    pub(crate) fn error(&self, nodes: Nodes, recipe: &Recipe) -> f64 {
        self.curves[nodes.lobes].of_base + self.of_nodes(nodes) + added_error(recipe) - added_error(&self.base)
    }

    /// The error that even the finest table of some lobes has.
    #[must_use]
    pub(crate) fn limit(&self, fresnel: &LobeFresnel) -> f64 {
        let curve = self.curves.iter().find(|curve| curve.fresnel == *fresnel).unwrap_or(&self.curves[0]);
        curve.of_base + curve.interpolation([0.0; 4]) - added_error(&self.base)
    }

    /// The bytes of a recipe's compact form, where these are what is planned for.
    pub(crate) fn shipped(&self, recipe: &Recipe) -> Option<u64> {
        self.shipped.as_ref().map(|shipped| shipped.bytes(recipe))
    }

    /// The same with all errors multiplied, and all bytes of compact forms, after a table was measured.
    #[must_use]
    pub(crate) fn corrected(&self, factor: f64, of_bytes: f64) -> Self {
        let curves = self.curves.iter().map(|curve| curve.scaled(factor)).collect();
        let shipped = self.shipped.as_ref().map(|shipped| shipped.corrected(of_bytes));
        Self { curves, shipped, ..self.clone() }
    }

    /// The lobes that there were to choose from, by their errors.
    #[must_use]
    pub(crate) fn lobes(&self) -> &[Lobes] {
        &self.lobes
    }

    /// The errors of the lobes that a table may have.
    #[must_use]
    pub(crate) fn curves(&self) -> &[Curve] {
        &self.curves
    }

    /// The error that nodes add to that of the coarse table.
    #[must_use]
    pub(crate) fn of_nodes(&self, nodes: Nodes) -> f64 {
        let Nodes { lobes, resolution, given, of_materials } = nodes;
        let curve = &self.curves[lobes];
        let placed = [0, 1].map(|axis| given[axis].map(|number| &curve.given[axis][number]));
        let mut squared = squared_steps(self.base.layout, &self.base.range, &resolution);
        let mut more = 0.0;
        for (axis, placed) in placed.into_iter().enumerate() {
            match placed {
                None if !of_materials => {}
                None | Some(Placed { added: None, .. }) => squared[axis] = 0.0,
                Some(Placed { added: Some(added), .. }) => more += curve.beyond_even(axis, *added, squared[axis]),
            }
        }
        curve.interpolation(squared) + more
    }

    /// The scene's pairs of alpha and ratio; none where they are too many, or the layout is another than `materials` is like.
    #[must_use]
    pub(crate) fn materials(&self) -> &[[f64; 2]] {
        &self.materials
    }

    /// The recipe of a table with some nodes, of the coarse table's effort and number format.
    #[must_use]
    pub(crate) fn recipe(&self, nodes: Nodes) -> Recipe {
        let Nodes { lobes, resolution, given, of_materials } = nodes;
        let curve = &self.curves[lobes];
        let brdf = self.base.brdf.clone().with_fresnel(curve.fresnel.clone());
        if of_materials {
            let given = GivenNodes::default().with_materials(&self.materials);
            return Recipe { brdf, layout: Layout::Materials, resolution, given, ..self.base.clone() };
        }
        let of = |axis: usize| given[axis].map_or(Vec::new(), |number| curve.given[axis][number].nodes.clone());
        let given = GivenNodes::new(PerAxis { alpha: of(0), ratio: of(1), theta: Vec::new(), phi: Vec::new() });
        Recipe { brdf, resolution, given, ..self.base.clone() }
    }
}
