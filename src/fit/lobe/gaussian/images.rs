//! Samples of a Gaussian for a fit. They are images of fixed points under a map that changes continuously with the
//! shape of the Gaussian.

use std::f64::consts::TAU;

use glam::{DMat3, DVec3};

use super::{SphericalGaussian, horizon2};
use crate::math::{Lattice, exp, ln, sin_cos};

/// Sectors of the plane around the axis. Within a sector, the density of images does not depend on the angle.
const SECTORS: usize = 64;
/// The squared radius, in deviations, beyond which a Gaussian is zero in f64.
const NOTHING_BEYOND: f64 = 40.0;

/// A point of the unit square: a fraction of a turn around the axis, and a fraction of the ray's density, from the axis
/// outwards.
#[derive(Debug, Clone, Copy)]
struct Point {
    around: f64,
    outwards: f64,
    /// The image of the point for all Gaussians that the horizon does not cut: cosine and sine of the angle, and the
    /// radius.
    cos: f64,
    sin: f64,
    radius: f64,
}

/// Fixed points of the unit square. For each Gaussian, a map sends them to images that have the density of the Gaussian
/// above the horizon.
///
/// In the plane of deviations, a radius contains the fraction `1 - exp(-radius^2)` of a ray's density. If the fraction
/// `W` is above the horizon, the radius that contains the fraction `q` of `W` is `sqrt(-ln(1 - q W))`. The angle of the
/// ray inverts the cumulative sum of `W` over sectors, by linear interpolation.
#[derive(Debug)]
pub(crate) struct Images {
    points: Vec<Point>,
}

impl Images {
    /// The images of the points of a lattice.
    pub(crate) fn new(lattice: Lattice) -> Self {
        let point = |[around, outwards]: [f64; 2]| {
            let (sin, cos) = sin_cos(TAU * around);
            Point { around, outwards, cos, sin, radius: (-ln(1.0 - outwards)).sqrt() }
        };
        Self { points: lattice.points().map(point).collect() }
    }

    pub(crate) fn len(&self) -> usize {
        self.points.len()
    }

    /// The directions of all points, as offsets from +z in the frame to which `to_lobe` maps.
    pub(crate) fn offsets(&self, shape: &SphericalGaussian<f64>, to_lobe: &DMat3, offsets: &mut Vec<DVec3>) {
        let plane = Plane::of(shape);
        let axis = *to_lobe * DVec3::from(shape.axis);
        let offset = |d: DVec3| {
            let d2 = d.length_squared().min(4.0);
            let w = axis * (1.0 - 0.5 * d2) + *to_lobe * d * (1.0 - 0.25 * d2).sqrt();
            // This form avoids cancellation for directions near +z.
            DVec3::new(w.x, w.y, if w.z > 0.0 { -(w.x * w.x + w.y * w.y) / (1.0 + w.z) } else { w.z - 1.0 })
        };
        offsets.clear();
        match Sectors::of(&plane) {
            None => offsets.extend(self.points.iter().map(|p| offset(plane.ray(p.cos, p.sin) * p.radius))),
            Some(sectors) => offsets.extend(self.points.iter().map(|p| {
                let (sin, cos) = sin_cos(TAU * sectors.turn(p.around));
                let ray = plane.ray(cos, sin);
                let above = 1.0 - exp(-plane.horizon2(ray));
                offset(ray * (-ln(1.0 - p.outwards * above)).max(0.0).sqrt())
            })),
        }
    }
}

/// The plane of a Gaussian's equal-area projection.
struct Plane {
    height: f64,
    deviations: [DVec3; 2],
}

impl Plane {
    fn of(shape: &SphericalGaussian<f64>) -> Self {
        Self { height: shape.axis[2], deviations: shape.deviations().map(DVec3::from) }
    }

    /// The vector of one deviation at an angle.
    fn ray(&self, cos: f64, sin: f64) -> DVec3 {
        self.deviations[0] * cos + self.deviations[1] * sin
    }

    fn horizon2(&self, ray: DVec3) -> f64 {
        horizon2(self.height, ray.z, ray.length_squared())
    }
}

/// The cumulative distribution of the part above the horizon, at each edge between sectors.
struct Sectors {
    before: [f64; SECTORS + 1],
}

impl Sectors {
    /// `None` if the horizon cuts off nothing.
    fn of(plane: &Plane) -> Option<Self> {
        let edge = |k: usize| {
            let (sin, cos) = sin_cos(TAU * k as f64 / SECTORS as f64);
            plane.horizon2(plane.ray(cos, sin))
        };
        let radius2: [f64; SECTORS] = std::array::from_fn(edge);
        if radius2.iter().all(|radius2| *radius2 > NOTHING_BEYOND) {
            return None;
        }
        let above = radius2.map(|radius2| 1.0 - exp(-radius2));
        let mut before = [0.0; SECTORS + 1];
        for k in 0..SECTORS {
            before[k + 1] = before[k] + 0.5 * (above[k] + above[(k + 1) % SECTORS]);
        }
        let whole = 1.0 / before[SECTORS].max(f64::MIN_POSITIVE);
        Some(Self { before: before.map(|part| part * whole) })
    }

    /// The fraction of a turn at which the cumulative distribution is `part`.
    fn turn(&self, part: f64) -> f64 {
        let sector = self.before.partition_point(|before| *before <= part).clamp(1, SECTORS) - 1;
        let (from, to) = (self.before[sector], self.before[sector + 1]);
        let inside = if to > from { ((part - from) / (to - from)).clamp(0.0, 1.0) } else { 0.5 };
        (sector as f64 + inside) / SECTORS as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lobe::{LobeModel, gaussian::Gaussian};

    /// The report uses a different map. Both maps sample the same distribution, so the means of their samples agree.
    #[test]
    fn images_have_the_distribution_of_the_report_s_samples() {
        let frame = DMat3::from_rotation_x(0.4) * DMat3::from_rotation_y(0.3);
        for (x, y, z) in [
            ([0.02, 0.01, 0.0], [0.0, 0.05, 0.01], [0.3, 0.4, 0.8]),
            ([0.9, 0.1, 0.2], [-0.2, 0.5, 0.1], [0.7, -0.2, 0.4]),
            ([0.1, 0.0, 0.6], [0.1, 0.4, 0.0], [0.8, 0.3, 0.02]),
        ] {
            let shape = SphericalGaussian::of_columns(Gaussian::Asg, [x, y, z]);
            let lattice = Lattice::new(8192, [0.2, 0.6]);
            let mut offsets = Vec::new();
            Images::new(lattice).offsets(&shape, &frame.transpose(), &mut offsets);
            let images: Vec<DVec3> = offsets.iter().map(|offset| frame * (*offset + DVec3::Z)).collect();
            let row_major = [x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2]];
            let model = LobeModel::Asg.distribution(&row_major).expect("regular");
            let samples: Vec<DVec3> = lattice.points().map(|u| model.sample(u)).collect();
            assert!(images.iter().all(|w| (w.length() - 1.0).abs() < 1e-12 && w.z > -1e-9));
            for power in [1, 2, 3] {
                let mean = |of: &[DVec3]| {
                    of.iter().map(|w| DVec3::new(w.x.powi(power), w.y.powi(power), w.z.powi(power))).sum::<DVec3>()
                        / 8192.0
                };
                let (ours, theirs) = (mean(&images), mean(&samples));
                assert!((ours - theirs).length() < 5e-3, "{z:?} {power}: {ours} {theirs}");
            }
        }
    }
}
