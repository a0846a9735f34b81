//! The shape of a Gaussian: where it is and how wide.

use super::Gaussian;
use crate::math::{Scalar, Triple, cross, dot, minus, plus, scaled, unit};

/// The least height of an axis that a matrix gives: a Gaussian has its middle above the surface.
const LEAST_HEIGHT: f64 = 1e-6;
/// A smaller area between deviations counts as this one.
const LEAST_AREA: f64 = 1e-30;

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
    ///
    /// x and y of a round one matter where polygons are integrated. They are the perpendicular vectors closest to the
    /// directions of both deviations, the rotation of their polar decomposition: its x is along `d1 + d2'`, where `d2'`
    /// is the second deviation turned back by a right angle. So neither deviation comes first, and scenes mirrored by
    /// the diagonal are lit equally.
    #[must_use]
    pub fn new(gaussian: Gaussian, axis: Triple<T>, deviations: [Triple<T>; 2]) -> Self {
        let [first, second] = deviations;
        let rows = match gaussian {
            Gaussian::Asg => dual(axis, deviations),
            Gaussian::Sg => {
                let area = dot(axis, cross(first, second));
                let turned = cross(second, axis);
                let x = if area < T::ZERO { minus(first, turned) } else { plus(first, turned) };
                round(axis, x, area)
            }
        };
        Self { axis, rows }
    }

    /// The Gaussian of a table's matrix, by columns: the third is the axis, up to its length, and the other two are the
    /// deviations in units of that length, up to a component along the axis.
    ///
    /// A sharp Gaussian is then where the LTC of the same matrix is, and about as wide. Like that, it stays the same
    /// when the first two columns turn into each other, and when the matrix is scaled. So layouts store both in the
    /// same way. An axis below the horizon, which interpolation may leave, is raised onto it.
    #[must_use]
    pub fn of_columns(gaussian: Gaussian, columns: [Triple<T>; 3]) -> Self {
        let (axis, deviations) = axis_and_deviations(columns);
        Self::new(gaussian, axis, deviations)
    }

    /// As [`SphericalGaussian::of_columns`], with x of a round one along the first deviation. It is the same Gaussian,
    /// but a fit's samples and sums lie along x and y: with other ones, a recipe would give other bytes.
    #[must_use]
    pub(crate) fn along_first(gaussian: Gaussian, columns: [Triple<T>; 3]) -> Self {
        let (axis, [first, second]) = axis_and_deviations(columns);
        let rows = match gaussian {
            Gaussian::Asg => dual(axis, [first, second]),
            Gaussian::Sg => round(axis, first, dot(axis, cross(first, second))),
        };
        Self { axis, rows }
    }

    /// The vectors by which a direction moves from the axis for one in x, and for one in y: what
    /// [`SphericalGaussian::new`] takes.
    #[must_use]
    pub fn deviations(&self) -> [Triple<T>; 2] {
        dual(self.axis, self.rows)
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

/// The axis of a matrix, given by columns, and its deviations.
fn axis_and_deviations<T: Scalar>([x, y, z]: [Triple<T>; 3]) -> (Triple<T>, [Triple<T>; 2]) {
    let length = dot(z, z).sqrt().max(T::SHORTEST);
    let up = z[2].max(T::of(LEAST_HEIGHT) * length);
    let axis = unit([z[0], z[1], up]);
    let across = |column: Triple<T>| scaled(minus(column, scaled(axis, dot(axis, column))), T::ONE / length);
    (axis, [across(x), across(y)])
}

/// The vectors that give x and y of a stretched Gaussian: dual to its deviations.
fn dual<T: Scalar>(axis: Triple<T>, [first, second]: [Triple<T>; 2]) -> [Triple<T>; 2] {
    let area = dot(axis, cross(first, second));
    let size = area.abs().max(T::of(LEAST_AREA));
    let per_area = T::ONE / if area < T::ZERO { -size } else { size };
    [scaled(cross(second, axis), per_area), scaled(cross(axis, first), per_area)]
}

/// The vectors that give x and y of a round Gaussian, x along a vector perpendicular to the axis.
fn round<T: Scalar>(axis: Triple<T>, along_x: Triple<T>, area: T) -> [Triple<T>; 2] {
    let sharp = T::ONE / area.abs().max(T::of(LEAST_AREA)).sqrt();
    let x = unit(along_x);
    [scaled(x, sharp), scaled(cross(axis, x), sharp)]
}
