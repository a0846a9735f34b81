//! A rough interface with a view direction, and the normals of refracted directions.

use ltcforge_fit::math::{Scalar, Triple, dot, plus, scaled, unit};

/// A rough interface with a view direction.
#[derive(Debug, Clone, Copy)]
pub(super) struct Interface<T> {
    pub(super) alpha: [T; 2],
    /// The view direction.
    pub(super) wo: Triple<T>,
    /// The refractive index behind the interface divided by the refractive index in front of it.
    pub(super) eta: T,
    /// `sigma`: the sign of the normal along `wo + eta wi`.
    pub(super) sigma: T,
    /// `A wo` and its length.
    pub(super) stretched: Triple<T>,
    pub(super) length: T,
}

impl<T: Scalar> Interface<T> {
    pub(super) fn new(alpha: [T; 2], wo: Triple<T>, eta: T) -> Self {
        let stretched = stretched(alpha, wo);
        let sigma = if eta > T::ONE { -T::ONE } else { T::ONE };
        Self { alpha, wo, eta, sigma, stretched, length: dot(stretched, stretched).sqrt() }
    }

    /// True if the far side is denser.
    pub(super) fn is_denser(&self) -> bool {
        self.eta > T::ONE
    }

    /// `1 - eta^2`, without rounding of the square.
    pub(super) fn contrast(&self) -> T {
        (T::ONE - self.eta) * (T::ONE + self.eta)
    }

    /// The factor from `2 pi (A wo) . F` to the part of the visible normals.
    pub(super) fn per_flux(&self) -> T {
        T::of(2.0) / ((self.wo[2] + self.length) * T::TAU)
    }

    /// `A v`.
    pub(super) fn stretch(&self, v: Triple<T>) -> Triple<T> {
        stretched(self.alpha, v)
    }

    /// `sigma A^-1 (weight wo + eta w)`. With a weight of one it is the normal that refracts `w`, not normalised.
    pub(super) fn normal(&self, weight: T, w: Triple<T>) -> Triple<T> {
        let sum = plus(scaled(self.wo, weight), scaled(w, self.eta));
        let [x, y, z] = scaled(sum, self.sigma);
        [x / self.alpha[0], y / self.alpha[1], z]
    }

    /// The image of a direction: the normal that refracts it, of unit length.
    pub(super) fn image(&self, w: Triple<T>) -> Triple<T> {
        unit(self.normal(T::ONE, w))
    }
}

fn stretched<T: Scalar>([alpha_x, alpha_y]: [T; 2], v: Triple<T>) -> Triple<T> {
    [alpha_x * v[0], alpha_y * v[1], v[2]]
}
