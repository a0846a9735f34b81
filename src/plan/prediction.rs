//! The error of tables of any resolution, told from one coarse table.
//!
//! A table over the scene's own ranges is fitted once and measured at configurations of the scene. For each axis it is then
//! read with fewer nodes along that axis alone, which tells, too, whether they fall on the scene's roughnesses. Errors of
//! different axes and of the fit's effort add up, as `ltcforge_fit::expectation` takes them to over the whole domain. Between the
//! counts that were read, and beyond them, the error that an axis adds is linear in the square of the step between its nodes.

use std::ops::ControlFlow;

use crate::{
    effort::added_error,
    form::Form,
    held::{POINTS, Stopped, error},
    lobes::{Lobes, lobes},
    needs::Needs,
    placement::{Placed, by_weight, of_values},
    resampled::resampled,
    shipped::{ShippedBytes, has_form},
};
use ltcforge_fit::{
    BrdfModel, FITTER_VERSION, FitSettings, GivenNodes, Layout, LobeFresnel, LobeModel, PerAxis, Plan, Precision,
    Recipe, fit_plan,
};

/// Those at which an axis's constant is found.
const POINTS_OF_AXIS: usize = 64;

/// Nodes of the coarse table where all lobes are round, and where some are not.
const ROUND: [u32; 4] = [33, 1, 33, 1];
const STRETCHED: [u32; 4] = [11, 5, 11, 7];
/// Nodes of an axis with which the coarse table is read again.
const FEWER: [u32; 11] = [20, 16, 12, 9, 8, 7, 6, 5, 4, 3, 2];

/// Predicts the errors of tables over a scene's ranges, of one layout.
#[derive(Debug, Clone)]
pub(crate) struct Prediction {
    base: Recipe,
    /// The error of the coarse table.
    of_base: f64,
    /// The lobes that a table may have, by their errors; those of the coarse one first.
    lobes: Vec<Lobes>,
    /// The bytes of compact forms, where these are what is planned for.
    shipped: Option<ShippedBytes>,
    /// By what the predictions were corrected.
    factor: f64,
    /// For each axis squared steps, see `ltcforge_fit::Layout::steps`, and the error that each adds to the coarse table's.
    added: [Vec<[f64; 2]>; 4],
    /// Nodes of alpha, and of ratio, that are not evenly spaced.
    given: [Vec<Placed>; 2],
    /// The scene's pairs of alpha and ratio, where they are few and a table may have them as materials.
    materials: Vec<[f64; 2]>,
}

/// The nodes of a table over the ranges of the coarse one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Nodes {
    /// How many each axis has.
    pub(crate) resolution: PerAxis<u32>,
    /// Those of alpha, and of ratio, that are given one by one: their numbers in [`Prediction::given_on`].
    pub(crate) given: [Option<usize>; 2],
    /// Whether they are the scene's pairs, a table of layout `materials`.
    pub(crate) of_materials: bool,
}

impl Nodes {
    /// Evenly spaced ones.
    pub(crate) fn even(resolution: PerAxis<u32>) -> Self {
        Self { resolution, given: [None; 2], of_materials: false }
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
        needs: &Needs<'_>,
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
        let places = needs.draw(POINTS);
        // Compact forms have the evenly spaced nodes of a layout.
        let is_any_layout = !(form.ship && has_form(layout));
        let (any_nodes, terms) = (form.any_nodes && is_any_layout, form.terms());
        // Engines have no place for a second lobe, and terms tell how much of each there is.
        let may_be_two = layout.only_ranges().is_none() && terms.any();
        let lobes = lobes(needs, may_be_two, &places, fit, go_on)?;
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
        let of_base = error(&table, &places);
        let of_some = error(&table, &places[..POINTS_OF_AXIS]);
        let is_free = layout.only_ranges().is_none();
        let mut added = [const { Vec::new() }; 4];
        let mut given = [const { Vec::new() }; 2];
        if any_nodes && is_free {
            given = needs.values().map(|values| of_values(&values).into_iter().collect());
        }
        let weighed = needs.weighed();
        for (axis, added) in added.iter_mut().enumerate() {
            let (squared, nodes) = (squared_steps(&base), *resolution.named()[axis].1);
            added.push([squared[axis], 0.0]);
            for fewer in FEWER.into_iter().filter(|fewer| is_free && *fewer < nodes) {
                if !go_on() {
                    return Err(Stopped);
                }
                let mut coarse = resolution;
                *[&mut coarse.alpha, &mut coarse.ratio, &mut coarse.theta, &mut coarse.phi][axis] = fewer;
                let read = resampled(&table, layout.nodes(&range, &coarse));
                let more = error(&read, &places[..POINTS_OF_AXIS]) - of_some;
                let squared = squared_steps(&Recipe { resolution: coarse, ..base.clone() });
                added.push([squared[axis], more.max(0.0)]);
                if !any_nodes || axis >= given.len() || fewer < 3 {
                    continue;
                }
                let mut axes = layout.nodes(&range, &coarse);
                let nodes = by_weight(layout, &range, axis, &weighed[axis], fewer);
                [&mut axes.alpha, &mut axes.ratio][axis].clone_from(&nodes);
                let by_weight = error(&resampled(&table, axes), &places[..POINTS_OF_AXIS]) - of_some;
                if by_weight < more {
                    given[axis].push(Placed { nodes, added: Some(by_weight.max(0.0)) });
                }
            }
        }
        // Tables of materials have two thetas at least.
        let has_thetas = range.theta[0] < range.theta[1];
        let materials =
            if layout == Layout::Reflected && has_thetas && is_any_layout { needs.pairs() } else { Vec::new() };
        let shipped = if form.ship { ShippedBytes::of(&table, &base) } else { None };
        Ok(Self { base, of_base, lobes, shipped, factor: 1.0, added, given, materials })
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
        let of_lobes = self.of_lobes(recipe.brdf.fresnel());
        self.of_base + of_lobes + self.of_nodes(nodes) + added_error(recipe) - added_error(&self.base)
    }

