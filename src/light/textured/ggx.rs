//! GGX on the plane of a light.
//!
//! The light that a piece dA of the plane at P, `r = |P|`, sends to the viewer is proportional to
//! `D(h) G2 / cos_i cos_i (height / r) / r^2 dA`. Let `c = (A^-1 wo) r + A^-1 P`, which is `A^-1 h` up to length,
//! `N = |c|^2` and `e = r + wo . P`. Then GGX is `D = (r e / N)^2` up to a factor, and
//!
//! ```text
//! light of dA = q^-2 z / (|A wo| z + wo.z |A P|) dA          q = N sqrt(r) / e
//! ```
//!
//! The last factor is Smith's G2 (height-correlated) divided by the cosines, and varies slowly. q is close to a
//! quadratic function. Its derivatives follow from its logarithm, with `ri = P . ei / r`, `rij = (dij - ri rj) / r`,
//! `ci = (A^-1 wo) ri + A^-1 ei` and `ei = ri + wo . ei`:
//!
//! ```text
//! gradient of ln q              gi = 2 c . ci / N + ri / 2 r - ei / e
//! second derivatives of ln q    2 (ci . cj + c . (A^-1 wo) rij) / N - 4 (c . ci) (c . cj) / N^2
//!                               + (rij / r - ri rj / r^2) / 2 - rij / e + ei ej / e^2
//! second derivatives of q / q   the same + gi gj
//! ```

use super::{
    bump::{Bump, Symmetric},
    readings::Lobe,
    rectangle::Rectangle,
};
use crate::normals::View;
use ltcforge_fit::math::{Scalar, Triple, dot, plus, scaled};

/// The smallest value of `1 + wo . w`, for a light exactly opposite to the viewer.
const LEAST_FACING: f64 = 1e-6;
/// The weight of a fully shadowed point. It keeps the sum of weights positive.
const LEAST_SHADOW: f64 = 1e-6;
/// The smallest second derivative of q, divided by q, times the rectangle's area. Flatter lobes see a single colour.
const LEAST_SECOND: f64 = 0.1;

/// The light of GGX on the plane of a rectangle.
pub(super) struct GgxLobe<'a, T> {
    view: &'a View<T>,
    rectangle: &'a Rectangle<T>,
    /// `A^-1 wo`.
    image: Triple<T>,
}

impl<'a, T: Scalar> GgxLobe<'a, T> {
    pub(super) fn new(view: &'a View<T>, rectangle: &'a Rectangle<T>) -> Self {
        Self { view, rectangle, image: view.image(view.wo) }
    }

    /// r, c, N and e at a point.
    fn parts(&self, p: Triple<T>) -> (T, Triple<T>, T, T) {
        let r = dot(p, p).sqrt().max(T::SHORTEST);
        let c = plus(scaled(self.image, r), self.view.image(p));
        (r, c, dot(c, c).max(T::SHORTEST), (r + dot(self.view.wo, p)).max(T::of(LEAST_FACING) * r))
    }

    /// The gradient and second derivatives of q, divided by q, in the rectangle's coordinates.
    pub(super) fn derivatives(&self, p: [T; 2]) -> ([T; 2], Symmetric<T>) {
        let p = self.rectangle.at(p);
        let axes = self.rectangle.axes;
        let (r, c, n, e) = self.parts(p);
        let (half, two) = (T::of(0.5), T::of(2.0));
        let dr = axes.map(|axis| dot(p, axis) / r);
        let dc = [0, 1].map(|i| plus(scaled(self.image, dr[i]), self.view.image(axes[i])));
        let ln_n = dc.map(|dc| two * dot(c, dc) / n);
        let ln_e = [0, 1].map(|i| (dr[i] + dot(self.view.wo, axes[i])) / e);
        let gradient = [0, 1].map(|i| ln_n[i] + half * dr[i] / r - ln_e[i]);
        let along_image = dot(c, self.image);
        let second = [(0, 0), (0, 1), (1, 1)].map(|(i, j)| {
            let ddr = (if i == j { T::ONE } else { T::ZERO } - dr[i] * dr[j]) / r;
            let of_n = two * (dot(dc[i], dc[j]) + along_image * ddr) / n - ln_n[i] * ln_n[j];
            let of_r = half * (ddr / r - dr[i] * dr[j] / (r * r));
            of_n + of_r - ddr / e + ln_e[i] * ln_e[j] + gradient[i] * gradient[j]
        });
        (gradient, second)
    }

    /// The bump that approximates the lobe, expanded at a point.
    pub(super) fn bump(&self, p: [T; 2]) -> Bump<T> {
        let (gradient, second) = self.derivatives(p);
        Bump::of_derivatives(p, gradient, second, T::of(LEAST_SECOND) / self.rectangle.area())
    }

    /// The density of the lobe at a point, up to a factor.
    pub(super) fn density(&self, p: [T; 2]) -> T {
        let p = self.rectangle.at(p);
        let (r, _, n, e) = self.parts(p);
        let stretched = [self.view.alpha[0] * p[0], self.view.alpha[1] * p[1], p[2]];
        let z = p[2].max(T::ZERO);
        let shadowed = self.view.length * z + self.view.wo[2] * dot(stretched, stretched).sqrt();
        let shadow = z / shadowed.max(T::SHORTEST) + T::of(LEAST_SHADOW);
        (e / n) * (e / n) / r * shadow
    }

    /// q at a point.
    #[cfg(test)]
    pub(super) fn inverse_root(&self, p: [T; 2]) -> T {
        let (r, _, n, e) = self.parts(self.rectangle.at(p));
        n * r.sqrt() / e
    }
}

impl<T: Scalar> Lobe<T> for GgxLobe<'_, T> {
    fn weight(&self, bump: &Bump<T>, p: [T; 2]) -> T {
        let fall = T::ONE + bump.quadratic(p);
        fall * fall * self.density(p)
    }

    /// The height above the surface, which bounds the light.
    fn height(&self, p: [T; 2]) -> T {
        self.rectangle.at(p)[2]
    }
}
