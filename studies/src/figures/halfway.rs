//! The error of lobes halfway between two nodes of a table, for two alignments.

use glam::DMat3;
use ltcforge::fit::{
    Fitter, Layout, PerAxis, Plan,
    brdf::{Ggx, Mirrors},
    lobe::ltc::align,
    math::from_row_major,
};
use rayon::prelude::*;

use super::{error::FigureError, fits::entries, nearest::Nearest};

/// The constant `FLATTEST` of layout `kt2022`.
const FLATTEST: f64 = 1e-4;
/// Entries whose matrices differ by at least this are aligned differently.
const DIFFERENT: f64 = 0.01;

/// The two alignments.
pub(super) const OURS: usize = 0;
pub(super) const NEAREST: usize = 1;

/// A pair of neighbouring nodes, and the lobe halfway between them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pair {
    /// The configuration halfway between the nodes.
    pub(super) at: PerAxis<f64>,
    /// For each alignment, the matrices of both nodes, with third columns of unit length.
    pub(super) nodes: [[DMat3; 2]; 2],
    /// For each alignment, the sliced Wasserstein distance between GGX and the lobe of the mean matrix.
    pub(super) errors: [f64; 2],
}

impl Pair {
    /// The matrix halfway between the nodes, for an alignment.
    pub(super) fn mean(&self, alignment: usize) -> DMat3 {
        let [first, second] = self.nodes[alignment];
        (first + second) * 0.5
    }

    /// The determinant halfway, divided by the smaller determinant of the two nodes.
    fn determinant(&self, alignment: usize) -> f64 {
        let [first, second] = self.nodes[alignment].map(|m| m.determinant());
        self.mean(alignment).determinant() / if first.abs() < second.abs() { first } else { second }
    }

    /// Whether exactly one of the two matrices is mirrored.
    fn is_mirrored(&self, alignment: usize) -> bool {
        let [first, second] = self.nodes[alignment].map(|m| m.determinant());
        first * second < 0.0
    }
}

/// All pairs of neighbours in a table.
#[derive(Debug)]
pub(super) struct Halfway {
    pub(super) layout: Layout,
    /// Number of nodes on each axis.
    pub(super) nodes: PerAxis<usize>,
    /// The number of nodes for which the alignments give different matrices.
    pub(super) different: usize,
    pub(super) pairs: Vec<Pair>,
}

impl Halfway {
    /// Fits the table of a recipe and measures it, on the current rayon pool. Domain: a recipe for GGX.
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
                    let nodes = [OURS, NEAREST].map(|k| [matrices[first][k], matrices[second][k]]);
                    let mut pair = Pair { at, nodes, errors: [0.0; 2] };
                    pair.errors =
                        [OURS, NEAREST].map(|k| fitter.error(&Ggx { alpha_x, alpha_y }, at.view(), &pair.mean(k)));
                    pair
                },
            )
            .collect();
        Ok(Self {
            layout: plan.recipe().layout(),
            nodes: plan.nodes().lengths(),
            different: matrices.iter().filter(is_different).count(),
            pairs,
        })
    }

    /// The mean error for an alignment.
    pub(super) fn mean(&self, alignment: usize) -> f64 {
        self.pairs.iter().map(|pair| pair.errors[alignment]).sum::<f64>() / self.pairs.len() as f64
    }

    /// The least value of [`Pair::determinant`], over pairs that are not mirrored.
    pub(super) fn least_determinant(&self, alignment: usize) -> f64 {
        let upright = self.pairs.iter().filter(|pair| !pair.is_mirrored(alignment));
        upright.map(|pair| pair.determinant(alignment)).fold(f64::INFINITY, f64::min)
    }

    /// The number of pairs with exactly one mirrored matrix.
    pub(super) fn mirrored(&self, alignment: usize) -> usize {
        self.pairs.iter().filter(|pair| pair.is_mirrored(alignment)).count()
    }

    /// The largest error of a pair with this alignment, relative to its error with the other alignment.
    pub(super) fn most_times(&self, alignment: usize) -> f64 {
        self.pairs.iter().map(|pair| pair.errors[alignment] / pair.errors[1 - alignment]).fold(0.0, f64::max)
    }

    /// The pair for which this alignment is worst compared with the other alignment. Its roughness halfway is at least
    /// `least_alpha`.
    pub(super) fn furthest_behind(&self, alignment: usize, least_alpha: f64) -> Option<&Pair> {
        let behind = |pair: &Pair| pair.errors[alignment] / pair.errors[1 - alignment];
        let rough = self.pairs.iter().filter(|pair| pair.at.roughness()[1] >= least_alpha);
        rough.max_by(|a, b| behind(a).total_cmp(&behind(b)))
    }
}