    /// The error that lobes add to those of the coarse table.
    fn of_lobes(&self, fresnel: &LobeFresnel) -> f64 {
        let of = self.lobes.iter().find(|lobes| lobes.fresnel == *fresnel);
        of.map_or(0.0, |of| self.factor * (of.error - self.lobes[0].error))
    }

    /// The error that even the finest table of some lobes has.
    #[must_use]
    pub(crate) fn limit(&self, fresnel: &LobeFresnel) -> f64 {
        self.of_base + self.of_lobes(fresnel) + self.interpolation([0.0; 4]) - added_error(&self.base)
    }

    /// The bytes of a recipe's compact form, where these are what is planned for.
    pub(crate) fn shipped(&self, recipe: &Recipe) -> Option<u64> {
        self.shipped.as_ref().map(|shipped| shipped.bytes(recipe))
    }

    /// The same with all errors multiplied, and all bytes of compact forms, after a table was measured.
    #[must_use]
    pub(crate) fn corrected(&self, factor: f64, of_bytes: f64) -> Self {
        let added =
            self.added.clone().map(|axis| axis.into_iter().map(|[step, error]| [step, factor * error]).collect());
        let scaled = |placed: Placed| Placed { added: placed.added.map(|error| factor * error), ..placed };
        let given = self.given.clone().map(|placed| placed.into_iter().map(scaled).collect());
        let shipped = self.shipped.as_ref().map(|shipped| shipped.corrected(of_bytes));
        Self { of_base: factor * self.of_base, factor: factor * self.factor, added, given, shipped, ..self.clone() }
    }

    /// The lobes that a table may have, by their errors.
    #[must_use]
    pub(crate) fn lobes(&self) -> &[Lobes] {
        &self.lobes
    }

    /// The error that nodes add to that of the coarse table.
    #[must_use]
    pub(crate) fn of_nodes(&self, nodes: Nodes) -> f64 {
        let Nodes { resolution, given, of_materials } = nodes;
        let placed = [0, 1].map(|axis| given[axis].map(|number| &self.given[axis][number]));
        let mut squared = squared_of(self.base.layout.steps(&self.base.range, &resolution));
        let mut more = 0.0;
        for (axis, placed) in placed.into_iter().enumerate() {
            match placed {
                None if !of_materials => {}
                None | Some(Placed { added: None, .. }) => squared[axis] = 0.0,
                Some(Placed { added: Some(added), .. }) => {
                    // In place of what evenly spaced nodes add.
                    more += added - along(&self.added[axis], squared[axis]);
                }
            }
        }
        self.interpolation(squared) + more
    }

    /// Nodes of alpha, 0, or of ratio, 1, that are not evenly spaced: the scene's values, where they are few, and nodes by their weight.
    #[must_use]
    pub(crate) fn given_on(&self, axis: usize) -> &[Placed] {
        &self.given[axis]
    }

    /// The scene's pairs of alpha and ratio; none where they are too many, or the layout is another than `materials` is like.
    #[must_use]
    pub(crate) fn materials(&self) -> &[[f64; 2]] {
        &self.materials
    }

    /// The recipe of a table with some nodes, of the coarse table's effort and number format.
    #[must_use]
    pub(crate) fn recipe(&self, nodes: Nodes) -> Recipe {
        let Nodes { resolution, given, of_materials } = nodes;
        if of_materials {
            let given = GivenNodes::default().with_materials(&self.materials);
            return Recipe { layout: Layout::Materials, resolution, given, ..self.base.clone() };
        }
        let of = |axis: usize| given[axis].map_or(Vec::new(), |number| self.given[axis][number].nodes.clone());
        let given = GivenNodes::new(PerAxis { alpha: of(0), ratio: of(1), theta: Vec::new(), phi: Vec::new() });
        Recipe { resolution, given, ..self.base.clone() }
    }

    fn interpolation(&self, squared: [f64; 4]) -> f64 {
        self.added.iter().zip(squared).map(|(added, squared)| along(added, squared)).sum()
    }
}

/// The line through the points around `x`, or through the first or last two. Domain: ascending first numbers, one point at
/// least.
fn along(points: &[[f64; 2]], x: f64) -> f64 {
    let [.., last] = points else { return 0.0 };
    let pair = points.windows(2).find(|pair| x <= pair[1][0]).or_else(|| points.windows(2).last());
    pair.map_or(last[1], |pair| pair[0][1] + (pair[1][1] - pair[0][1]) * (x - pair[0][0]) / (pair[1][0] - pair[0][0]))
}

/// The squared step of each axis.
fn squared_steps(recipe: &Recipe) -> [f64; 4] {
    squared_of(recipe.layout.steps(&recipe.range, &recipe.resolution))
}

fn squared_of(steps: PerAxis<f64>) -> [f64; 4] {
    steps.named().map(|(_, step)| step * step)
}
