//! The Gaussian for a surface and a view direction.

use super::{Gaussian, SphericalGaussian};
use ltcforge_fit::math::{Scalar, Triple, dot, minus, plus, scaled, unit};

/// The normal around which the distribution of normals is warped to directions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Warp {
    /// The central visible normal, with the spread of the visible normals and the weight `G2 / G1` of its reflection.
    Visible,
    /// The surface normal, with the spread of all normals and the weight `G2`, as in Wang et al. and Xu et al.
    Surface,
}

/// The Gaussian of a lobe, and its weight.
#[derive(Debug, Clone, Copy)]
pub struct Lobe<T> {
    /// Direction and width.
    pub shape: SphericalGaussian<T>,
    /// The albedo: the reflected light from all directions together, in [0, 1].
    pub weight: T,
    /// Schlick's `(1 - wo . h)^5` at the centre.
    pub schlick: T,
}

impl<T: Scalar> Lobe<T> {
    /// The Gaussian of a surface seen from `wo`.
    ///
    /// Stretch the surface to a hemisphere. Normals visible from `s = A wo / |A wo|` are then `c = u + s`, with `u`
    /// uniform on the cap `u . z > -s . z` [Dupuy and Benyoub 2023]. The centre of the cap is z and its area is
    /// `2 pi (1 + s . z)`. The Gaussian with the same centre and the same density there is `exp(-|u_xy|^2 / v)`,
    /// `v = 2 (1 + s . z)`. Its normal is `h = A (s + z)`, its direction `r = 2 (wo . h) h / h^2 - wo`, and its
    /// deviations are `dr` for `dh = sqrt v A x` and `sqrt v A y`:
    ///
    /// ```text
    /// dr = 2 ((wo . dh) h + (wo . h) dh) / h^2 - 4 (wo . h) (h . dh) h / h^4
    /// ```
    ///
    /// With `s = z` this is the Gaussian `1 / (pi ax ay) exp(-(h_x / ax)^2 - (h_y / ay)^2)` of all normals, of
    /// sharpness `2 / alpha^2`, and its warp around the surface normal. In terms of `exp(L (w . r - 1))`, its sharpness
    /// is `1 / (2 alpha^2)` within the plane of incidence and `1 / (2 alpha^2 cos^2)` across it. The round Gaussian has
    /// their geometric mean, as in Wang et al.
    ///
    /// Domain: `alpha` in [1e-5, 1], `wo` of unit length with `z > 0`.
    #[must_use]
    pub fn new(gaussian: Gaussian, warp: Warp, [alpha_x, alpha_y]: [T; 2], wo: Triple<T>) -> Self {
        let stretch = |w: Triple<T>| [alpha_x * w[0], alpha_y * w[1], w[2]];
        let length = |w: Triple<T>| dot(w, w).sqrt();
        let two = T::of(2.0);
        let wo_stretched = stretch(wo);
        let wo_stretched_length = length(wo_stretched);
        let s = match warp {
            Warp::Visible => scaled(wo_stretched, T::ONE / wo_stretched_length),
            Warp::Surface => [T::ZERO, T::ZERO, T::ONE],
        };
        let h = stretch(plus(s, [T::ZERO, T::ZERO, T::ONE]));
        let (h2, cosine) = (dot(h, h), dot(wo, h));
        let axis = unit(minus(scaled(h, two * cosine / h2), wo));
        let spread = (two * (T::ONE + s[2])).sqrt();
        let moved = |dh: Triple<T>| {
            let along = two * dot(wo, dh) / h2 - T::of(4.0) * cosine * dot(h, dh) / (h2 * h2);
            plus(scaled(h, along), scaled(dh, two * cosine / h2))
        };
        let deviations = [moved([spread * alpha_x, T::ZERO, T::ZERO]), moved([T::ZERO, spread * alpha_y, T::ZERO])];
        // Smith's G2 / G1 at the centre, and G2 with G1 = 2 cos / (cos + |A wo|).
        let up = axis[2].max(T::ZERO);
        let bottom = wo_stretched_length * up + wo[2] * length(stretch(axis));
        let shadowing = (wo[2] + wo_stretched_length) * up / bottom.max(T::of(1e-36));
        let masking = match warp {
            Warp::Visible => T::ONE,
            Warp::Surface => two * wo[2] / (wo[2] + wo_stretched_length),
        };
        let m = (T::ONE - cosine / h2.sqrt()).max(T::ZERO).min(T::ONE);
        Self {
            shape: SphericalGaussian::new(gaussian, axis, deviations),
            weight: (shadowing * masking).min(T::ONE),
            schlick: m * m * m * m * m,
        }
    }

    /// The weight, and the weight times Schlick's factor.
    pub(super) fn parts(&self) -> [T; 2] {
        [self.weight, self.weight * self.schlick]
    }

    /// The density towards a direction, including the weight, per steradian.
    #[must_use]
    pub fn density(&self, w: Triple<T>) -> T {
        self.weight * self.shape.density(w)
    }
}
