//! The lobe to which an entry is fitted: weighted samples in its own frame, and quantities computed once from them.

use glam::{DMat2, DMat3, DVec2, DVec3};

use crate::{
    brdf::{Brdf, Mirrors},
    math::{SquarePoint, rotation_from_z},
};

/// Samples of the cosine-weighted lobe, normalised to a distribution.
///
/// Sample `i` is the direction `frame * (p_i + z)`. The offset `p` is small if the lobe is sharp, and therefore keeps
/// all its digits in f32. Its height is computed as `p.z = -(p.x^2 + p.y^2) / (1 + z)` instead of `z - 1`.
#[derive(Debug, Clone)]
pub(crate) struct Target {
    /// Rotation from the lobe's frame, whose +z is the mean direction, to the tangent frame.
    pub(crate) frame: DMat3,
    /// Symmetries of the lobe.
    pub(crate) mirrors: Mirrors,
    /// Offsets from the mean direction, in the lobe's frame.
    pub(crate) points: Vec<DVec3>,
    /// Weights, which add up to one.
    pub(crate) weights: Vec<f64>,
    /// Location and width of the lobe in the tangential plane.
    pub(crate) core: LobeCore,
    /// The number of drawn samples, including samples of zero weight.
    pub(crate) drawn: usize,
}

impl Target {
    /// Samples the lobe of `brdf` for `wo` at the given points.
    ///
    /// Domain: `wo.z > 0`. Some light is then reflected above the horizon.
    pub(crate) fn sample(brdf: &dyn Brdf, wo: DVec3, mirrors: Mirrors, points: &[SquarePoint]) -> Self {
        Drawn::of(brdf, wo, points).target(mirrors)
    }

    /// The same lobe, sampled at other points, in the same frame and with the same core.
    pub(crate) fn again(&self, brdf: &dyn Brdf, wo: DVec3, points: &[SquarePoint]) -> Self {
        Drawn::of(brdf, wo, points).in_frame(self.frame, self.mirrors, Some(self.core))
    }
}

/// Weighted directions of a lobe in the tangent frame.
struct Drawn {
    directions: Vec<DVec3>,
    weights: Vec<f64>,
    count: usize,
}

impl Drawn {
    fn of(brdf: &dyn Brdf, wo: DVec3, points: &[SquarePoint]) -> Self {
        let mut drawn = Vec::with_capacity(points.len());
        brdf.sample_all(wo, points, &mut drawn);
        let mut directions = Vec::with_capacity(points.len());
        let mut weights = Vec::with_capacity(points.len());
        for sample in &drawn {
            if sample.weight > 0.0 {
                directions.push(sample.wi);
                weights.push(sample.weight);
            }
        }
        Self { directions, weights, count: points.len() }
    }

    /// The target in the frame of its mean direction, which is above the horizon.
    fn target(self, mirrors: Mirrors) -> Target {
        let sum = self.directions.iter().zip(&self.weights).fold(DVec3::ZERO, |sum, (wi, weight)| sum + *weight * *wi);
        // The samples of a symmetric lobe are slightly asymmetric. Setting these components to zero makes the mean
        // direction symmetric.
        let axis = DVec3::new(if mirrors.x { 0.0 } else { sum.x }, if mirrors.y { 0.0 } else { sum.y }, sum.z);
        self.in_frame(rotation_from_z(axis.normalize()), mirrors, None)
    }

    /// The target in a given frame. If `core` is `None`, the core is computed from the target's own samples.
    fn in_frame(self, frame: DMat3, mirrors: Mirrors, core: Option<LobeCore>) -> Target {
        let Self { directions, mut weights, count } = self;
        let to_lobe = frame.transpose();
        let points: Vec<DVec3> = directions.iter().map(|wi| offset_from_z(to_lobe * *wi)).collect();
        let whole = 1.0 / weights.iter().sum::<f64>();
        for weight in &mut weights {
            *weight *= whole;
        }
        let core = core.unwrap_or_else(|| LobeCore::of(&points, &weights, mirrors));
        Target { frame, mirrors, points, weights, core, drawn: count }
    }
}

/// Location and scatter of a lobe's core in its tangential plane, by maximum likelihood for Student's t with two
/// degrees of freedom.
///
/// A sharp GGX lobe and a sharp LTC both have this distribution in the plane. For `M = diag(a, a, 1)`, the density of
/// `p` is proportional to `(1 + |p|^2 / a^2)^-2`, and the scatter is `a^2 / 2`. The variance is infinite, so moments
/// would measure how far the samples reach into the tails. The maximum likelihood estimate measures the lobe's width.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LobeCore {
    /// Centre.
    pub(crate) centre: DVec2,
    /// Scatter, positive definite.
    pub(crate) scatter: DMat2,
}

impl LobeCore {
    /// The number of samples for the estimate. Their sampling error is far smaller than the correction that the fit
    /// makes to the estimate.
    const SAMPLES: usize = 512;
    /// The number of reweightings. Each removes about half of the remaining error.
    const ROUNDS: usize = 12;
    /// The smallest scatter along any axis: the square of the smallest lobe width that f32 resolves at distance one.
    const LEAST: f64 = 1e-18;

