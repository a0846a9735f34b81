//! What of a normal's light is neither shadowed nor, for Schlick's term, transmitted; and its mean over triangles.

use crate::fit::math::{Scalar, Triple, dot, minus, plus, scaled};

/// A surface seen from a direction: what a normal's weight depends on.
#[derive(Debug, Clone, Copy)]
pub(super) struct View<T> {
    pub(super) alpha: [T; 2],
    /// The view direction.
    pub(super) wo: Triple<T>,
    /// `A wo`, and its length.
    pub(super) stretched: Triple<T>,
    pub(super) length: T,
}

/// A mean of weights while it is taken: the sum of what counts, of what is reflected, and of that times Schlick's fifth
/// power.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mean<T>(Triple<T>);

impl<T: Scalar> View<T> {
    pub(super) fn new([alpha_x, alpha_y]: [T; 2], wo: Triple<T>) -> Self {
        let stretched = [alpha_x * wo[0], alpha_y * wo[1], wo[2]];
        Self { alpha: [alpha_x, alpha_y], wo, stretched, length: dot(stretched, stretched).sqrt() }
    }

    /// `G2 / G1` and the same times `(1 - wo . h)^5` for the normal `h = A c` and the direction `wi` to which it
    /// reflects, for `c` of any length.
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
        [weight, weight * (m2 * m2 * m)]
    }

    /// The weight of a normal, by the projection of its area along `A wo`, which is the density of visible normals.
    pub(super) fn sample(&self, c: Triple<T>) -> Mean<T> {
        let length = dot(c, c).sqrt().max(T::SHORTEST);
        let seen = (dot(c, self.stretched) / length).max(T::ZERO);
        let [weight, fresnel] = self.weight(c);
        Mean([seen, seen * weight, seen * fresnel])
    }

    /// The mean weight over a triangle of normals around their centroid `m`, with the samples at its corners `u`, `a` and
    /// `b`.
    ///
    /// Corners, middles of edges and the centroid count by 0.04, 0.2 and 0.28: close to the rule of degree 3 [Strang and
    /// Fix 1973], whose 0.05, 0.133 and 0.45 see less of the steep weight at the horizon. A middle is taken as `3/2 m`
    /// less half of the opposite corner, so that an edge which bends outwards takes it along.
    pub(super) fn mean(&self, m: Triple<T>, corners: [Triple<T>; 3], samples: [Mean<T>; 3]) -> [T; 2] {
        let mut sum = scaled(self.sample(m).0, T::of(0.28));
        for (corner, Mean(sample)) in corners.into_iter().zip(samples) {
            let middle = minus(scaled(m, T::of(1.5)), scaled(corner, T::of(0.5)));
            sum = plus(sum, plus(scaled(sample, T::of(0.04)), scaled(self.sample(middle).0, T::of(0.2))));
        }
        let [seen, weight, fresnel] = sum;
        if seen > T::of(1e-18) { [weight / seen, fresnel / seen] } else { [T::ZERO; 2] }
    }
}
