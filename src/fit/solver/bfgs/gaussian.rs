//! Fits the Gaussian of one lobe with BFGS.
//!
//! The variables are the same as for an LTC, without the slope. They form the columns of
//! [`SphericalGaussian::of_columns`]. In the lobe's frame, with `C^2` and `c` the block and the centre of an initial
//! guess,
//!
//! ```text
//! [x y] = C (I + A) C,    z = (c + C^2 a, 1)      A symmetric, for a round Gaussian a multiple of I
//! ```
//!
//! The axis stays above the horizon. If a step would move it below, its height decreases exponentially instead.
//!
//! The metric supplies the gradient with respect to directions. The derivatives of directions with respect to the
//! variables are finite differences with fixed steps. The map from variables to directions is smooth, so the
//! differences lose few digits and contain no noise of the metric.

use glam::{DMat2, DMat3, DVec2, DVec3};

use super::{
    guess::Guess,
    minimise::{InverseHessian, StopRule, VARIABLES, Vector, minimise},
    search::{AREA_COST, COARSE_DECREASE, free_variables},
};
use crate::{
    lobe::gaussian::{Gaussian, Images, SphericalGaussian},
    math::{exp, ln, symmetric_sqrt},
    metric::{Grain, ImageLoss, Offsets, Target},
    stop_check::StopCheck,
};

/// The squared deviation divided by the scatter of the lobe's core. The tails of GGX widen the best Gaussian.
const DEVIATION2_OVER_SCATTER: f64 = 5.0;
/// Step of the finite differences. All variables are of order one; see [`super`].
const STEP: f64 = 1e-5;
/// Cost of deviations of length one, in units of the lobe's width. The cost grows with the fourth power of the length.
/// Without it, the Gaussian of a lobe that is nearly uniform over the hemisphere would be infinitely wide. The cost
/// hardly changes the Gaussians of other lobes.
const BREADTH_COST: f64 = 1e-4;
/// Work of an image, in units of a projection of a sample on a direction.
const IMAGE_WORK: usize = 20;
/// Seconds for one image of a Gaussian that the horizon cuts, which is the common case.
const IMAGE_SECONDS: f64 = 120e-9;

/// Seconds of an evaluation for each sample, in addition to the metric: one image, and one more for each free variable.
pub(super) fn image_seconds(gaussian: Gaussian) -> f64 {
    IMAGE_SECONDS
        * match gaussian {
            Gaussian::Sg => 4.0,
            Gaussian::Asg => 6.0,
        }
}

/// A lobe's frame and the guess to which the variables are relative.
struct Family<'a> {
    gaussian: Gaussian,
    guess: Guess,
    target: &'a Target,
}

impl<'a> Family<'a> {
    fn of(gaussian: Gaussian, target: &'a Target) -> Self {
        let block = symmetric_sqrt(target.core.scatter * DEVIATION2_OVER_SCATTER);
        let block = match gaussian {
            Gaussian::Asg => block,
            Gaussian::Sg => DMat2::IDENTITY * block.determinant().sqrt(),
        };
        Self { gaussian, guess: Guess { root: symmetric_sqrt(block), centre: target.core.centre }, target }
    }

    /// `I + A`, and `a`.
    fn parts(&self, v: &Vector) -> (DMat2, DVec2) {
        let [xx, xy, yy, ax, ay, ..] = *v;
        let shape = match self.gaussian {
            Gaussian::Asg => DMat2::from_cols(DVec2::new(1.0 + xx, xy), DVec2::new(xy, 1.0 + yy)),
            Gaussian::Sg => DMat2::IDENTITY * (1.0 + xx),
        };
        (shape, DVec2::new(ax, ay))
    }

