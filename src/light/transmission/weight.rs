//! The weight of a normal: the part of its light that is neither shadowed nor reflected. This file also computes the
//! mean weight over triangles of normals.

use super::interface::Interface;
use ltcforge_fit::math::{Scalar, Triple, dot, minus, plus, scaled};

/// The position of three sample points of a triangle, on the lines from the centroid to the corners. The centroid is
/// the fourth point. Found by a search on cases of `eta = 1.5` and `1/1.5`, and checked on other cases.
const CORNER_SHARE: f64 = 0.9;
const CORNER_WEIGHT: f64 = 0.11;

impl<T: Scalar> Interface<T> {
    /// `G2 / G1` of the normal `h = A c`, and its product with `1 - F` by the Fresnel equations and by Schlick's
    /// approximation.
    ///
    /// With `S(w) = |A w|`, `G2 / G1 = (1 + L(wo)) / (1 + L(wo) + L(wi)) = (zo + So) zi / (So zi + zo Si)`, where zi is
    /// positive below. `wi` can have any length: `(cos_o - eta cos_i) h - wo`,
    /// `eta cos_i = sqrt(cos_o^2 - (1 - eta^2))`. All are zero if `wi` is above the surface. All but the first are zero
    /// for total reflection.
    fn weight(&self, c: Triple<T>) -> Triple<T> {
        let h = self.stretch(c);
        let h = scaled(h, T::ONE / dot(h, h).sqrt().max(T::SHORTEST));
        let tiny = T::of(1e-30);
        let cos_o = dot(self.wo, h).max(T::ZERO).min(T::ONE);
        let eta_cos_i = (cos_o * cos_o - self.contrast()).max(T::ZERO).sqrt();
        let wi = minus(scaled(h, cos_o - eta_cos_i), self.wo);
        let depth = (-wi[2]).max(T::ZERO);
        let stretched = self.stretch(wi);
        let bottom = self.length * depth + self.wo[2] * dot(stretched, stretched).sqrt();
        let weight = (self.wo[2] + self.length) * depth / bottom.max(tiny);

        let cos_i = eta_cos_i / self.eta;
        let across = (cos_o - eta_cos_i) / (cos_o + eta_cos_i).max(tiny);
        let along = (self.eta * cos_o - cos_i) / (self.eta * cos_o + cos_i).max(tiny);
        let dielectric = T::ONE - T::of(0.5) * (across * across + along * along);
        let root = (T::ONE - self.eta) / (T::ONE + self.eta);
        let m = T::ONE - if self.is_denser() { cos_o } else { cos_i.min(T::ONE) };
        let m2 = m * m;
        let schlick = (T::ONE - root * root) * (T::ONE - m2 * m2 * m);
        [weight, weight * dielectric, weight * schlick]
    }

    /// The mean weight over a triangle of normals around their centroid. Each sample is weighted by its component along
    /// `A wo`, which is proportional to the density of visible normals.
    pub(super) fn mean_weight(&self, centroid: Triple<T>, corners: [Triple<T>; 3]) -> Triple<T> {
        let (mut sum, mut total) = ([T::ZERO; 3], T::ZERO);
        let mut add = |c: Triple<T>, count: T| {
            let projection = (dot(c, self.stretched) / dot(c, c).sqrt().max(T::SHORTEST)).max(T::ZERO);
            sum = plus(sum, scaled(self.weight(c), count * projection));
            total = total + count * projection;
        };
        let [near, far] = [1.0 - CORNER_SHARE, CORNER_SHARE].map(T::of);
        for corner in corners {
            add(plus(scaled(centroid, near), scaled(corner, far)), T::of(CORNER_WEIGHT));
        }
        add(centroid, T::of(1.0 - 3.0 * CORNER_WEIGHT));
        if total > T::of(1e-18) { scaled(sum, T::ONE / total) } else { [T::ZERO; 3] }
    }
}
