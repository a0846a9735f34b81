//! The shape of a Gaussian: its direction and its width.

use super::Gaussian;
use crate::math::{Scalar, Triple, cross, dot, minus, plus, scaled, unit};

/// The smallest height of an axis. It keeps the centre of a Gaussian above the surface.
const LEAST_HEIGHT: f64 = 1e-6;
/// The smallest area that two deviations span.
const LEAST_AREA: f64 = 1e-30;

/// A Gaussian over directions, of weight one in the plane of its equal-area projection.
///
/// Its value per steradian is `peak exp(-x^2 - y^2)` at the point [`SphericalGaussian::at`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SphericalGaussian<T> {
    /// The centre, of unit length.
    pub axis: Triple<T>,
    /// The vectors whose products with a projected direction are x and y. They are perpendicular to the axis.
    pub rows: [Triple<T>; 2],
}

impl<T: Scalar> SphericalGaussian<T> {
    /// The Gaussian around an axis with these deviations: the vectors perpendicular to the axis at which x or y is one.
    /// A round Gaussian has the area that the deviations span. Domain: an axis of unit length.
    ///
    /// The axes x and y of a round Gaussian matter for the integral over polygons. They are the pair of perpendicular
    /// vectors that is closest to both deviations: the rotation of their polar decomposition. The axis x is along
    /// `d1 + d2'`, where `d2'` is the second deviation turned back by a right angle. Both deviations are treated alike,
    /// so scenes mirrored about the diagonal have equal light.
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

    /// The Gaussian of a table's matrix, by columns. The third column is the axis, up to its length. The other two are
    /// the deviations in units of this length, up to a component along the axis.
    ///
    /// A sharp Gaussian then has about the position and width of the LTC of the same matrix. Like the LTC, it does not
    /// change if the first two columns are rotated into each other, or if the matrix is scaled. Layouts can therefore
    /// store both in the same way. Interpolation can result in an axis below the horizon; such an axis is raised to the
    /// horizon.
    #[must_use]
    pub fn of_columns(gaussian: Gaussian, columns: [Triple<T>; 3]) -> Self {
        let (axis, deviations) = axis_and_deviations(columns);
        Self::new(gaussian, axis, deviations)
    }

    /// Like [`SphericalGaussian::of_columns`], but x of a round Gaussian is along the first deviation. The Gaussian is
    /// the same. A fit uses x and y for its samples and sums, so other axes would change the bytes of a recipe's table.
    #[must_use]
    pub(crate) fn along_first(gaussian: Gaussian, columns: [Triple<T>; 3]) -> Self {
        let (axis, [first, second]) = axis_and_deviations(columns);
        let rows = match gaussian {
            Gaussian::Asg => dual(axis, [first, second]),
            Gaussian::Sg => round(axis, first, dot(axis, cross(first, second))),
        };
        Self { axis, rows }
    }

    /// The deviations that [`SphericalGaussian::new`] takes: the displacements from the axis at which x or y is one.
    #[must_use]
    pub fn deviations(&self) -> [Triple<T>; 2] {
        dual(self.axis, self.rows)
    }

    /// Projects a direction of any length to the plane of the Gaussian. The result is in deviations.
    #[must_use]
    pub fn at(&self, w: Triple<T>) -> [T; 2] {
        let length = dot(w, w).sqrt();
        let from_behind = (length + dot(w, self.axis)).max(T::of(1e-6) * length);
        let scale = (T::of(2.0) / (length * from_behind).max(T::of(1e-36))).sqrt();
        self.rows.map(|row| dot(w, row) * scale)
    }

    /// Density at the centre, per steradian: `1 / (pi a1 a2)`.
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

/// The vectors that give x and y of a stretched Gaussian. They are dual to its deviations.
fn dual<T: Scalar>(axis: Triple<T>, [first, second]: [Triple<T>; 2]) -> [Triple<T>; 2] {
    let area = dot(axis, cross(first, second));
    let size = area.abs().max(T::of(LEAST_AREA));
    let per_area = T::ONE / if area < T::ZERO { -size } else { size };
    [scaled(cross(second, axis), per_area), scaled(cross(axis, first), per_area)]
}

/// The vectors that give x and y of a round Gaussian. The axis x is along `along_x`, which is perpendicular to the
/// axis.
fn round<T: Scalar>(axis: Triple<T>, along_x: Triple<T>, area: T) -> [Triple<T>; 2] {
    let sharp = T::ONE / area.abs().max(T::of(LEAST_AREA)).sqrt();
    let x = unit(along_x);
    [scaled(x, sharp), scaled(cross(axis, x), sharp)]
}
