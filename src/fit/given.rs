//! Nodes that a recipe lists explicitly, instead of a range and a resolution.

use std::collections::BTreeMap;

use serde::{Serialize, Serializer, ser::SerializeMap};

use super::{
    axes::PerAxis,
    layout::{ALPHA_FLOOR, RATIO_FLOOR, THETA_CEILING},
};

/// Explicit nodes of some axes, in ascending order. An axis without explicit nodes is empty here, and the layout places
/// its nodes. Instead of nodes of alpha and ratio, a recipe can list materials: pairs of alpha and ratio in any order.
/// Few recipes have either, so the lists are boxed.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct GivenNodes(Option<Box<Given>>);

#[derive(Debug, Clone, PartialEq)]
struct Given {
    nodes: PerAxis<Vec<f64>>,
    /// True if alpha and ratio form a list of materials.
    are_materials: bool,
}

static NONE: PerAxis<Vec<f64>> = PerAxis { alpha: Vec::new(), ratio: Vec::new(), theta: Vec::new(), phi: Vec::new() };

impl GivenNodes {
    /// Explicit nodes; an axis may be empty. Domain: ascending numbers within the domain of each axis.
    #[must_use]
    pub fn new(nodes: PerAxis<Vec<f64>>) -> Self {
        let is_none = nodes.named().iter().all(|(_, nodes)| nodes.is_empty());
        Self((!is_none).then(|| Box::new(Given { nodes, are_materials: false })))
    }

    /// These nodes of theta and phi, with materials instead of nodes of alpha and ratio. Domain: at least one pair,
    /// both numbers within the domain of their axis.
    #[must_use]
    pub fn with_materials(self, pairs: &[[f64; 2]]) -> Self {
        let [alpha, ratio] = [0, 1].map(|axis| pairs.iter().map(|pair| pair[axis]).collect());
        let PerAxis { theta, phi, .. } = self.axes().clone();
        Self(Some(Box::new(Given { nodes: PerAxis { alpha, ratio, theta, phi }, are_materials: true })))
    }

    /// The materials, as pairs of alpha and ratio; empty without materials.
    #[must_use]
    pub fn materials(&self) -> Vec<[f64; 2]> {
        let given = self.0.as_deref().filter(|given| given.are_materials).map(|given| &given.nodes);
        given.map_or(Vec::new(), |nodes| nodes.alpha.iter().zip(&nodes.ratio).map(|(a, r)| [*a, *r]).collect())
    }

    /// True if no axis has explicit nodes.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.0.is_none()
    }

    /// The explicit nodes of each axis. An axis whose nodes the layout places is empty.
    #[must_use]
    pub fn axes(&self) -> &PerAxis<Vec<f64>> {
        self.0.as_deref().map_or(&NONE, |given| &given.nodes)
    }

    /// The nodes of a table. Explicit nodes are clamped to the limits of the fit; the other axes have the nodes of
    /// `placed`.
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

/// Serializes the field `nodes`, with the axes that have explicit nodes, and the field `materials`. Empty fields are
/// left out.
impl Serialize for GivenNodes {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Material {
            alpha: f64,
            ratio: f64,
        }
        let materials: Vec<Material> =
            self.materials().into_iter().map(|[alpha, ratio]| Material { alpha, ratio }).collect();
        let of_view = |name: &str| materials.is_empty() || name == "theta" || name == "phi";
        let given = self.axes().named().into_iter();
        let nodes: BTreeMap<&str, &Vec<f64>> =
            given.filter(|(name, nodes)| !nodes.is_empty() && of_view(name)).collect();
        let mut map = to.serialize_map(None)?;
        if !nodes.is_empty() {
            map.serialize_entry("nodes", &nodes)?;
        }
        if !materials.is_empty() {
            map.serialize_entry("materials", &materials)?;
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

    /// A lookup at an explicit node returns exactly the numbers of its entry.
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