    /// The Gaussian of the variables. Domain: a positive definite shape.
    fn shape(&self, v: &Vector) -> SphericalGaussian<f64> {
        let (shape, shift) = self.parts(v);
        let Guess { root, centre } = self.guess;
        let block = root * shape * root;
        let frame = self.target.frame;
        let middle = frame * centre.extend(1.0);
        let moved = frame * (root * (root * shift)).extend(0.0);
        let mut z = middle + moved;
        if moved.z < 0.0 {
            z.z = middle.z * exp(moved.z / middle.z);
        }
        let columns = [frame * block.x_axis.extend(0.0), frame * block.y_axis.extend(0.0), z];
        SphericalGaussian::along_first(self.gaussian, columns.map(|column| column.to_array()))
    }

    fn free(&self) -> [bool; VARIABLES] {
        let [xx, xy, yy, ax, ay, ..] = free_variables(self.target.mirrors);
        match self.gaussian {
            Gaussian::Asg => [xx, xy, yy, ax, ay, false, false],
            Gaussian::Sg => [xx, false, false, ax, ay, false, false],
        }
    }

    /// The cost that keeps the Gaussian regular: `BREADTH_COST (|d1|^2 + |d2|^2)^2 - AREA_COST ln det(I + A)`.
    fn cost(&self, v: &Vector, shape: &SphericalGaussian<f64>) -> f64 {
        let [first, second] = shape.deviations().map(DVec3::from);
        let breadth = first.length_squared() + second.length_squared();
        BREADTH_COST * breadth * breadth - AREA_COST * ln(self.parts(v).0.determinant())
    }
}

/// The loss as a function of the variables, with coarse or full samples.
struct Search<'a, 'b> {
    family: &'a Family<'a>,
    loss: &'b mut dyn ImageLoss,
    inv_spread: f64,
    grain: Grain,
    images: Images,
    to_lobe: DMat3,
    /// The images of the points under the Gaussian. `moved` has the images under a slightly different Gaussian.
    base: Vec<DVec3>,
    moved: Vec<DVec3>,
}

impl<'a, 'b> Search<'a, 'b> {
    fn new(family: &'a Family<'a>, loss: &'b mut dyn ImageLoss, spread: f64, grain: Grain) -> Self {
        let images = Images::new(loss.lattice(grain));
        let to_lobe = family.target.frame.transpose();
        let inv_spread = 1.0 / spread;
        Self { family, loss, inv_spread, grain, images, to_lobe, base: Vec::new(), moved: Vec::new() }
    }

    /// Loss plus cost, and their gradient with respect to the free variables. The gradient of the loss with respect to
    /// directions is exact; the derivatives of directions are finite differences. `None` if `stop_check` stops the
    /// search.
    fn at(&mut self, v: &Vector, stop_check: &mut StopCheck) -> Option<(f64, Vector)> {
        let Self { family, loss, inv_spread, grain, images, to_lobe, base, moved } = self;
        let (block, _) = family.parts(v);
        if block.determinant() <= 0.0 || block.x_axis.x <= 0.0 {
            return Some((f64::INFINITY, [0.0; VARIABLES]));
        }
        let shape = family.shape(v);
        stop_check.worked(IMAGE_WORK * images.len())?;
        images.offsets(&shape, to_lobe, base);
        let (value, slopes) = loss.slopes(&in_arrays(base), *grain, stop_check)?;
        let cost = family.cost(v, &shape);
        let (mut gradient, free) = ([0.0; VARIABLES], family.free());
        for (k, slope) in gradient.iter_mut().enumerate().filter(|(k, _)| free[*k]) {
            let mut beside = *v;
            beside[k] += STEP;
            let beside_shape = family.shape(&beside);
            stop_check.worked(IMAGE_WORK * images.len())?;
            images.offsets(&beside_shape, to_lobe, moved);
            let by_directions = pulled(&slopes, base, moved) * *inv_spread;
            *slope = (by_directions + (family.cost(&beside, &beside_shape) - cost)) / STEP;
        }
        Some((value * *inv_spread + cost, gradient))
    }
}

