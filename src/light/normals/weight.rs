//! The weight of a normal's light, which is neither shadowed nor, for Schlick's term, transmitted; and its mean over
//! triangles.

use ltcforge_fit::math::{Scalar, Triple, dot, minus, plus, scaled};

/// A surface seen from a direction, on which a normal's weight depends.
#[derive(Debug, Clone, Copy)]
pub(super) struct View<T> {
    pub(super) alpha: [T; 2],
    /// The view direction.
    pub(super) wo: Triple<T>,
    /// `A wo`, and its length.
    pub(super) stretched: Triple<T>,
    pub(super) length: T,
}

/// The numbers of a rule for a view.
#[derive(Debug, Clone, Copy)]
pub(super) struct Numbers<T> {
    /// How much the outer sample of a triangle counts beside its centroid.
    outer: T,
    /// How much each corner of its outer side does.
    corner: T,
    /// The outer sample is beyond the centroid, seen from the tip, by this part of the way between them; where the edge
    /// is flat, its middle is so by half.
    beyond: T,
    /// How fast the weight falls towards the horizon: see [`to_horizon`].
    rate: T,
    /// How far beyond the centroid the sample of a triangle is whose outer edge is the horizon.
    near: T,
    /// The tip's part of Schlick's factor in such a triangle.
    tip: T,
    /// Where the edge is wide, by how much a second normal's weight counts in place of the mean of [`to_horizon`], and
    /// how far beyond the centroid that normal is; if negative, towards the tip.
    inner: T,
    within: T,
}

/// The numbers of a rule for all views: each is the product of its row and `(1, mu_o, alpha, alpha mu_o, r, r alpha)`,
/// or its first four, with the larger alpha and the ratio r of the smaller to it; all but `within` at least zero. They
/// have the least error over random lights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forms {
    /// How much the outer sample of a triangle counts, and each outer corner; how far beyond the centroid the sample
    /// is; of a triangle on the horizon the rate of its weight, how far beyond the centroid its sample is, and the
    /// tip's part of Schlick's factor.
    pub usual: [[f64; 4]; 6],
    /// The same where the edge on or near the horizon is wide.
    pub wide: [[f64; 6]; 6],
    /// By how much a second normal counts there, zero where no edge is wide, and how far beyond the centroid it is.
    pub inner: [[f64; 6]; 2],
}

/// A rate of zero would divide zero by zero.
const LEAST_RATE: f64 = 0.02;
/// How much the tip counts beside a centroid: so little that it matters only where all other normals are seen edge-on,
/// where the mean would jump.
const TIP: f64 = 0.03;

impl<T: Scalar> Numbers<T> {
    /// `wide`: by how much the edge on or near the horizon is wide.
    pub(super) fn new(forms: &Forms, view: &View<T>, wide: T) -> Self {
        let (mu, alpha) = (view.wo[2] / view.length, view.alpha[0].max(view.alpha[1]));
        let ratio = view.alpha[0].min(view.alpha[1]) / alpha;
        let at = [T::ONE, mu, alpha, alpha * mu, ratio, ratio * alpha];
        let number = |row: &[f64]| row.iter().zip(at).fold(T::ZERO, |sum, (x, at)| sum + T::of(*x) * at);
        let [outer, corner, beyond, rate, near, tip] = [0, 1, 2, 3, 4, 5].map(|i| {
            let (usual, widest) = (number(&forms.usual[i]), number(&forms.wide[i]));
            (usual + wide * (widest - usual)).max(T::ZERO)
        });
        let [inner, within] = forms.inner.map(|row| number(&row));
        let inner = wide * inner.max(T::ZERO);
        Self { outer, corner, beyond, rate: rate.max(T::of(LEAST_RATE)), near, tip, inner, within }
    }
}

/// The contribution of a normal to a mean: its share, that times its weight, and that times Schlick's factor.
#[derive(Debug, Clone, Copy)]
pub(super) struct WeightedNormal<T>(Triple<T>);

impl<T: Scalar> View<T> {
    pub(super) fn new([alpha_x, alpha_y]: [T; 2], wo: Triple<T>) -> Self {
        let stretched = [alpha_x * wo[0], alpha_y * wo[1], wo[2]];
        Self { alpha: [alpha_x, alpha_y], wo, stretched, length: dot(stretched, stretched).sqrt() }
    }

    /// `G2 / G1` and `(1 - wo . h)^5` for the normal `h = A c` and the direction `wi` to which it reflects, for `c` of
    /// any length.
    ///
    /// With `S(w) = |A w|`, `G2 / G1 = (zo + So) zi / (So zi + zo Si)`, where `wi` may have any length:
    /// `2 (wo . Ac) Ac - |Ac|^2 wo`. Zero where `wi` is below the surface.
    pub(super) fn weight(&self, c: Triple<T>) -> [T; 2] {
        let [alpha_x, alpha_y] = self.alpha;
        let h = [alpha_x * c[0], alpha_y * c[1], c[2]];
        let (length2, cosine) = (dot(h, h).max(T::of(1e-36)), dot(self.wo, h));
        let wi = minus(scaled(h, T::of(2.0) * cosine), scaled(self.wo, length2));
        let up = wi[2].max(T::ZERO);
        let (x, y) = (alpha_x * wi[0], alpha_y * wi[1]);
        let stretched = (x * x + y * y + wi[2] * wi[2]).sqrt();
        let bottom = self.length * up + self.wo[2] * stretched;
        let weight = (self.wo[2] + self.length) * up / bottom.max(T::of(1e-36));
        let m = (T::ONE - cosine / length2.sqrt()).max(T::ZERO).min(T::ONE);
        let m2 = m * m;
        [weight, m2 * m2 * m]
    }

