//! The integral of `c x dc` along an arc of a quadratic cone, in closed form.

use super::eigen::{Eigenframe, Symmetric, eigenframe};
use ltcforge_fit::math::{Scalar, Triple, dot, minus, scaled};

/// A cone `c^T K c = 0` with one positive eigenvalue, in its eigenframe.
pub(super) struct Cone<T> {
    /// The eigenvalues `l1 > 0 >= l2 >= l3`, and their eigenvectors.
    values: Triple<T>,
    vectors: [Triple<T>; 3],
    /// The gaps `l1 - l2`, `l1 - l3` and `l2 - l3`, and their square roots.
    gaps: Triple<T>,
    roots: Triple<T>,
}

/// An arc of a cone by its ends and their cross product, in the eigenframe.
pub(super) struct ConeArc<T> {
    pub(super) from: Triple<T>,
    pub(super) to: Triple<T>,
    pub(super) normal: Triple<T>,
}

impl<T: Scalar> Cone<T> {
    /// The cone of a symmetric matrix of any norm.
    pub(super) fn new(k: Symmetric<T>) -> Self {
        let [xx, yy, zz, xy, xz, yz] = k;
        let norm2 = xx * xx + yy * yy + zz * zz + T::of(2.0) * (xy * xy + xz * xz + yz * yz);
        let per_norm = T::ONE / norm2.sqrt().max(T::of(1e-30));
        let Eigenframe { values, vectors } = eigenframe(k.map(|x| x * per_norm));
        let l1 = values[0].max(T::of(1e-12));
        let l2 = values[1].min(T::ZERO);
        let l3 = values[2].min(l2);
        let gaps = [l1 - l2, l1 - l3, l2 - l3];
        Self { values: [l1, l2, l3], vectors, gaps, roots: gaps.map(Scalar::sqrt) }
    }

    /// Converts a vector to the eigenframe.
    pub(super) fn local(&self, v: Triple<T>) -> Triple<T> {
        self.vectors.map(|axis| dot(v, axis))
    }

    /// The angle around the cone's axis v1 between the ends of an arc, in [-pi, pi].
    pub(super) fn angle(&self, ConeArc { from, to, normal }: &ConeArc<T>) -> T {
        let ([d2, e2, _], [d, e, _]) = (self.gaps, self.roots);
        T::atan2(d * e * normal[0], d2 * from[1] * to[1] + e2 * from[2] * to[2])
    }

    /// True if two normals are less than a right angle apart around the axis.
    pub(super) fn are_on_one_side(&self, a: Triple<T>, b: Triple<T>) -> bool {
        self.gaps[0] * a[1] * b[1] + self.gaps[1] * a[2] * b[2] > T::ZERO
    }

    /// The integral along an arc that goes around the axis by the angle `psi`.
    pub(super) fn integral(&self, ConeArc { from, to, normal }: &ConeArc<T>, psi: T) -> Triple<T> {
        let ([l1, l2, l3], v) = (self.values, self.vectors);
        let ([d2, e2, g2], [d, e, g]) = (self.gaps, self.roots);
        let along1 = l1 / (d * e) * psi;

        // artanh(q) / (d g). For small q it is a series, because g can be zero.
        let slope = normal[1] / (d2 * from[0] * to[0] - g2 * from[2] * to[2]);
        let q = d * g * slope;
        let q2 = q * q;
        let along2 = if q2 < T::of(0.0025) {
            slope * (T::ONE + q2 * (T::of(1.0 / 3.0) + q2 * T::of(0.2)))
        } else {
            let ratio = ((T::ONE + q) / (T::ONE - q)).max(T::of(1e-30)).min(T::of(1e30));
            T::of(0.5) * ratio.ln() / (d * g)
        };

        // atan2 / (e g). For small angles it is a series, because e g can be zero.
        let bottom = e2 * from[0] * to[0] + g2 * from[1] * to[1];
        let top = e * g * normal[2];
        let along3 = if bottom > T::ZERO && top.abs() < T::of(0.03) * bottom {
            let r2 = top * top / (bottom * bottom);
            normal[2] / bottom * (T::ONE - r2 * (T::of(1.0 / 3.0) - r2 * T::of(0.2)))
        } else {
            T::atan2(top, bottom) / (e * g).max(T::of(1e-30))
        };
        let sum = minus(scaled(v[0], along1), scaled(v[1], l2 * along2));
        minus(sum, scaled(v[2], l3 * along3))
    }

    /// The integral once around the cone; two components vanish. It has the sign of `turn`.
    pub(super) fn whole(&self, turn: T) -> Triple<T> {
        scaled(self.vectors[0], self.values[0] / (self.roots[0] * self.roots[1]) * turn * T::TAU)
    }
}
