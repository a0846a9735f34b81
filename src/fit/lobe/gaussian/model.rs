//! Gaussians as lobe models.

use std::f64::consts::TAU;

use glam::{DMat3, DVec3};

use super::{Gaussian, SphericalGaussian, above_horizon, covered, horizon2};
use crate::{
    lobe::{
        ltc::Sides,
        rules::{LobeDistribution, LobeModelRules},
    },
    math::{exp, from_row_major, ln, sin_cos},
};

/// Gaussians as items of [`crate::LobeModel`]. The nine numbers are the matrix of [`SphericalGaussian::of_columns`],
/// row-major.
pub(in crate::lobe) struct GaussianLobeModel(Gaussian);

/// The round Gaussian.
pub(in crate::lobe) const SG: GaussianLobeModel = GaussianLobeModel(Gaussian::Sg);
/// The stretched Gaussian.
pub(in crate::lobe) const ASG: GaussianLobeModel = GaussianLobeModel(Gaussian::Asg);

impl LobeModelRules for GaussianLobeModel {
    fn distribution(&self, numbers: &[f64; 9]) -> Option<Box<dyn LobeDistribution>> {
        let m = from_row_major(numbers);
        let determinant = m.determinant();
        let regular = determinant != 0.0 && determinant.is_finite();
        let columns = [m.x_axis, m.y_axis, m.z_axis].map(|v| v.to_array());
        regular.then(|| Box::new(AboveHorizon::of(self.0, columns)) as Box<dyn LobeDistribution>)
    }

    fn gaussian(&self) -> Option<Gaussian> {
        Some(self.0)
    }

    fn error_over_ltc(&self) -> f64 {
        match self.0 {
            Gaussian::Sg => 5.2,
            Gaussian::Asg => 3.2,
        }
    }

    /// A round Gaussian depends only on its axis and its area, so many pairs of deviations represent it. This function
    /// returns the scaled deviations of the reflection, which change with roughness and view like the reflection.
    /// Relative to the long and thin reflection of a grazing view, deviations of equal length would grow without bound.
    fn relative_to(&self, reflection: &DMat3, matrix: &DMat3) -> DMat3 {
        let columns = |m: &DMat3| [m.x_axis, m.y_axis, m.z_axis].map(|column| column.to_array());
        let area = |shape: &SphericalGaussian<f64>| shape.peak();
        let own = SphericalGaussian::along_first(self.0, columns(matrix));
        let with_axis = DMat3::from_cols(reflection.x_axis, reflection.y_axis, own.axis.into());
        if self.0 == Gaussian::Asg || with_axis.determinant() <= 0.0 {
            return *matrix;
        }
        let reflected = SphericalGaussian::of_columns(Gaussian::Asg, columns(&with_axis));
        let scale = (area(&reflected) / area(&own)).sqrt();
        let [x, y] = reflected.deviations().map(DVec3::from);
        DMat3::from_cols(x * scale, y * scale, own.axis.into())
    }
}

/// Sectors of the plane. Within a sector, the density of samples does not depend on the angle.
const SECTORS: usize = 256;

/// A Gaussian cut at the horizon, as a distribution. Its part above the horizon integrates to one.
struct AboveHorizon {
    shape: SphericalGaussian<f64>,
    /// The same Gaussian with the axes for the integral over polygons.
    over_polygons: SphericalGaussian<f64>,
    deviations: [DVec3; 2],
    /// The cumulative distribution of the part above the horizon, at each edge between sectors.
    before: Vec<f64>,
    /// The fraction of the Gaussian above the horizon.
    above: f64,
}

