//! The albedo of GGX without a table, and compensation for the energy lost by shadowing.
//!
//! A model with a single bounce loses rays that hit other facets. White metal of alpha 1 under uniform light reflects
//! less than half of the light. The missing light is added in proportion to the reflected light [Turquin 2019, after
//! Kulla and Conty 2017; Fdez-Agüera 2019]. With the albedo `E` for a Fresnel factor of one, the factor is
//!
//! ```text
//! 1 + f0 (1 / E - 1)
//! ```
//!
//! White metal then reflects all light, and light that bounces twice is coloured twice. In tables, `E` is the
//! amplitude. Without a table, a cubic polynomial approximates it:
//!
//! ```text
//! 1 - E = p(r, s, a, b)
//! ```
//!
//! `r` is the height `wo_z / |A wo|`. `s` is the shadowed part of the light from the direction that the central visible
//! normal reflects. `a` and `b` are the larger and the smaller roughness. Each term has a factor `s`, `a` or `b`, so a
//! mirror loses nothing. `cargo run --release -p ltcforge-studies -- albedo` finds the coefficients and prints their
//! error.

use super::{LightError, rules::surface_and_view};
use ltcforge_fit::{
    BrdfModel, Configuration,
    math::{Lattice, Scalar, Triple, direction, dot, minus, plus, scaled},
};

/// The coefficients of the cubic, in the order of [`factors`]. `shaders/ltc_albedo.wgsl` has the same coefficients.
#[rustfmt::skip]
pub const LOSS: [f64; 31] = [
    5.363, -16.3138, 16.1379, 0.6751, 2.6458, 13.3242, 12.9676, -2.6392,
    -0.9361, 1.4565, 4.1804, 1.1242, 0.2994, 0.2718, -7.0761, -0.2305,
    0.5096, 0.667, 0.2056, -0.2558, 0.1556, -0.2097, -0.3646, -0.0675,
    -0.3276, -0.3395, 0.7035, 0.7827, -0.3537, 0.0475, -0.2428,
];

/// The smallest albedo. This limit is needed for rough surfaces at grazing views, where the cubic is inaccurate.
const LEAST: f64 = 0.2;

/// The number of samples of [`sampled`].
const SAMPLES: usize = 4096;

/// The four inputs of the cubic for a surface and a view. Domain: as for [`albedo`].
#[must_use]
pub fn inputs<T: Scalar>([alpha_x, alpha_y]: [T; 2], wo: Triple<T>) -> [T; 4] {
    let stretch = |w: Triple<T>| [alpha_x * w[0], alpha_y * w[1], w[2]];
    let length = |w: Triple<T>| dot(w, w).sqrt();
    let wo_stretched = stretch(wo);
    let rise = wo[2] / length(wo_stretched);
    // The central visible normal, not normalised.
    let normal = stretch(plus(scaled(wo_stretched, T::ONE / length(wo_stretched)), [T::ZERO, T::ZERO, T::ONE]));
    let along = T::of(2.0) * dot(wo, normal) / dot(normal, normal);
    let reflected = minus(scaled(normal, along), wo);
    let out = reflected[2].max(T::ZERO) / length(stretch(reflected));
    let lit = (T::ONE + rise) * out / (out + rise);
    [rise, T::ONE - lit, alpha_x.max(alpha_y), alpha_x.min(alpha_y)]
}

/// The terms of the cubic without their coefficients: `s`, `a` and `b`, each times the terms of a quadratic polynomial.
#[must_use]
pub fn factors<T: Scalar>([r, s, a, b]: [T; 4]) -> [T; 31] {
    let one = T::ONE;
    let of_s = [one, r, s, a, b, r * r, r * s, r * a, r * b, s * s, s * a, s * b, a * a, a * b, b * b];
    let of_a = [one, r, a, b, r * r, r * a, r * b, a * a, a * b, b * b];
    let of_b = [one, r, b, r * r, r * b, b * b];
    let mut factors = [T::ZERO; 31];
    let all = of_s.map(|x| s * x).into_iter().chain(of_a.map(|x| a * x)).chain(of_b.map(|x| b * x));
    factors.iter_mut().zip(all).for_each(|(factor, x)| *factor = x);
    factors
}

/// The part of uniform light that GGX reflects, for a Fresnel factor of one, in [0.2, 1]. Domain: `alpha` in [1e-5, 1],
/// `wo` of unit length with `z > 0`.
#[must_use]
pub fn albedo<T: Scalar>(alpha: [T; 2], wo: Triple<T>) -> T {
    let terms = factors(inputs(alpha, wo)).into_iter().zip(LOSS);
    let loss = terms.fold(T::ZERO, |sum, (factor, number)| sum + T::of(number) * factor);
    (T::ONE - loss).max(T::of(LEAST)).min(T::ONE)
}

/// The factor that adds the lost energy to the light of one bounce, for a material of reflectance `f0`. It is at least
/// one if the albedo is at most one. Domain: an albedo above zero.
#[must_use]
pub fn compensation<T: Scalar>(albedo: T, f0: T) -> T {
    T::ONE + f0 * (T::ONE / albedo - T::ONE)
}

/// The albedo of a scattering model for a Fresnel factor of one. It is the mean weight of 4,096 samples, within 1e-3 of
/// its limit.
///
/// # Errors
/// [`LightError::NoFacets`] for a model without facets that shadow each other, [`LightError::Domain`] as for
/// [`by_table`](super::by_table).
pub fn sampled(brdf: &BrdfModel, at: &Configuration) -> Result<f64, LightError> {
    check(brdf)?;
    let (alpha, wo) = surface_and_view(at)?;
    let surface = brdf.surface(alpha);
    let weights = Lattice::new(SAMPLES, [0.0; 2]).points().map(|u| surface.sample(wo, u).weight);
    Ok(weights.sum::<f64>() / SAMPLES as f64)
}

/// The albedo of GGX from the cubic. Checks surface and view.
pub(super) fn of_ggx(at: &Configuration) -> Result<f64, LightError> {
    let (alpha, _) = surface_and_view(at)?;
    Ok(albedo(alpha, direction(at.theta, at.phi).to_array()))
}

/// Returns an error for a scattering model without facets.
pub(super) fn check(brdf: &BrdfModel) -> Result<(), LightError> {
    if brdf.follows_reflection() { Ok(()) } else { Err(LightError::NoFacets(brdf.kind())) }
}

#[cfg(test)]
mod tests;
