//! The cone of normals that reflect a light's edge.

use ltcforge_fit::math::{Scalar, Triple, cross, dot};

/// The cone `c^T K c = 0` with `K = A B A`, `B = wo n^T + n wo^T - k I` and `k = wo . n`, which is not negative.
///
/// B has the eigenvalues `|n|`, `-|n|` and `-k`. By Sylvester's law, K has one positive eigenvalue, and the others are
/// not positive.
#[derive(Debug, Clone, Copy)]
pub(super) struct EdgeCone<T> {
    alpha: [T; 2],
    wo: Triple<T>,
    n: Triple<T>,
    k: T,
    /// K's eigenvalues, descending: `l1 > 0 >= l2 >= l3`.
    pub(super) values: Triple<T>,
}

impl<T: Scalar> EdgeCone<T> {
    /// Domain: `wo . n >= 0`, `n` of any length except zero.
    ///
    /// Let t be the sum of the eigenvalues, m the sum of their pairwise products, and d their product. The eigenvalue
    /// farthest from the others is `t / 3 +- 2 p cos(acos(x) / 3)`, `p^2 = t^2 / 9 - m / 3`, where x in [0, 1] is the
    /// absolute value of `((t / 3)^3 - t m / 6 + d / 2) / p^3` [Smith 1961]. Let e be this eigenvalue. The product of
    /// the other two is `d / e`, and their sum is `(m - d / e) / e`. In this form the other two keep their digits if
    /// they are smaller than e. If e is smaller, it is d divided by the product of the other two.
    pub(super) fn new(alpha: [T; 2], wo: Triple<T>, n: Triple<T>) -> Self {
        let (half, third, two) = (T::of(0.5), T::of(1.0 / 3.0), T::of(2.0));
        let k = dot(wo, n);
        let [x2, y2] = alpha.map(|alpha| alpha * alpha);
        // The diagonal and the principal minors of B.
        let across = cross(wo, n);
        let diagonal = [0, 1, 2].map(|i| two * wo[i] * n[i] - k);
        let minors = [0, 1, 2].map(|i| k * diagonal[i] - across[i] * across[i]);
        let trace = x2 * diagonal[0] + y2 * diagonal[1] + diagonal[2];
        let minor = y2 * minors[0] + x2 * (minors[1] + y2 * minors[2]);
        let determinant = x2 * y2 * (k * dot(n, n));

        let mean = trace * third;
        let spread2 = (mean * mean - minor * third).max(T::of(1e-36));
        let spread = spread2.sqrt();
        let cosine = (mean * (mean * mean - half * minor) + half * determinant) / spread / spread2;
        let is_first = cosine >= T::ZERO;
        let apart = two * spread * cos_of_third(cosine.abs().min(T::ONE));
        let rough = if is_first { mean + apart } else { mean - apart };
        let is_small = is_first && trace < -rough;
        let (isolated, sum, product) = if is_small {
            let sum = trace - rough;
            let product = minor - rough * sum;
            (determinant / product, sum, product)
        } else {
            let product = determinant / rough;
            (rough, (minor - product) / rough, product)
        };
        let radius = (sum * sum * T::of(0.25) - product).max(T::ZERO).sqrt();
        let is_above = !is_first && sum >= T::ZERO;
        let larger = half * sum + if is_above { radius } else { -radius };
        let smaller = if larger == T::ZERO { T::ZERO } else { product / larger };
        let [first, second, last] = match (is_first, is_above) {
            (true, _) => [isolated, smaller, larger],
            (false, true) => [larger, smaller, isolated],
            (false, false) => [smaller, larger, isolated],
        };
        let second = second.min(T::ZERO);
        let values = [first.max(T::of(1e-18)), second, last.min(second).min(-T::of(1e-30))];
        Self { alpha, wo, n, k, values }
    }

    /// The eigenvector of the first eigenvalue, not normalised, on the side of the cone's normals.
    ///
    /// `K v = l1 v` for `v = A^-1 u` is `(k A^2 + l1 I) u = A^2 (wo s + n t)`, `s = n . u`, `t = wo . u`. With the
    /// positive definite `W = A^2 (k A^2 + l1 I)^-1`, this gives `u = W (wo s + n t)`, and
    /// `s (1 - wo . W n) = t (n . W n)`. The factor `1 - wo . W n` is at least one half: it equals
    /// `sqrt((wo . W wo) (n . W n))`, which is not less than `wo . W n`.
    pub(super) fn axis(&self) -> Triple<T> {
        let Self { alpha: [x, y], wo, n, k, values: [first, ..] } = *self;
        // The diagonals of A^-1 W and W, times `sum`.
        let sum = k + first;
        let [sum_x, sum_y] = [x, y].map(|alpha| k * alpha * alpha + first);
        let scale = [x * sum / sum_x, y * sum / sum_y, T::ONE];
        let weighted = [x * scale[0] * n[0], y * scale[1] * n[1], n[2]];
        let (s, t) = (dot(weighted, n), sum - dot(weighted, wo));
        [0, 1, 2].map(|i| scale[i] * (wo[i] * s + n[i] * t))
    }

