//! Fits the matrix of one lobe with BFGS.
//!
//! In the lobe's frame, with `C^2` and `c` the block and the centre of an initial guess, seven variables form
//!
//! ```text
//!     | 1  0  0 |   | C (I + A) C   c + C^2 a |
//! M = | 0  1  0 | * |                         |      A symmetric
//!     | lx ly 1 |   |   0    0          1     |
//! ```
//!
//! The symmetry of the block removes the rotation about z, which leaves a clamped cosine unchanged. The 1 in the corner
//! removes the scale. All seven variables are of order one for every lobe, including sharp and thin lobes. `A` changes
//! the lobe's axes, and `a` moves the lobe, in units of its width. `l` is the slope of the plane of the first two
//! columns, which is zero in the limit of a mirror. If the lobe has a mirror symmetry, the variables that would break
//! it are not free.

use glam::{DMat2, DMat3, DVec2, DVec3};

mod gaussian;
mod guess;
mod minimise;
mod search;

pub(crate) use gaussian::in_arrays;
pub(crate) use guess::Guess;

use self::{
    minimise::{InverseHessian, StopRule, VARIABLES, Vector, minimise},
    search::{AREA_COST, COARSE_DECREASE, free_variables},
};
use super::objective::{Effort, Objective, SolverRules};
use crate::{
    brdf::Mirrors,
    lobe::LobeModel,
    math::ln,
    metric::{Grain, Loss},
    stop_check::StopCheck,
};

/// BFGS stops when two steps in a row reduce the loss by less than this fraction. This takes about 7 full evaluations.
/// With a tenth of this limit, a table's error is only 0.1 % smaller.
const RELATIVE_DECREASE: f64 = 1e-3;
/// Evaluations until BFGS has converged, including coarse evaluations. Eight coarse evaluations count as one.
const EVALUATIONS: u32 = 9;
/// The element of [`curvature`] for the slope, in units of the lobe's width.
const SLOPE_CURVATURE: f64 = 8.0;

/// The approximate diagonal of the inverse Hessian. The first five variables are of order one for every lobe. The slope
/// has less effect on sharper lobes, and must not follow the samples' noise.
fn curvature(spread: f64) -> Vector {
    let slope = SLOPE_CURVATURE * spread;
    [1.0, 1.0, 1.0, 1.0, 1.0, slope, slope]
}

/// BFGS as an item of [`super::Solver`].
pub(super) struct Bfgs;

impl SolverRules for Bfgs {
    fn solve(&self, objective: Objective<'_>, stop_check: &mut StopCheck) -> Option<DMat3> {
        let stop = StopRule { steps: objective.effort.steps, relative_decrease: RELATIVE_DECREASE };
        let target = objective.target;
        if let Some(gaussian) = objective.model.gaussian() {
            let spread = objective.loss.spread();
            // Recipes allow a Gaussian only with a metric that compares images.
            return gaussian::solve(gaussian, (objective.loss.images()?, spread), target, stop, stop_check);
        }
        let guess = Guess::of(&target.core);
        refine(objective.loss, &guess, target.mirrors, stop, stop_check).map(|matrix| target.frame * matrix)
    }

    fn seconds(&self, lobe: LobeModel, effort: &Effort) -> f64 {
        let evaluation = effort.metric.rules().seconds(effort.samples, effort.directions);
        let images = lobe.gaussian().map_or(0.0, |gaussian| gaussian::image_seconds(gaussian) * effort.samples as f64);
        f64::from(effort.steps.min(EVALUATIONS)) * (evaluation + images)
    }
}

/// Cost of a slope of one, in units of the lobe's width. The slope hardly changes a sharp lobe, and without this cost
/// the samples' noise would determine it. The cost hardly changes the fit of a broad lobe.
const SLOPE_COST: f64 = 1e-4;

/// The seven variables as matrices.
struct SearchMatrices {
    /// `I + A`.
    shape: DMat2,
    /// `a`.
    shift: DVec2,
    /// `l`.
    slope: DVec2,
}

impl SearchMatrices {
    fn of(v: &Vector) -> Self {
        let [xx, xy, yy, ax, ay, lx, ly] = *v;
        Self {
            shape: DMat2::from_cols(DVec2::new(1.0 + xx, xy), DVec2::new(xy, 1.0 + yy)),
            shift: DVec2::new(ax, ay),
            slope: DVec2::new(lx, ly),
        }
    }