/// The index pairs of nodes that are neighbours along one axis.
fn neighbours(plan: &Plan) -> Vec<[usize; 2]> {
    let PerAxis { alpha, ratio, theta, phi } = plan.nodes().lengths();
    let axes = [(alpha, ratio * theta * phi), (ratio, theta * phi), (theta, phi), (phi, 1)];
    let all = 0..alpha * ratio * theta * phi;
    let along = |(count, stride): (usize, usize)| {
        all.clone().filter(move |index| index / stride % count + 1 < count).map(move |index| [index, index + stride])
    };
    axes.into_iter().flat_map(along).collect()
}

/// The configuration halfway between two nodes, in the texture coordinates of the layout.
fn between(layout: Layout, a: &PerAxis<f64>, b: &PerAxis<f64>) -> PerAxis<f64> {
    let mean = |a: f64, b: f64| 0.5 * (a + b);
    let middle = PerAxis {
        alpha: mean(a.alpha, b.alpha),
        ratio: mean(a.ratio, b.ratio),
        theta: mean(a.theta, b.theta),
        phi: mean(a.phi, b.phi),
    };
    if layout != Layout::Ltc2017 {
        return middle;
    }
    let roughness = mean(a.alpha.sqrt(), b.alpha.sqrt());
    let versine = |theta: f64| (1.0 - libm::cos(theta)).max(0.0).sqrt();
    let view = mean(versine(a.theta), versine(b.theta));
    PerAxis { alpha: roughness * roughness, theta: libm::acos(1.0 - view * view), ..middle }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SMALL: &str = r#"{"layout": "kt2022", "resolution": {"alpha": 2, "ratio": 2, "theta": 3, "phi": 3},
        "fit": {"samples": 64, "directions": 4, "steps": 20}}"#;

    /// `M R_z F` and `M` have the same product `M M^T`.
    #[test]
    fn alignments_have_equal_lobes_at_nodes_and_different_lobes_halfway() {
        let table = Halfway::of(SMALL).expect("fits");
        // The numbers of pairs along alpha, ratio, theta and phi.
        assert_eq!(table.pairs.len(), 18 + 18 + 24 + 24);
        assert!(table.different > 0 && table.different < 36, "{}", table.different);
        for Pair { nodes: [ours, nearest], errors, .. } in &table.pairs {
            for (a, b) in ours.iter().zip(nearest) {
                assert!((*a * a.transpose()).abs_diff_eq(*b * b.transpose(), 1e-9));
            }
            assert!(errors.iter().all(|error| error.is_finite() && *error > 0.0));
            assert!(ours != nearest || errors[OURS] == errors[NEAREST]);
        }
        for (alignment, other) in [(OURS, NEAREST), (NEAREST, OURS)] {
            let behind = table.furthest_behind(alignment, 0.0).expect("pairs");
            assert!(behind.errors[alignment] > behind.errors[other]);
            assert_eq!(table.most_times(alignment), behind.errors[alignment] / behind.errors[other]);
            let rough = table.furthest_behind(alignment, 0.3).expect("pairs");
            assert!(rough.at.roughness()[1] >= 0.3);
        }
        assert_eq!(table.mirrored(OURS), 0);
    }

    /// The mean of a matrix and its mirrored matrix is flat.
    #[test]
    fn mirrored_neighbours_are_found() {
        let at = PerAxis { alpha: 0.5, ratio: 1.0, theta: 0.3, phi: 0.0 };
        let flipped = DMat3::from_diagonal(glam::DVec3::new(1.0, -1.0, 1.0));
        let pair = Pair { at, nodes: [[DMat3::IDENTITY; 2], [DMat3::IDENTITY, flipped]], errors: [0.0; 2] };
        assert_eq!([OURS, NEAREST].map(|k| pair.is_mirrored(k)), [false, true]);
        assert_eq!([OURS, NEAREST].map(|k| pair.determinant(k).abs()), [1.0, 0.0]);
        let both = Pair { nodes: [[DMat3::IDENTITY; 2], [flipped; 2]], ..pair };
        assert_eq!([OURS, NEAREST].map(|k| both.determinant(k)), [1.0; 2]);
    }

    #[test]
    fn halfway_is_the_middle_between_texels() {
        let node = |alpha, theta| PerAxis { alpha, ratio: 1.0, theta, phi: 0.0 };
        let (first, second) = (node(0.04, 0.0), node(0.36, libm::acos(0.36)));
        let even = between(Layout::Kt2022, &first, &second);
        assert!((even.alpha - 0.2).abs() < 1e-12 && (even.theta - 0.5 * second.theta).abs() < 1e-12);
        // The square roots are 0.2 and 0.6, and 0 and 0.8.
        let warped = between(Layout::Ltc2017, &first, &second);
        assert!((warped.alpha - 0.16).abs() < 1e-12 && (libm::cos(warped.theta) - 0.84).abs() < 1e-12);
    }
}