    /// How far above the surface a normal reflects: `wi.z |A c|^2`.
    pub(super) fn rise(&self, c: Triple<T>) -> T {
        let h = [self.alpha[0] * c[0], self.alpha[1] * c[1], c[2]];
        T::of(2.0) * dot(self.wo, h) * h[2] - dot(h, h) * self.wo[2]
    }

    /// A normal in a mean. It counts by its projection along `A wo`, to which the density of visible normals is
    /// proportional, and by its length.
    pub(super) fn sample(&self, c: Triple<T>) -> WeightedNormal<T> {
        let seen = dot(c, self.stretched).max(T::ZERO);
        let [weight, schlick] = self.weight(c);
        WeightedNormal([seen, seen * weight, seen * weight * schlick])
    }

    /// The mean weight, and that times Schlick's factor, over a triangle of normals between `tip` and an edge, by its
    /// centroid `m`, a normal beyond it, and its corners, the tip first.
    pub(super) fn over_triangle(
        &self,
        numbers: &Numbers<T>,
        tip: Triple<T>,
        m: Triple<T>,
        corners: [WeightedNormal<T>; 3],
    ) -> [T; 2] {
        let [at_tip, from, to] = corners.map(|WeightedNormal(sample)| sample);
        let (WeightedNormal(at_m), WeightedNormal(at_outer)) =
            (self.sample(m), self.sample(beyond(tip, m, numbers.beyond)));
        let inner = plus(plus(at_m, scaled(at_outer, numbers.outer)), scaled(at_tip, T::of(TIP)));
        let [seen, energy, fresnel] = plus(inner, scaled(plus(from, to), numbers.corner));
        let per_seen = T::ONE / seen.max(T::of(1e-18));
        [energy * per_seen, fresnel * per_seen]
    }

    /// The same where the edge is along the horizon, where the weight is zero; `at_tip` is that of the tip.
    pub(super) fn over_triangle_to_horizon(
        &self,
        numbers: &Numbers<T>,
        tip: Triple<T>,
        at_tip: [T; 2],
        m: Triple<T>,
    ) -> [T; 2] {
        let [near, schlick] = self.weight(beyond(tip, m, numbers.near));
        let fallen = to_horizon(at_tip[0], near, numbers.rate);
        let [within, _] = self.weight(beyond(tip, m, numbers.within));
        let mean = fallen + numbers.inner * (within - fallen);
        [mean, mean * (numbers.tip * at_tip[1] + (T::ONE - numbers.tip) * schlick)]
    }
}

/// The normal beyond `m` as seen from `tip`, up to length.
fn beyond<T: Scalar>(tip: Triple<T>, m: Triple<T>, by: T) -> Triple<T> {
    plus(m, scaled(minus(m, tip), by))
}

/// The mean over a triangle of a weight that is `tip` at its tip, zero on its outer edge, and `near` close to that.
///
/// On the way from the tip, `s = 0`, to the edge, `s = 1`, the weight is taken to be `tip (1 - s) / (1 - s + r s)`, as
/// it is where `mu_i` falls linearly. Its mean over the triangle is `tip M(r)`,
/// `M(r) = integral of 2 s (1 - s) / (1 - s + r s) ds`, and a sample at s gives `r = rate (tip / near - 1)`,
/// `rate = (1 - s) / s`, 0.154 at 13/15. M is taken from a polynomial in `u = sqrt r / (1 + sqrt r)` that is 0.003 off
/// at most; its first terms are those of M, so that it has no kink at `r = 0`.
fn to_horizon<T: Scalar>(tip: T, near: T, rate: T) -> T {
    let root = (rate * near * (tip - near).max(T::ZERO)).sqrt();
    // 1 - u is zero where near is.
    let rest = near / (near + root).max(T::of(1e-36));
    let u = T::ONE - rest;
    let [c2, c3, c4, c5] = [-7.406_264_7, 21.070_869, -31.448_433, 16.743_261].map(T::of);
    tip * rest * rest * (T::ONE + u * (T::of(2.0) + u * (c2 + u * (c3 + u * (c4 + u * c5)))))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `M(r)` is the integral of `2 s (1 - s) / (1 - s + r s)`, here by the midpoint rule.
    #[test]
    fn the_mean_towards_the_horizon_is_that_of_its_form() {
        const STEPS: u32 = 10_000;
        let (rate, tip) = (0.2, 0.7);
        let mut worst = 0.0_f64;
        for r in (-60..=60).map(|x| 10_f64.powf(f64::from(x) / 12.0)) {
            let at = |i: u32| (f64::from(i) + 0.5) / f64::from(STEPS);
            let sum: f64 = (0..STEPS).map(at).map(|s| 2.0 * s * (1.0 - s) / (1.0 - s + r * s)).sum();
            let near = tip * rate / (rate + r);
            worst = worst.max((to_horizon(tip, near, rate) / tip - sum / f64::from(STEPS)).abs());
        }
        assert!(worst > 1e-4 && worst < 0.003, "{worst}");
        assert_eq!(to_horizon(0.7, 0.7, rate), 0.7);
        assert_eq!([to_horizon(0.0, 0.0, rate), to_horizon(0.7, 0.0, rate)], [0.0; 2]);
    }
}