    /// `M` without its slope.
    fn flat(&self, guess: &Guess) -> DMat3 {
        let block = guess.root * self.shape * guess.root;
        let centre = guess.centre + guess.root * (guess.root * self.shift);
        DMat3::from_cols(block.x_axis.extend(0.0), block.y_axis.extend(0.0), centre.extend(1.0))
    }

    /// Applies the slope to a flat matrix.
    fn tilted(&self, mut flat: DMat3) -> DMat3 {
        for column in [&mut flat.x_axis, &mut flat.y_axis, &mut flat.z_axis] {
            column.z += self.slope.dot(column.truncate());
        }
        flat
    }

    /// Converts the gradient with respect to the elements of `M` to the gradient with respect to the seven variables.
    fn pull_back(&self, guess: &Guess, flat: &DMat3, by_m: &DMat3) -> Vector {
        let by_slope = by_m.x_axis.z * flat.x_axis.truncate()
            + by_m.y_axis.z * flat.y_axis.truncate()
            + by_m.z_axis.z * flat.z_axis.truncate();
        // Through the slope, an element of the flat matrix also changes the third row in its column.
        let by_flat = |column: DVec3| column.truncate() + self.slope * column.z;
        let by_block = DMat2::from_cols(by_flat(by_m.x_axis), by_flat(by_m.y_axis));
        let by_shape = guess.root * by_block * guess.root;
        let by_shift = guess.root * (guess.root * by_flat(by_m.z_axis));
        let by_xy = by_shape.x_axis.y + by_shape.y_axis.x;
        [by_shape.x_axis.x, by_xy, by_shape.y_axis.y, by_shift.x, by_shift.y, by_slope.x, by_slope.y]
    }

    /// The cost that keeps `M` regular, `SLOPE_COST |l|^2 - AREA_COST ln det(I + A)`, and its gradient.
    fn cost(&self) -> (f64, Vector) {
        let area = self.shape.determinant();
        let by_area = AREA_COST / area;
        let (xx, xy, yy) = (self.shape.x_axis.x, self.shape.x_axis.y, self.shape.y_axis.y);
        let by_slope = 2.0 * SLOPE_COST * self.slope;
        let cost = SLOPE_COST * self.slope.length_squared() - AREA_COST * ln(area);
        (cost, [-by_area * yy, 2.0 * by_area * xy, -by_area * xx, 0.0, 0.0, by_slope.x, by_slope.y])
    }
}