    fn of(points: &[DVec3], weights: &[f64], mirrors: Mirrors) -> Self {
        let stride = points.len().div_ceil(Self::SAMPLES);
        let chosen = points.iter().step_by(stride).map(|p| p.truncate());
        let chosen: Vec<(DVec2, f64)> = chosen.zip(weights.iter().step_by(stride).copied()).collect();
        let total: f64 = chosen.iter().map(|(_, w)| w).sum();
        let mut core = Self { centre: DVec2::ZERO, scatter: DMat2::ZERO };
        for round in 0..=Self::ROUNDS {
            let inverse = if round == 0 { DMat2::ZERO } else { core.scatter.inverse() };
            let (mut weight_sum, mut sum, mut outer) = (0.0, DVec2::ZERO, DMat2::ZERO);
            for (p, w) in chosen.iter().copied() {
                let d = p - core.centre;
                // (nu + 2) / (nu + d^T S^-1 d) for nu = 2. The first round has no scatter and computes plain moments.
                let w = w * 4.0 / (2.0 + d.dot(inverse * d));
                weight_sum += w;
                sum += w * p;
                outer += DMat2::from_cols(d * (w * d.x), d * (w * d.y));
            }
            core.centre = sum / weight_sum;
            core.scatter = outer * (1.0 / total);
            if mirrors.x || mirrors.y {
                core.scatter.x_axis.y = 0.0;
                core.scatter.y_axis.x = 0.0;
            }
            core.scatter.x_axis.x += Self::LEAST;
            core.scatter.y_axis.y += Self::LEAST;
            core.centre =
                DVec2::new(if mirrors.x { 0.0 } else { core.centre.x }, if mirrors.y { 0.0 } else { core.centre.y });
        }
        core
    }

    /// Centre and width of the projections on a direction `d` in the lobe's frame.
    ///
    /// Perpendicular to the tangential plane, `p.z` is `-|p|^2 / 2` to leading order. Median and spread of `|p|^2 / 2`
    /// are half the trace of the scatter.
    pub(crate) fn project(&self, d: DVec3) -> (f64, f64) {
        let half_trace = 0.5 * (self.scatter.x_axis.x + self.scatter.y_axis.y);
        let tangential = d.truncate();
        let variance = tangential.dot(self.scatter * tangential) + d.z * d.z * half_trace * half_trace;
        (tangential.dot(self.centre) - d.z * half_trace, variance.sqrt())
    }
}

/// `direction - z` for a unit vector, without cancellation for directions close to z.
fn offset_from_z(direction: DVec3) -> DVec3 {
    let DVec3 { x, y, z } = direction;
    DVec3::new(x, y, if z > 0.0 { -(x * x + y * y) / (1.0 + z) } else { z - 1.0 })
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::{brdf::BrdfSample, lobe::ltc::Ltc, math::Lattice};

    /// A surface whose lobe for every view is the LTC of a matrix. Almost all of the LTC is above the horizon.
    pub(crate) struct PlantedBrdf(Ltc);

    impl PlantedBrdf {
        pub(crate) fn new(matrix: DMat3) -> Self {
            Self(Ltc::new(matrix).expect("a regular matrix"))
        }

        pub(crate) fn matrix(&self) -> DMat3 {
            self.0.matrix()
        }
    }

    impl Brdf for PlantedBrdf {
        fn eval_cos(&self, _: DVec3, wi: DVec3) -> f64 {
            self.0.pdf(wi)
        }

        fn sample(&self, _: DVec3, u: [f64; 2]) -> BrdfSample {
            BrdfSample { wi: self.0.sample(u), weight: 1.0, cos_theta_d: 1.0 }
        }

        fn pdf(&self, _: DVec3, wi: DVec3) -> f64 {
            self.0.pdf(wi)
        }
    }

    /// The target of a lobe that is the LTC of `matrix`. A fit should find this matrix again.
    pub(crate) fn planted(matrix: DMat3, mirrors: Mirrors) -> Target {
        let ltc = Ltc::new(matrix).expect("a regular matrix");
        let n = 8192;
        let directions: Vec<DVec3> = Lattice::new(n, [0.37, 0.81]).points().map(|u| ltc.sample(u)).collect();
        Drawn { directions, weights: vec![1.0; n], count: n }.target(mirrors)
    }

    /// The target of a lobe of these directions.
    pub(crate) fn planted_directions(directions: Vec<DVec3>, mirrors: Mirrors) -> Target {
        let (count, weights) = (directions.len(), vec![1.0; directions.len()]);
        Drawn { directions, weights, count }.target(mirrors)
    }

    const NO_MIRRORS: Mirrors = Mirrors { x: false, y: false };

    #[test]
    fn the_core_of_a_sharp_lobe_is_half_its_matrix_squared() {
        for a in [1e-6, 1e-3, 1e-2] {
            let core = planted(DMat3::from_diagonal(DVec3::new(a, 0.5 * a, 1.0)), NO_MIRRORS).core;
            let expected = 0.5 * a * a;
            assert!((core.scatter.x_axis.x / expected - 1.0).abs() < 0.1, "{a}: {core:?}");
            assert!((core.scatter.y_axis.y / (0.25 * expected) - 1.0).abs() < 0.1, "{a}: {core:?}");
            assert!(core.centre.length() < 0.05 * a, "{a}: {core:?}");
        }
    }

    #[test]
    fn offsets_keep_their_digits_near_the_axis() {
        let tiny = DVec3::new(1e-9, 0.0, 1.0);
        assert_eq!(offset_from_z(tiny).z, -5e-19);
        let away = DVec3::new(0.6, 0.0, -0.8);
        assert!((offset_from_z(away) + DVec3::Z - away).length() < 1e-15);
    }

    #[test]
    fn a_mirror_puts_the_axis_into_its_plane_exactly() {
        let matrix = DMat3::from_cols(DVec3::new(0.3, 0.0, 0.1), DVec3::new(0.0, 0.2, 0.0), DVec3::new(-0.5, 0.0, 0.8));
        let target = planted(matrix, Mirrors { x: false, y: true });
        assert_eq!(target.frame.z_axis.y, 0.0);
        assert_eq!(target.core.scatter.x_axis.y, 0.0);
    }
}