impl AboveHorizon {
    fn of(gaussian: Gaussian, columns: [[f64; 3]; 3]) -> Self {
        let shape = SphericalGaussian::along_first(gaussian, columns);
        let mut found = Self {
            deviations: shape.deviations().map(DVec3::from),
            before: vec![0.0],
            above: above_horizon(&shape).max(f64::MIN_POSITIVE),
            over_polygons: SphericalGaussian::of_columns(gaussian, columns),
            shape,
        };
        let mut sum = 0.0;
        for sector in 0..SECTORS {
            let (radius2, _) = found.ray((sector as f64 + 0.5) / SECTORS as f64);
            sum += 1.0 - exp(-radius2);
            found.before.push(sum);
        }
        found.before.iter_mut().for_each(|part| *part /= sum);
        found
    }

    /// The ray at a fraction of a turn: the squared radius at which it meets the horizon, and the vector of one
    /// deviation along it.
    fn ray(&self, turn: f64) -> (f64, DVec3) {
        let (sin, cos) = sin_cos(TAU * turn);
        let s = self.deviations[0] * cos + self.deviations[1] * sin;
        (horizon2(self.shape.axis[2], s.z, s.length_squared()), s)
    }
}

impl LobeDistribution for AboveHorizon {
    /// Inverts the cumulative distributions. The distribution of angles is tabulated, and the distribution of radii has
    /// a closed form.
    fn sample(&self, [around, outwards]: [f64; 2]) -> DVec3 {
        let sector = self.before.partition_point(|part| *part <= around).clamp(1, SECTORS) - 1;
        let (from, to) = (self.before[sector], self.before[sector + 1]);
        let inside = if to > from { (around - from) / (to - from) } else { 0.5 };
        let (radius2, s) = self.ray((sector as f64 + inside) / SECTORS as f64);
        let d = s * (-ln(1.0 - outwards * (1.0 - exp(-radius2)))).max(0.0).sqrt();
        let d2 = d.length_squared().min(4.0);
        DVec3::from(self.shape.axis) * (1.0 - 0.5 * d2) + d * (1.0 - 0.25 * d2).sqrt()
    }

    fn covered(&self, polygon: &[DVec3]) -> f64 {
        let vertices: Vec<[f64; 3]> = polygon.iter().map(DVec3::to_array).collect();
        (covered(&self.over_polygons, &vertices, Sides::Two) / self.above).min(1.0)
    }

    fn above_horizon(&self) -> f64 {
        self.above
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Lattice, row_major};

    /// A narrow Gaussian, a Gaussian cut by the horizon, and a Gaussian with its axis close to the horizon.
    fn matrices() -> [DMat3; 3] {
        [
            ([0.1, 0.02, 0.03], [-0.03, 0.06, 0.0], [-0.6, 0.2, 0.8]),
            ([0.9, 0.1, 0.2], [-0.2, 0.5, 0.1], [0.7, -0.2, 0.4]),
            ([0.3, 0.0, 0.6], [0.1, 0.4, 0.0], [0.8, 0.3, 0.01]),
        ]
        .map(|(x, y, z): ([f64; 3], [f64; 3], [f64; 3])| DMat3::from_cols(x.into(), y.into(), z.into()))
    }

    /// The integrals over the upper hemisphere of the density, and of the density times each function.
    fn by_quadrature(shape: &SphericalGaussian<f64>, functions: &[&dyn Fn(DVec3) -> f64]) -> Vec<f64> {
        const SIDE: u32 = 500;
        let mut sums = vec![0.0; functions.len()];
        for (row, column) in (0..SIDE).flat_map(|row| (0..2 * SIDE).map(move |column| (row, column))) {
            let z = (f64::from(row) + 0.5) / f64::from(SIDE);
            let (sin, cos) = sin_cos(TAU * (f64::from(column) + 0.5) / f64::from(2 * SIDE));
            let w = DVec3::new(cos, sin, 0.0) * (1.0 - z * z).sqrt() + DVec3::Z * z;
            let density = shape.density(w.to_array()) * TAU / f64::from(2 * SIDE * SIDE);
            for (sum, function) in sums.iter_mut().zip(functions) {
                *sum += density * function(w);
            }
        }
        sums
    }