/// The matrix near `guess` with the lowest loss, from cosine space to the lobe's frame; `None` if `stop_check` stops
/// the search.
fn refine(
    loss: &mut dyn Loss,
    guess: &Guess,
    mirrors: Mirrors,
    stop: StopRule,
    stop_check: &mut StopCheck,
) -> Option<DMat3> {
    // The loss is in units of the lobe's width, so the same step lengths suit sharp and broad lobes.
    let inv_spread = 1.0 / loss.spread();
    let mut lowest = [0.0; VARIABLES];
    let curvature = curvature(loss.spread());
    let mut hessian = InverseHessian::diagonal(&curvature);
    for (grain, relative_decrease) in [(Grain::Coarse, COARSE_DECREASE), (Grain::Full, stop.relative_decrease)] {
        let stop = StopRule { relative_decrease, ..stop };
        lowest = minimise(lowest, &curvature, &mut hessian, free_variables(mirrors), stop, |v| {
            let parts = SearchMatrices::of(v);
            // The search is limited to matrices with a positive determinant. A mirrored `M` has the same distribution
            // as one of these matrices, and a singular `M` has no distribution.
            if parts.shape.determinant() <= 0.0 || parts.shape.x_axis.x <= 0.0 {
                return Some((f64::INFINITY, [0.0; VARIABLES]));
            }
            let flat = parts.flat(guess);
            let (value, by_m) = loss.value_and_gradient(&parts.tilted(flat), grain, stop_check)?;
            let mut gradient = parts.pull_back(guess, &flat, &(by_m * inv_spread));
            let (cost, by_cost) = parts.cost();
            gradient.iter_mut().zip(by_cost).for_each(|(slope, cost)| *slope += cost);
            Some((value * inv_spread + cost, gradient))
        })?;
    }
    let parts = SearchMatrices::of(&lowest);
    Some(parts.tilted(parts.flat(guess)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        lobe::ltc::align,
        metric::{Lobe, Metric, PlantedBrdf, Samples, planted},
        stop_check::unstopped,
    };

    const STOP: StopRule = StopRule { steps: 100, relative_decrease: 1e-6 };

    fn fitted(metric: Metric, matrix: DMat3, mirrors: Mirrors) -> DMat3 {
        let target = planted(matrix, mirrors);
        let mut distance = metric.rules().distance(&Samples { count: 2048, directions: 24, shift: [0.0; 2] });
        let guess = Guess::of(&target.core);
        let mut go_on = unstopped;
        let mut stop_check = StopCheck::new(&mut go_on);
        let surface = PlantedBrdf::new(matrix);
        let lobe = Lobe { brdf: &surface, wo: DVec3::Z, target: &target };
        let mut loss = distance.to(&lobe, &mut stop_check).expect("nothing stops it");
        let found = refine(&mut *loss, &guess, mirrors, STOP, &mut stop_check);
        target.frame * found.expect("nothing stops it")
    }

    /// A canonical matrix that does not depend on scale and alignment.
    fn canonical(m: DMat3, mirrors: Mirrors) -> DMat3 {
        let aligned = align(&m, mirrors, 1e-9);
        aligned * (1.0 / aligned.z_axis.length())
    }

    #[test]
    fn a_planted_matrix_is_recovered_up_to_its_invariances() {
        let cases = [
            (DVec3::new(0.5, 0.1, 0.2), DVec3::new(-0.1, 0.3, 0.1), DVec3::new(-0.6, 0.2, 0.8)),
            (DVec3::new(0.05, 0.0, 0.02), DVec3::new(0.01, 0.02, 0.0), DVec3::new(-0.7, -0.5, 0.4)),
            // A sharp lobe. A tilt would have no effect, so the planted matrix has a tilt of zero.
            (DVec3::new(8e-4, 0.0, -6e-4), DVec3::new(0.0, 2e-4, 0.0), DVec3::new(0.6, 0.0, 0.8)),
        ];
        for (x, y, z) in cases {
            let (planted, mirrors) = (DMat3::from_cols(x, y, z), Mirrors { x: false, y: false });
            let (wanted, found) =
                (canonical(planted, mirrors), canonical(fitted(Metric::Sw1, planted, mirrors), mirrors));
            // Each column is within 3 % of the lobe's width.
            let width = wanted.x_axis.length().max(wanted.y_axis.length());
            assert!(found.abs_diff_eq(wanted, 0.03 * width), "{wanted}\n{found}");
        }
    }

    /// Uses a lobe entirely above the horizon, because metrics that compare densities ignore the part below.
    #[test]
    fn a_planted_matrix_is_recovered_by_every_metric() {
        let (x, y, z) = (DVec3::new(0.2, 0.02, 0.06), DVec3::new(-0.03, 0.1, 0.0), DVec3::new(-0.3, 0.1, 0.95));
        let (planted, mirrors) = (DMat3::from_cols(x, y, z), Mirrors { x: false, y: false });
        let wanted = canonical(planted, mirrors);
        for &metric in Metric::ALL {
            let found = canonical(fitted(metric, planted, mirrors), mirrors);
            assert!(found.abs_diff_eq(wanted, 0.01), "{metric} {wanted}\n{found}");
        }
    }

    #[test]
    fn mirrored_lobes_have_exact_zeros() {
        let planted =
            DMat3::from_cols(DVec3::new(0.4, 0.0, 0.1), DVec3::new(0.0, 0.2, 0.0), DVec3::new(-0.5, 0.0, 0.8));
        let found = fitted(Metric::Sw1, planted, Mirrors { x: false, y: true });
        assert_eq!([found.x_axis.y, found.y_axis.x, found.y_axis.z, found.z_axis.y], [0.0; 4]);
    }

    #[test]
    fn symmetric_lobes_have_four_or_two_free_numbers() {
        let count = |x, y| free_variables(Mirrors { x, y }).into_iter().filter(|free| *free).count();
        assert_eq!([count(false, false), count(true, false), count(false, true), count(true, true)], [7, 4, 4, 2]);
    }
}