    /// `K v`.
    pub(super) fn image(&self, v: Triple<T>) -> Triple<T> {
        let Self { alpha: [x, y], wo, n, k, .. } = *self;
        let a = [x, y, T::ONE];
        let u = [0, 1, 2].map(|i| a[i] * v[i]);
        let (by_wo, by_n) = (dot(n, u), dot(wo, u));
        [0, 1, 2].map(|i| a[i] * (wo[i] * by_wo + n[i] * by_n - k * u[i]))
    }

    /// `(a . K b) det K^-1` for the unit vectors `a` and `b` of normals that reflect to the unit directions `wi` and
    /// `wi'`. The arguments are the lengths of the normals before they were normalised, and the squared distance of the
    /// directions. The value is `k (1 - wi . wi') / (lengths) / det K`, where k cancels.
    pub(super) fn bend(&self, lengths: [T; 2], apart2: T) -> T {
        let [x, y] = self.alpha;
        T::of(0.5) * apart2 / (lengths[0] * lengths[1] * dot(self.n, self.n) * (x * x * y * y)).max(T::of(1e-36))
    }
}

/// `cos(acos(x) / 3)` for x in [0, 1]: the root of `4 g^3 - 3 g = x` in [sqrt(3)/2, 1], from a polynomial and Newton
/// steps.
pub(crate) fn cos_of_third<T: Scalar>(x: T) -> T {
    let mut g = T::of(0.866_025_4) + x * (T::of(0.166_666_7) + x * (T::of(-0.042_520_7) + T::of(0.009_828_6) * x));
    for _ in 0..T::NEWTON_STEPS {
        g = (T::of(8.0) * g * g * g + x) / (T::of(12.0) * g * g - T::of(3.0));
    }
    g
}

#[cfg(test)]
mod tests {
    use super::*;
    use ltcforge_fit::math::{direction, minus, scaled};

    /// Eigenvalues and axis satisfy their definitions, also for mirrors, needles, and planes through the view.
    #[test]
    fn eigenvalues_and_axis_satisfy_their_definitions() {
        let fraction = |i: u32, step: f64| (f64::from(i) * step).fract();
        let mut checked = 0;
        for i in 1..=20_000 {
            let [a, b, c, d, e, f] =
                [0.754_877_67, 0.569_840_29, 0.438_447_19, 0.309_016_99, 0.221_232_9, 0.672_9].map(|s| fraction(i, s));
            let alpha = [10_f64.powf(-4.0 * a), 10_f64.powf(-4.0 * b)];
            let wo = direction(1.57 * c, std::f64::consts::TAU * d).to_array();
            let n = scaled(direction((1.0 - 2.0 * e).acos(), std::f64::consts::TAU * f).to_array(), 1e-3 + a);
            let n = if dot(wo, n) < 0.0 { scaled(n, -1.0) } else { n };
            let cone = EdgeCone::new(alpha, wo, n);
            let [l1, l2, l3] = cone.values;
            assert!(l1 > 0.0 && l2 <= 0.0 && l3 <= l2, "{:?}", cone.values);
            let product = alpha[0].powi(2) * alpha[1].powi(2) * cone.k * dot(n, n);
            assert!((l1 * l2 * l3 - product).abs() < 1e-9 * product, "{cone:?}");
            let axis = cone.axis();
            let off = minus(cone.image(axis), scaled(axis, l1));
            let size = l1.max(-l3) * dot(axis, axis).sqrt();
            assert!(dot(off, off).sqrt() < 1e-11 * size, "{cone:?} {axis:?} {off:?}");
            // Normals are on the same side of the cone as the axis.
            let side = [1.0 / alpha[0], 1.0 / alpha[1], 1.0];
            let w = direction(std::f64::consts::FRAC_PI_2 * b, std::f64::consts::TAU * e).to_array();
            let w = minus(w, scaled(n, dot(w, n) / dot(n, n)));
            let length = dot(w, w).sqrt();
            if length > 1e-3 && w[2] > 0.0 {
                let normal = [0, 1, 2].map(|i| side[i] * (wo[i] + w[i] / length));
                assert!(dot(normal, axis) > 0.0, "{cone:?} {w:?}");
                assert!(
                    dot(normal, cone.image(normal)).abs() < 1e-9 * l1.max(-l3) * dot(normal, normal),
                    "{cone:?} {w:?}"
                );
                checked += 1;
            }
        }
        assert!(checked > 5000, "{checked}");
    }
}
