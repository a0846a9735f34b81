//! A GGX surface with a view direction, and the weight for shadowing.

use ltcforge_fit::math::{Scalar, Triple, dot, minus, scaled};

/// A GGX surface with a view direction.
#[derive(Debug, Clone, Copy)]
pub(crate) struct View<T> {
    /// Roughness along x and y. A is `diag(alpha_x, alpha_y, 1)`.
    pub(crate) alpha: [T; 2],
    /// The view direction.
    pub(crate) wo: Triple<T>,
    /// `A wo` and its length.
    pub(crate) stretched: Triple<T>,
    pub(crate) length: T,
    /// The view's rise, see [`View::rise`].
    pub(super) rise: T,
}

/// The weight of a normal, and its angle of incidence.
#[derive(Debug, Clone, Copy)]
pub(super) struct Weighted<T> {
    /// `G2 / G1`: the part of the light that is not shadowed.
    pub(super) weight: T,
    /// `1 - wo . h`, whose fifth power is Schlick's factor.
    pub(super) incidence: T,
}

impl<T: Scalar> View<T> {
    pub(crate) fn new([alpha_x, alpha_y]: [T; 2], wo: Triple<T>) -> Self {
        let stretched = [alpha_x * wo[0], alpha_y * wo[1], wo[2]];
        let length = dot(stretched, stretched).sqrt();
        Self { alpha: [alpha_x, alpha_y], wo, stretched, length, rise: wo[2] / length }
    }

    /// `A^-1 h`.
    pub(crate) fn image(&self, h: Triple<T>) -> Triple<T> {
        [h[0] / self.alpha[0], h[1] / self.alpha[1], h[2]]
    }

    /// The direction to which the normal `h = A c` reflects the view, not normalised. `c` can have any length and
    /// either sign.
    pub(crate) fn reflected(&self, c: Triple<T>) -> Triple<T> {
        let h = [self.alpha[0] * c[0], self.alpha[1] * c[1], c[2]];
        minus(scaled(h, T::of(2.0) * dot(self.wo, h)), scaled(self.wo, dot(h, h)))
    }

    /// The height of a direction in the space where the surface is a hemisphere: `mu = z / |A w|`, in [0, 1]; zero
    /// below the horizon. `w` can have any length.
    pub(super) fn rise(&self, w: Triple<T>) -> T {
        let stretched = [self.alpha[0] * w[0], self.alpha[1] * w[1], w[2]];
        w[2].max(T::ZERO) / dot(stretched, stretched).max(T::of(1e-30)).sqrt()
    }

    /// `G2 / G1` of a light direction from its rise: `(1 + mu_o) mu_i / (mu_i + mu_o)`. It is zero at the horizon
    /// [Heitz 2014, height-correlated].
    pub(super) fn weight_of(&self, rise: T) -> T {
        (T::ONE + self.rise) * rise / (rise + self.rise)
    }

    /// The weight of the normal `h = A c`, from the direction `wi` to which it reflects the view. `c` can have any
    /// length and either sign.
    pub(super) fn at(&self, c: Triple<T>) -> Weighted<T> {
        let normal = [self.alpha[0] * c[0], self.alpha[1] * c[1], c[2]];
        let h = scaled(normal, T::ONE / dot(normal, normal).max(T::of(1e-30)).sqrt());
        let cosine = dot(self.wo, h);
        let wi = minus(scaled(h, T::of(2.0) * cosine), self.wo);
        let incidence = (T::ONE - cosine.abs()).max(T::ZERO).min(T::ONE);
        Weighted { weight: self.weight_of(self.rise(wi)), incidence }
    }
}
