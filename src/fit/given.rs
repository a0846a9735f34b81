//! Nodes that a recipe gives one by one, in place of a range and a resolution.

use serde::{Serialize, Serializer, ser::SerializeMap};

use super::{
    axes::PerAxis,
    layout::{ALPHA_FLOOR, RATIO_FLOOR, THETA_CEILING},
};

/// Ascending nodes of some axes; none of an axis whose nodes the layout places. Few recipes have any, so that they are kept
/// elsewhere.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct GivenNodes(Option<Box<PerAxis<Vec<f64>>>>);

static NONE: PerAxis<Vec<f64>> = PerAxis { alpha: Vec::new(), ratio: Vec::new(), theta: Vec::new(), phi: Vec::new() };

impl GivenNodes {
    /// Nodes of the axes where there are some. Domain: ascending numbers within the domain of each axis.
    #[must_use]
    pub fn new(nodes: PerAxis<Vec<f64>>) -> Self {
        let is_none = nodes.named().iter().all(|(_, nodes)| nodes.is_empty());
        Self((!is_none).then(|| Box::new(nodes)))
    }

    /// Whether no axis has any.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.0.is_none()
    }

    /// The nodes of each axis, empty where the layout places them.
    #[must_use]
    pub fn axes(&self) -> &PerAxis<Vec<f64>> {
        self.0.as_deref().unwrap_or(&NONE)
    }

    /// The nodes of a table: those given, moved into the limits of the fit, and `placed` on the other axes.
    pub(crate) fn in_place_of(&self, placed: PerAxis<Vec<f64>>) -> PerAxis<Vec<f64>> {
        let or = |given: &Vec<f64>, placed: Vec<f64>, within: &dyn Fn(f64) -> f64| {
            if given.is_empty() { placed } else { given.iter().map(|node| within(*node)).collect() }
        };
        let given = self.axes();
        PerAxis {
            alpha: or(&given.alpha, placed.alpha, &|alpha| alpha.max(ALPHA_FLOOR)),
            ratio: or(&given.ratio, placed.ratio, &|ratio| ratio.max(RATIO_FLOOR)),
            theta: or(&given.theta, placed.theta, &|theta| theta.min(THETA_CEILING)),
            phi: or(&given.phi, placed.phi, &|phi| phi),
        }
    }
}

/// The axes that have nodes, by their names.
impl Serialize for GivenNodes {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let given = self.axes().named().into_iter().filter(|(_, nodes)| !nodes.is_empty());
        let mut map = to.serialize_map(None)?;
        for (name, nodes) in given {
            map.serialize_entry(name, nodes)?;
        }
        map.end()
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;
    use crate::{
        BrdfKind, Configuration, FITTER_VERSION, FitSettings, Layout, LobeModel, Metric, Plan, Precision, Recipe,
        Solver, StoredTerms, fit_plan,
    };

    fn recipe(layout: Layout, resolution: [u32; 4], given: GivenNodes) -> Recipe {
        let quarter = [0.0, std::f64::consts::FRAC_PI_2];
        let whole = PerAxis { alpha: [0.0, 1.0], ratio: [0.0, 1.0], theta: quarter, phi: quarter };
        let range = layout.only_ranges().unwrap_or(whole);
        let nodes = |n: u32, [low, high]: [f64; 2]| if low < high { n } else { 1 };
        let [alpha, ratio, theta, phi] = resolution;
        Recipe {
            fitter: FITTER_VERSION,
            brdf: BrdfKind::Ggx.into(),
            lobe: LobeModel::Ltc,
            layout,
            resolution: PerAxis { alpha, ratio: nodes(ratio, range.ratio), theta, phi: nodes(phi, range.phi) },
            range,
            given,
            fit: FitSettings {
                metric: Metric::Sw1,
                solver: Solver::Bfgs,
                samples: 64,
                directions: 4,
                steps: 5,
                seed: 0,
                simplex: None,
            },
            terms: StoredTerms::Schlick,
            precision: Precision::F32,
        }
    }

    #[test]
    fn the_nodes_of_every_layout_are_even_and_given_ones_need_not_be() {
        for layout in Layout::ALL {
            for n in [2, 3, 7, 40] {
                let placed = recipe(*layout, [n; 4], GivenNodes::default()).nodes();
                assert!(layout.is_even(&placed), "{layout} {n}");
            }
        }
        let [alpha, none] = [vec![0.04, 0.09, 0.25, 0.3], Vec::new()];
        let given = GivenNodes::new(PerAxis { alpha, ratio: none.clone(), theta: none.clone(), phi: none });
        for layout in [Layout::Reflected, Layout::Kt2022] {
            assert!(!layout.is_even(&recipe(layout, [4, 3, 3, 3], given.clone()).nodes()), "{layout}");
        }
    }

    /// A lookup at a node that was given has the numbers of its entry, and no others.
    #[test]
    fn a_lookup_finds_the_nodes_that_were_given() {
        let given = PerAxis { alpha: vec![0.04, 0.09, 0.25], ratio: vec![0.5], theta: vec![0.3, 1.0], phi: vec![0.0] };
        let mut recipe = recipe(Layout::Kt2022, [3, 1, 2, 1], GivenNodes::new(given.clone()));
        recipe.range = PerAxis { alpha: [0.04, 0.25], ratio: [0.5; 2], theta: [0.3, 1.0], phi: [0.0; 2] };
        let plan = Plan::new(&recipe);
        let table = fit_plan(&plan, &|_| ControlFlow::Continue(())).expect("nothing stops it");
        assert_eq!(table.axes(), &given);
        for (index, matrix) in table.matrices().iter().enumerate() {
            let PerAxis { alpha, ratio, theta, phi } = table.axes().node(index);
            let at = Configuration { alpha_x: alpha, alpha_y: alpha * ratio, theta, phi };
            let found = table.lookup(&at).matrix;
            assert!(
                found.iter().zip(matrix).all(|(found, stored)| (found - f64::from(*stored)).abs() < 1e-6),
                "{index}"
            );
        }
    }
}