    #[test]
    fn samples_follow_the_density_above_the_horizon() {
        let functions: [&dyn Fn(DVec3) -> f64; 4] = [&|_| 1.0, &|w| w.x, &|w| w.y * w.z, &|w| w.z * w.z];
        for (rules, m) in [SG, ASG].iter().flat_map(|rules| matrices().map(|m| (rules, m))) {
            let shape =
                SphericalGaussian::of_columns(rules.0, [m.x_axis, m.y_axis, m.z_axis].map(|column| column.to_array()));
            let wanted = by_quadrature(&shape, &functions);
            let model = rules.distribution(&row_major(&m)).expect("a regular matrix");
            assert!((model.above_horizon() - wanted[0]).abs() < 1e-3, "{}: {wanted:?}", model.above_horizon());
            let samples: Vec<DVec3> = Lattice::new(4096, [0.1, 0.7]).points().map(|u| model.sample(u)).collect();
            assert!(samples.iter().all(|w| w.z >= -1e-9 && (w.length() - 1.0).abs() < 1e-12));
            for (function, wanted_sum) in functions.iter().zip(&wanted) {
                let mean = samples.iter().map(|w| function(*w)).sum::<f64>() / samples.len() as f64;
                assert!((mean - wanted_sum / wanted[0]).abs() < 2e-3, "{:?}: {mean} {wanted:?}", rules.0);
            }
        }
    }

    #[test]
    fn a_wide_light_around_the_axis_covers_nearly_all_of_it() {
        for (rules, m) in [SG, ASG].iter().flat_map(|rules| [matrices()[0], matrices()[1]].map(|m| (rules, m))) {
            let model = rules.distribution(&row_major(&m)).expect("a regular matrix");
            let sky = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(|(x, y)| DVec3::new(x, y, 1e-4));
            let covered = model.covered(&sky);
            assert!(covered > 0.9, "{:?} {m}: {covered}", rules.0);
        }
    }

    #[test]
    fn turned_mirrored_and_scaled_columns_make_the_same_gaussian() {
        let m = matrices()[1];
        let of = |m: DMat3| ASG.distribution(&row_major(&m)).expect("regular").covered(&[DVec3::X, DVec3::Y, DVec3::Z]);
        let wanted = of(m);
        for other in [m * DMat3::from_rotation_z(0.7), m * DMat3::from_diagonal(DVec3::new(1.0, -1.0, 1.0)), m * 3.0] {
            // The integral over polygons depends on the axes of the deviations, so turned axes give a slightly
            // different result.
            assert!((of(other) - wanted).abs() < 0.04, "{} {wanted}", of(other));
        }
        assert!(ASG.distribution(&[0.0; 9]).is_none());
    }

    #[test]
    fn deviations_of_the_reflection_make_the_same_round_gaussian() {
        let reflection = DMat3::from_cols(
            DVec3::new(0.02, 0.0, 0.03),
            DVec3::new(0.0, 0.4, 0.0),
            DVec3::new(-0.7, 0.1, 0.6).normalize(),
        );
        let m = matrices()[0];
        let of = |m: &DMat3| {
            SphericalGaussian::of_columns(Gaussian::Sg, [m.x_axis, m.y_axis, m.z_axis].map(|column| column.to_array()))
        };
        let moved = SG.relative_to(&reflection, &m);
        let (wanted, found) = (of(&m), of(&moved));
        assert!((DVec3::from(wanted.axis) - DVec3::from(found.axis)).length() < 1e-12);
        assert!((found.peak() / wanted.peak() - 1.0).abs() < 1e-9, "{found:?} {wanted:?}");
        let ratio = moved.y_axis.length() / moved.x_axis.length();
        assert!(ratio > 5.0, "the deviations are not those of the reflection: {moved}");
        assert_eq!(ASG.relative_to(&reflection, &m), m);
    }
}