/// The columns of the Gaussian with the lowest loss, in the tangent frame; `None` if `stop_check` stops the search.
pub(super) fn solve(
    gaussian: Gaussian,
    (loss, spread): (&mut dyn ImageLoss, f64),
    target: &Target,
    stop: StopRule,
    stop_check: &mut StopCheck,
) -> Option<DMat3> {
    let family = Family::of(gaussian, target);
    let (free, curvature) = (family.free(), [1.0; VARIABLES]);
    let mut hessian = InverseHessian::diagonal(&curvature);
    let mut lowest = [0.0; VARIABLES];
    for (grain, relative_decrease) in [(Grain::Coarse, COARSE_DECREASE), (Grain::Full, stop.relative_decrease)] {
        let stop = StopRule { relative_decrease, ..stop };
        let mut search = Search::new(&family, loss, spread, grain);
        lowest = minimise(lowest, &curvature, &mut hessian, free, stop, |v| search.at(v, stop_check))?;
    }
    let shape = family.shape(&lowest);
    let [x, y] = shape.deviations().map(DVec3::from);
    Some(DMat3::from_cols(x, y, shape.axis.into()))
}

/// Directions in f32, with one array for each coordinate, as the metric needs them.
pub(crate) fn in_arrays(offsets: &[DVec3]) -> Offsets {
    [|o: &DVec3| o.x, |o: &DVec3| o.y, |o: &DVec3| o.z].map(|of| offsets.iter().map(|o| of(o) as f32).collect())
}

