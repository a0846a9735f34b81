//! The reflected and the transmitted albedo of rough glass [Walter et al. 2007], for light that enters the glass.
//!
//! The normals are those of GGX. Masking is height-correlated Smith, `1 / (1 + Lambda(o) + Lambda(i))` on both sides.
//! Each normal reflects the part `F` of the light, by the Fresnel equations for unpolarised light, and refracts the rest.
//! Light that is masked is lost, so the sum of both albedos is at most one.

use std::f64::consts::{FRAC_PI_2, PI};

use super::{
    ggx::reflected,
    quadrature::{RULES, asinh, sinh_cosh},
};
use crate::math::sin_cos;

/// The numbers of azimuths in each quarter, of slopes up to one, and of larger slopes. With them, the transmitted albedo
/// differs by at most 3e-7 from that with 64, 160 and 48, at 400 places.
const NODES: [usize; 3] = [14, 24, 14];

/// The part of the light that a flat interface reflects. `eta` is the index behind over the index in front. Domain:
/// `eta` from 1.
pub(super) fn dielectric(cosine: f64, eta: f64) -> f64 {
    let cosine = cosine.max(1e-9);
    let refracted = (1.0 - (1.0 - cosine * cosine) / (eta * eta)).max(0.0).sqrt();
    let s = (cosine - eta * refracted) / (cosine + eta * refracted);
    let p = (eta * cosine - refracted) / (eta * cosine + refracted);
    0.5 * (s * s + p * p)
}

/// The reflected and the transmitted albedo. Domain: `eta` from 1, alpha in [1e-4, 1], cosine in [1e-3, 1].
pub(super) fn glass(eta: f64, alpha: f64, cosine: f64) -> [f64; 2] {
    let [reflected] = reflected(alpha, cosine, true, |weight, incident| [weight * dielectric(incident, eta)]);
    [reflected, transmitted(eta, alpha, cosine)]
}

/// As for the reflection, the integral runs over the slope of the normal in polar coordinates `r`, `phi`. All normals
/// that face the view, `1 + r t cos(phi) > 0`, refract light downwards. The variables are `psi` as for the reflection, in
/// two parts, because the end of the slopes is not smooth at `cos(phi) = 0`; `x` with `r = alpha sinh(x)` up to `r = 1`;
/// and `v` with `1 / r = cos(theta_o) sinh(v)` above.
fn transmitted(eta: f64, alpha: f64, cosine: f64) -> f64 {
    let cosine = cosine.min(1.0 - 1e-12);
    let (alpha2, tangent) = (alpha * alpha, (1.0 - cosine * cosine).sqrt() / cosine);
    let view = (1.0 + alpha2 * tangent * tangent).sqrt();
    let widest = asinh(tangent);
    let around = |psi: f64| {
        let (sin_psi, cos_psi) = sin_cos(psi);
        // `slope` is `t cos(phi)`.
        let (slope, cosh) = sinh_cosh(widest * cos_psi);
        let azimuth = widest * sin_psi * cosh / ((tangent - slope) * (tangent + slope)).sqrt();
        let passed = |r: f64| {
            let normal = 1.0 / (1.0 + r * r).sqrt();
            let facing = (1.0 + r * slope).max(0.0);
            let incident = (cosine * facing * normal).min(1.0);
            let refracted = (1.0 - (1.0 - incident * incident) / (eta * eta)).max(0.0).sqrt();
            // The height of the refracted direction below the surface.
            let z = cosine / eta + (refracted - incident / eta) * normal;
            let light = (z * z + alpha2 * (1.0 - z * z).max(0.0)).sqrt();
            4.0 * facing * z / (z * view + light) * (1.0 - dielectric(incident, eta))
        };
        let least = (-slope).max(0.0);
        let [inner] = RULES[NODES[1]].integrate(0.0, asinh(1.0 / (alpha * least.max(1.0))), |x| {
            let (sinh, cosh) = sinh_cosh(x);
            [sinh / (cosh * cosh * cosh) * passed(alpha * sinh)]
        });
        if least >= 1.0 {
            return [azimuth * inner];
        }
        let [outer] = RULES[NODES[2]].integrate(asinh(least / cosine), asinh(1.0 / cosine), |v| {
            let (sinh, cosh) = sinh_cosh(v);
            let inverse = cosine * sinh;
            let density = alpha2 * inverse / (alpha2 * inverse * inverse + 1.0).powi(2);
            [density * cosine * cosh * passed(1.0 / inverse)]
        });
        [azimuth * (inner + outer)]
    };
    let [[near], [far]] = [0.0, FRAC_PI_2].map(|from| RULES[NODES[0]].integrate(from, from + FRAC_PI_2, around));
    (near + far) / PI
}
