//! How far lobes halfway between two nodes of a table are from GGX, by two alignments.

use glam::DMat3;
use rayon::prelude::*;

use super::{error::FigureError, fits::entries, nearest::Nearest};
use crate::fit::{
    Fitter, Layout, PerAxis, Plan,
    brdf::{Ggx, Mirrors},
    lobe::ltc::align,
    math::from_row_major,
};

/// As of layout `kt2022`.
const FLATTEST: f64 = 1e-4;
/// Entries that differ by more are aligned differently.
const DIFFERENT: f64 = 0.01;

/// The two alignments.
pub(super) const OURS: usize = 0;
pub(super) const NEAREST: usize = 1;

/// A pair of neighbouring nodes, and the lobe halfway.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pair {
    /// The configuration halfway.
    pub(super) at: PerAxis<f64>,
    /// The matrices of both nodes by either alignment, with third columns of unit length.
    pub(super) nodes: [[DMat3; 2]; 2],
    /// Sliced Wasserstein distances from GGX of the lobe of their mean, by either alignment.
    pub(super) errors: [f64; 2],
}

impl Pair {
    /// The matrix halfway by one of the alignments.
    pub(super) fn mean(&self, alignment: usize) -> DMat3 {
        let [first, second] = self.nodes[alignment];
        (first + second) * 0.5
    }

    /// The determinant halfway over the smaller one of the nodes.
    fn determinant(&self, alignment: usize) -> f64 {
        let [first, second] = self.nodes[alignment].map(|m| m.determinant().abs());
        self.mean(alignment).determinant() / first.min(second)
    }
}

/// All pairs of neighbours of a table.
#[derive(Debug)]
pub(super) struct Halfway {
    /// Nodes on each axis.
    pub(super) nodes: PerAxis<usize>,
    /// Nodes that the alignments leave with different matrices.
    pub(super) different: usize,
    pub(super) pairs: Vec<Pair>,
}

impl Halfway {
    /// Fits the table of a recipe and measures it, on the current rayon pool. Domain: a recipe of GGX.
    pub(super) fn of(recipe: &str) -> Result<Self, FigureError> {
        let (plan, entries) = entries(recipe)?;
        let nearest = Nearest::new();
        let places: Vec<PerAxis<f64>> = (0..plan.entries()).map(|index| plan.place(index)).collect();
        let matrices: Vec<[DMat3; 2]> = places
            .par_iter()
            .zip(&entries)
            .map(|(place, entry)| {
                let ours = align(&from_row_major(&entry.matrix), Mirrors::of(place.view()), FLATTEST);
                [ours, nearest.align(&ours)].map(|m| m * (1.0 / m.z_axis.length()))
            })
            .collect();
        let is_different = |[ours, nearest]: &&[DMat3; 2]| !ours.abs_diff_eq(*nearest, DIFFERENT);
        let fitter = Fitter::new(&plan.recipe().fit());
        let pairs = neighbours(&plan)
            .into_par_iter()
            .map_init(
                || fitter.another(),
                |fitter, [first, second]| {
                    let at = between(plan.recipe().layout(), &places[first], &places[second]);
                    let [alpha_x, alpha_y] = at.roughness();
                    let nodes = [OURS, NEAREST].map(|of| [matrices[first][of], matrices[second][of]]);
                    let mut pair = Pair { at, nodes, errors: [0.0; 2] };
                    pair.errors = [OURS, NEAREST]
                        .map(|of| fitter.error(&Ggx { alpha_x, alpha_y }, at.view(), &pair.mean(of)));
                    pair
                },
            )
            .collect();
        Ok(Self { nodes: plan.nodes().lengths(), different: matrices.iter().filter(is_different).count(), pairs })
    }

    /// The mean error by one of the alignments.
    pub(super) fn mean(&self, alignment: usize) -> f64 {
        self.pairs.iter().map(|pair| pair.errors[alignment]).sum::<f64>() / self.pairs.len() as f64
    }

    /// The least determinant halfway, over the smaller one of its neighbours'.
    pub(super) fn least_determinant(&self, alignment: usize) -> f64 {
        self.pairs.iter().map(|pair| pair.determinant(alignment)).fold(f64::INFINITY, f64::min)
    }

    /// The pair whose error by this alignment is largest over that by the other one, and how many times the other one's it is.
    pub(super) fn worst(&self, alignment: usize) -> Option<(&Pair, f64)> {
        let ratio = |pair: &Pair| pair.errors[alignment] / pair.errors[1 - alignment];
        self.pairs.iter().map(|pair| (pair, ratio(pair))).max_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// The indices of nodes that are next to each other along one axis.
fn neighbours(plan: &Plan) -> Vec<[usize; 2]> {
    let PerAxis { alpha, ratio, theta, phi } = plan.nodes().lengths();
    let axes = [(alpha, ratio * theta * phi), (ratio, theta * phi), (theta, phi), (phi, 1)];
    let all = 0..alpha * ratio * theta * phi;
    let along = |(count, stride): (usize, usize)| {
        all.clone().filter(move |index| index / stride % count + 1 < count).map(move |index| [index, index + stride])
    };
    axes.into_iter().flat_map(along).collect()
}

/// The configuration halfway between two nodes, in the variables of the layout's textures.
fn between(layout: Layout, a: &PerAxis<f64>, b: &PerAxis<f64>) -> PerAxis<f64> {
    let mean = |a: f64, b: f64| 0.5 * (a + b);
    let middle =
        PerAxis { alpha: mean(a.alpha, b.alpha), ratio: mean(a.ratio, b.ratio), theta: mean(a.theta, b.theta), phi: mean(a.phi, b.phi) };
    if layout != Layout::Ltc2017 {
        return middle;
    }
    let roughness = mean(a.alpha.sqrt(), b.alpha.sqrt());
    let versine = |theta: f64| (1.0 - libm::cos(theta)).max(0.0).sqrt();
    let view = mean(versine(a.theta), versine(b.theta));
    PerAxis { alpha: roughness * roughness, theta: libm::acos(1.0 - view * view), ..middle }
}