/// The first-order change of the distance if directions move from `base` to `moved`.
fn pulled([x, y, z]: &Offsets, base: &[DVec3], moved: &[DVec3]) -> f64 {
    let slopes = x.iter().zip(y).zip(z).map(|((x, y), z)| DVec3::new(f64::from(*x), f64::from(*y), f64::from(*z)));
    slopes.zip(base).zip(moved).map(|((slope, base), moved)| slope.dot(*moved - *base)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        brdf::{Ggx, Mirrors},
        lobe::LobeModel,
        math::{Lattice, direction, row_major},
        metric::{Lobe, Metric, Samples, planted_directions},
        stop_check::unstopped,
    };

    const NO_MIRRORS: Mirrors = Mirrors { x: false, y: false };

    fn fitted(gaussian: Gaussian, target: &Target) -> DMat3 {
        let mut distance = Metric::Sw1.rules().distance(&Samples { count: 1024, directions: 24, shift: [0.0; 2] });
        let mut go_on = unstopped;
        let mut stop_check = StopCheck::new(&mut go_on);
        // This metric compares only samples, so the surface does not matter.
        let lobe = Lobe { brdf: &Ggx { alpha_x: 0.5, alpha_y: 0.5 }, wo: DVec3::Z, target };
        let mut loss = distance.to(&lobe, &mut stop_check).expect("nothing stops it");
        let spread = loss.spread();
        let images = loss.images().expect("sw1 compares images");
        let stop = StopRule { steps: 60, relative_decrease: 1e-5 };
        solve(gaussian, (images, spread), target, stop, &mut stop_check).expect("nothing stops it")
    }

    /// A lobe that is a Gaussian cut at the horizon.
    fn planted(model: LobeModel, m: &DMat3, mirrors: Mirrors) -> Target {
        let model = model.distribution(&row_major(m)).expect("a regular matrix");
        planted_directions(Lattice::new(8192, [0.3, 0.8]).points().map(|u| model.sample(u)).collect(), mirrors)
    }

    /// A search also succeeds with a slightly wrong gradient, so this test compares the gradient with differences of
    /// the loss.
    #[test]
    fn the_gradient_is_that_of_central_differences() {
        const STEP: f64 = 1e-3;
        let m = DMat3::from_cols(DVec3::X * 0.7, DVec3::Y * 0.5, direction(0.6, 0.4));
        let target = planted(LobeModel::Ltc, &m, NO_MIRRORS);
        let mut distance = Metric::Sw1.rules().distance(&Samples { count: 2048, directions: 32, shift: [0.0; 2] });
        let mut go_on = unstopped;
        let mut stop_check = StopCheck::new(&mut go_on);
        let lobe = Lobe { brdf: &Ggx { alpha_x: 0.5, alpha_y: 0.5 }, wo: DVec3::Z, target: &target };
        let mut loss = distance.to(&lobe, &mut stop_check).expect("nothing stops it");
        let spread = loss.spread();
        let images = loss.images().expect("sw1 compares images");
        for gaussian in [Gaussian::Sg, Gaussian::Asg] {
            let family = Family::of(gaussian, &target);
            let mut search = Search::new(&family, images, spread, Grain::Full);
            let mut at = |v: &Vector| search.at(v, &mut stop_check).expect("nothing stops it");
            let v = [0.3, 0.2, -0.2, 0.3, -0.25, 0.0, 0.0];
            let (_, gradient) = at(&v);
            for k in (0..VARIABLES).filter(|k| family.free()[*k]) {
                let [below, above] = [-STEP, STEP].map(|step| {
                    let mut beside = v;
                    beside[k] += step;
                    at(&beside).0
                });
                let difference = (above - below) / (2.0 * STEP);
                assert!(difference.abs() > 0.05, "number {k} of {gaussian} does not matter: {difference}");
                assert!(
                    (gradient[k] - difference).abs() < 0.02 * difference.abs(),
                    "{k}: {} {difference}",
                    gradient[k]
                );
            }
        }
    }

    #[test]
    fn a_planted_gaussian_is_found_again() {
        let cases = [
            (1e-3, 5e-4, direction(0.5, 0.3)),
            (0.2, 0.05, direction(1.2, 2.0)),
            (0.5, 0.3, direction(1.0, 1.0)),
            (0.5, 0.5, direction(1.5, 0.7)),
        ];
        for (a, b, axis) in cases {
            let (x, y) = axis.any_orthonormal_pair();
            let m = DMat3::from_cols(x * a, y * b, axis);
            let found = fitted(Gaussian::Asg, &planted(LobeModel::Asg, &m, NO_MIRRORS));
            assert!((found.z_axis - axis).length() < 0.05 * a, "{a} {b}: {} not {axis}", found.z_axis);
            // The square of the block does not depend on a turn of the deviations in their plane.
            let square = |m: DMat3| {
                [[x, x], [x, y], [y, y]]
                    .map(|[u, v]| m.x_axis.dot(u) * m.x_axis.dot(v) + m.y_axis.dot(u) * m.y_axis.dot(v))
            };
            let (found, wanted) = (square(found), square(m));
            let off = found.iter().zip(wanted).map(|(f, w)| (f - w).abs()).fold(0.0, f64::max);
            assert!(off < 0.06 * a * a, "{a} {b}: {found:?}, not {wanted:?}");
        }
    }

    #[test]
    fn a_round_gaussian_is_round_and_found_again() {
        for (a, axis) in [(1e-3, direction(0.5, 0.3)), (0.4, direction(1.1, 2.0))] {
            let (x, y) = axis.any_orthonormal_pair();
            let found =
                fitted(Gaussian::Sg, &planted(LobeModel::Sg, &DMat3::from_cols(x * a, y * a, axis), NO_MIRRORS));
            let [u, v] = [found.x_axis.length(), found.y_axis.length()];
            assert!((u - v).abs() < 1e-9 * u && found.x_axis.dot(found.y_axis).abs() < 1e-9 * u * u, "{found}");
            assert!((u / a - 1.0).abs() < 0.03 && (found.z_axis - axis).length() < 0.03 * a, "{a}: {found}");
        }
    }

    #[test]
    fn a_mirror_keeps_the_axis_in_its_plane() {
        let axis = direction(1.0, 0.0);
        let m = DMat3::from_cols(DVec3::Y.cross(axis) * 0.3, DVec3::Y * 0.2, axis);
        let target = planted(LobeModel::Asg, &m, Mirrors { x: false, y: true });
        let found = fitted(Gaussian::Asg, &target);
        assert_eq!(found.z_axis.y, 0.0);
    }
}
