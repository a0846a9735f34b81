//! The layers of OpenPBR under an area light: coat and fuzz over a base.
//!
//! `layer(base, coat)` is `f_coat + T (1 - E_coat(wo)) f_base`, with the albedo `E` towards the viewer [OpenPBR 1.1,
//! layering]. No factor depends on the light direction. So if an area light illuminates the layers, the reflected light
//! is the same sum of the light that each layer reflects alone. `shaders/layers.wgsl` has the same functions.

use super::{AreaLight, LightError, ltc::covered, rules::surface_and_view};
use ltcforge_fit::{
    Configuration,
    brdf::{Brdf, Fuzz},
};

/// The light of a base, of which a coat covers the part `weight`:
/// `weight coat + lerp(1, transmittance (1 - albedo), weight) base`.
///
/// `base` and `coat` are the light that each reflects alone. `albedo` is the part of uniform light that the coat
/// reflects towards the viewer. For the lobe of a table, it is `f0 (amplitude - fresnel) + fresnel`. Domain: all
/// arguments except `base` and `coat` are in [0, 1].
#[must_use]
pub fn coated(base: f64, coat: f64, albedo: f64, weight: f64, transmittance: f64) -> f64 {
    weight * coat + (1.0 - weight + weight * transmittance * (1.0 - albedo)) * base
}

/// The light of the layers below, of which fuzz covers the part `weight`: `weight fuzz + (1 - weight albedo) below`.
/// The colour of fuzz is in `fuzz` and not in `albedo`, so transmitted light is not tinted.
#[must_use]
pub fn fuzzed(below: f64, fuzz: f64, albedo: f64, weight: f64) -> f64 {
    weight * fuzz + (1.0 - weight * albedo) * below
}

/// The light that white fuzz of a roughness in [0, 1] reflects, and the albedo of the fuzz. The light is the integral
/// of the LTC of the fuzz model, so it needs no table. The roughnesses of `at` are ignored.
///
/// # Errors
/// [`LightError::Domain`] for a roughness outside [0, 1] or a view direction on or below the horizon.
pub fn by_fuzz<'a>(
    roughness: f64,
    at: &Configuration,
    light: impl Into<AreaLight<'a>>,
) -> Result<[f64; 2], LightError> {
    if !(0.0..=1.0).contains(&roughness) {
        let allowed = "roughness must be from 0 to 1";
        return Err(LightError::Domain { what: "fuzz roughness", value: roughness, allowed });
    }
    let (_, wo) = surface_and_view(&Configuration { alpha_x: 1.0, alpha_y: 1.0, ..*at })?;
    let fuzz = Fuzz::new(roughness);
    let matrix = fuzz.ltc(wo).ok_or(LightError::Singular)?;
    let albedo = fuzz.albedo(wo.z);
    Ok([albedo * covered(&matrix, light.into(), false)?, albedo])
}
