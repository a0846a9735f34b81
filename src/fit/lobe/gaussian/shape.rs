//! The shape of a Gaussian: where it is and how wide.

use super::Gaussian;
use crate::math::{Scalar, Triple, cross, dot, minus, scaled, unit};

/// The least height of an axis that a matrix gives: a Gaussian has its middle above the surface.
const LEAST_HEIGHT: f64 = 1e-6;

/// A Gaussian over directions, of weight one in the plane of its equal-area projection.
///
/// Per steradian it is `peak exp(-x^2 - y^2)` at [`SphericalGaussian::at`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SphericalGaussian<T> {
    /// The middle, of length one.
    pub axis: Triple<T>,
    /// The vectors whose products with a direction, projected, are x and y; perpendicular to the axis.
    pub rows: [Triple<T>; 2],
}

impl<T: Scalar> SphericalGaussian<T> {
    /// The Gaussian around an axis whose deviations, where x or y is one, are these vectors perpendicular to it; for a
    /// round one the same area, round. Domain: an axis of length one.
    #[must_use]
    pub fn new(gaussian: Gaussian, axis: Triple<T>, deviations: [Triple<T>; 2]) -> Self {
        Self { axis, rows: dual(gaussian, axis, deviations) }
    }

    /// The Gaussian of a table's matrix, by columns: the third is the axis, up to its length, and the other two are the
    /// deviations in units of that length, up to a component along the axis.
    ///
    /// A sharp Gaussian is then where the LTC of the same matrix is, and about as wide. Like that, it stays the same
    /// when the first two columns turn into each other, and when the matrix is scaled. So layouts store both in the
    /// same way. An axis below the horizon, which interpolation may leave, is raised onto it.
    #[must_use]
    pub fn of_columns(gaussian: Gaussian, [x, y, z]: [Triple<T>; 3]) -> Self {
        let length = dot(z, z).sqrt().max(T::SHORTEST);
        let up = z[2].max(T::of(LEAST_HEIGHT) * length);
        let axis = unit([z[0], z[1], up]);
        let across = |column: Triple<T>| scaled(minus(column, scaled(axis, dot(axis, column))), T::ONE / length);
        Self::new(gaussian, axis, [across(x), across(y)])
    }

    /// The vectors by which a direction moves from the axis for one in x, and for one in y: what
    /// [`SphericalGaussian::new`] takes.
    #[must_use]
    pub fn deviations(&self) -> [Triple<T>; 2] {
        dual(Gaussian::Asg, self.axis, self.rows)
    }

    /// Where a direction of any length lies in the plane of the Gaussian, in its deviations.
    #[must_use]
    pub fn at(&self, w: Triple<T>) -> [T; 2] {
        let length = dot(w, w).sqrt();
        let from_behind = (length + dot(w, self.axis)).max(T::of(1e-6) * length);
        let scale = (T::of(2.0) / (length * from_behind).max(T::of(1e-36))).sqrt();
        self.rows.map(|row| dot(w, row) * scale)
    }

    /// Density in its middle, per steradian: `1 / (pi a1 a2)`.
    #[must_use]
    pub fn peak(&self) -> T {
        let [x, y] = self.rows;
        T::of(2.0) * dot(self.axis, cross(x, y)).abs() / T::TAU
    }

    /// Density towards a direction, per steradian.
    #[must_use]
    pub fn density(&self, w: Triple<T>) -> T {
        let [x, y] = self.at(w);
        self.peak() * (-(x * x + y * y)).exp()
    }
}

/// The vectors that give x and y: dual to the deviations, or for a round Gaussian perpendicular and of the same area.
fn dual<T: Scalar>(gaussian: Gaussian, axis: Triple<T>, [first, second]: [Triple<T>; 2]) -> [Triple<T>; 2] {
    let area = dot(axis, cross(first, second));
    let least = T::of(1e-30);
    match gaussian {
        Gaussian::Asg => {
            let size = area.abs().max(least);
            let per_area = T::ONE / if area < T::ZERO { -size } else { size };
            [scaled(cross(second, axis), per_area), scaled(cross(axis, first), per_area)]
        }
        Gaussian::Sg => {
            let sharp = T::ONE / area.abs().max(least).sqrt();
            let x = unit(first);
            [scaled(x, sharp), scaled(cross(axis, x), sharp)]
        }
    }
}
