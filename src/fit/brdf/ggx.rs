//! Anisotropic GGX with height-correlated Smith masking.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};

use super::scattering::{Brdf, BrdfRules, BrdfSample, LobeTerms};
use crate::math::SquarePoint;

/// The anisotropic GGX reflector of KT et al. 2022, section 3.1, with a Fresnel factor of one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ggx {
    /// Roughness along x, in (0, 1].
    pub alpha_x: f64,
    /// Roughness along y, in (0, 1].
    pub alpha_y: f64,
}

/// GGX as an item of [`super::BrdfKind`].
pub(super) struct GgxRules;

impl BrdfRules for GgxRules {
    fn surface(&self, [alpha_x, alpha_y]: [f64; 2]) -> Box<dyn Brdf> {
        Box::new(Ggx { alpha_x, alpha_y })
    }
}

impl Ggx {
    /// Density of microfacet normals: `D(wm) = 1 / (pi ax ay (x^2/ax^2 + y^2/ay^2 + z^2)^2)`
    /// [KT et al. 2022, equation 4]. Per steradian; zero below the horizon.
    #[must_use]
    pub fn distribution(&self, wm: DVec3) -> f64 {
        if wm.z <= 0.0 {
            return 0.0;
        }
        let (x, y) = (wm.x / self.alpha_x, wm.y / self.alpha_y);
        let q = x * x + y * y + wm.z * wm.z;
        1.0 / (PI * self.alpha_x * self.alpha_y * q * q)
    }

    /// Smith's `Lambda(w) = (sqrt(1 + (ax^2 x^2 + ay^2 y^2) / z^2) - 1) / 2` [KT et al. 2022, equation 5]. Domain:
    /// `w.z != 0`; unbounded towards the horizon.
    #[must_use]
    pub fn smith_lambda(&self, w: DVec3) -> f64 {
        let (x, y) = (self.alpha_x * w.x / w.z, self.alpha_y * w.y / w.z);
        0.5 * ((1.0 + (x * x + y * y)).sqrt() - 1.0)
    }

    /// `G2 / G1(wo) = (1 + Lambda(wo)) / (1 + Lambda(wo) + Lambda(wi))`, the weight of a reflected visible normal
    /// [KT et al. 2022, section 3.1]. In [0, 1]; zero when `wi` is below the horizon.
    #[must_use]
    pub fn g2_over_g1(&self, wo: DVec3, wi: DVec3) -> f64 {
        if wi.z <= 0.0 {
            return 0.0;
        }
        let one_plus_lambda = 1.0 + self.smith_lambda(wo);
        one_plus_lambda / (one_plus_lambda + self.smith_lambda(wi))
    }

    /// Precomputes the quantities of a view direction that the sampler uses.
    fn view(&self, wo: DVec3) -> GgxView {
        let stretched = DVec3::new(self.alpha_x * wo.x, self.alpha_y * wo.y, wo.z);
        GgxView {
            alpha: DVec2::new(self.alpha_x, self.alpha_y),
            wo,
            wo_std: stretched.normalize(),
            mu: wo.z / stretched.length(),
        }
    }
}

/// A surface with a view direction.
struct GgxView {
    alpha: DVec2,
    wo: DVec3,
    /// `wo` in the space where the surface is a hemisphere.
    wo_std: DVec3,
    /// `wo.z / |A wo|`.
    mu: f64,
}

impl GgxView {
    /// A normal visible from `wo`, drawn by spherical caps [Dupuy and Benyoub 2023].
    ///
    /// If the surface is stretched to a hemisphere, normals visible from `wo_std` reflect it to directions that are
    /// uniform on the cap `z > -wo_std.z`.
    #[inline]
    fn visible_normal(&self, point: &SquarePoint) -> DVec3 {
        let Self { alpha, wo_std, .. } = *self;
        let z = (1.0 - point.u[1]) * (1.0 + wo_std.z) - wo_std.z;
        let radius = (1.0 - z * z).max(0.0).sqrt();
        let wm_std = DVec3::new(radius * point.cos + wo_std.x, radius * point.sin + wo_std.y, z + wo_std.z);
        DVec3::new(alpha.x * wm_std.x, alpha.y * wm_std.y, wm_std.z.max(0.0)).normalize()
    }

    /// With `mu = z / |A w|`, `Lambda = (1 / mu - 1) / 2`, and `G2 / G1 = (1 + mu_o) mu_i / (mu_i + mu_o)`. The code
    /// multiplies numerator and denominator by `|A wi|`.
    #[inline]
    fn sample(&self, point: &SquarePoint) -> BrdfSample {
        let wm = self.visible_normal(point);
        let cos_theta_d = self.wo.dot(wm);
        let wi = 2.0 * cos_theta_d * wm - self.wo;
        let (x, y) = (self.alpha.x * wi.x, self.alpha.y * wi.y);
        let stretched = (x * x + y * y + wi.z * wi.z).sqrt();
        let weight = (1.0 + self.mu) * wi.z / (wi.z + self.mu * stretched);
        BrdfSample { wi, weight: if wi.z > 0.0 { weight } else { 0.0 }, cos_theta_d }
    }
}

/// The number of reflections computed together. It is fixed, so results do not depend on the processor's vector width.
const LANES: usize = 8;

impl GgxView {
    /// The terms, as means over the samples of [`GgxView::sample`] at `points`, computed in f32. Directions are not
    /// normalised, because the weight depends only on the ratios of their components. The means keep all digits that a
    /// table stores.
    fn terms(&self, points: &[SquarePoint]) -> LobeTerms {
        let [alpha_x, alpha_y, mu] = [self.alpha.x, self.alpha.y, self.mu].map(|x| x as f32);
        let (wo, wo_std) = (self.wo.as_vec3(), self.wo_std.as_vec3());
        let mut sums = [[0.0_f64; LANES]; 2];
        for chunk in points.chunks(LANES) {
            // Padding of the last chunk has a count of zero.
            let [mut cap, mut sin, mut cos, mut counts] = [[0.0_f32; LANES]; 4];
            for (k, point) in chunk.iter().enumerate() {
                (cap[k], sin[k], cos[k], counts[k]) =
                    ((1.0 - point.u[1]) as f32, point.sin as f32, point.cos as f32, 1.0);
            }
            let [mut amplitude, mut fresnel] = [[0.0_f32; LANES]; 2];
            for k in 0..LANES {
                let z = cap[k] * (1.0 + wo_std.z) - wo_std.z;
                let radius = (1.0 - z * z).max(0.0).sqrt();
                let (x, y) = (alpha_x * (radius * cos[k] + wo_std.x), alpha_y * (radius * sin[k] + wo_std.y));
                let up = (z + wo_std.z).max(0.0);
                let length2 = x * x + y * y + up * up;
                let cosine = wo.x * x + wo.y * y + wo.z * up;
                let [wx, wy, wz] = [[x, wo.x], [y, wo.y], [up, wo.z]].map(|[m, o]| 2.0 * cosine * m - o * length2);
                let (sx, sy) = (alpha_x * wx, alpha_y * wy);
                let stretched = (sx * sx + sy * sy + wz * wz).sqrt();
                let weight = (1.0 + mu) * wz / (wz + mu * stretched);
                // Rounding can raise the weight of a mirror above one.
                let weight = if wz > 0.0 { weight.min(1.0) } else { 0.0 };
                let grazing = (1.0 - cosine / length2.sqrt()).max(0.0);
                let grazing2 = grazing * grazing;
                amplitude[k] = weight * counts[k];
                fresnel[k] = amplitude[k] * (grazing2 * grazing2 * grazing);
            }
            for k in 0..LANES {
                sums[0][k] += f64::from(amplitude[k]);
                sums[1][k] += f64::from(fresnel[k]);
            }
        }
        let [amplitude, fresnel] = sums.map(|lanes| lanes.iter().sum::<f64>() / points.len() as f64);
        LobeTerms { amplitude, fresnel }
    }
}

impl Brdf for Ggx {
    /// `D(wm) G2(wo, wi) / (4 cos(theta_o))` [KT et al. 2022, equation 6].
    fn eval_cos(&self, wo: DVec3, wi: DVec3) -> f64 {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        let g2 = 1.0 / (1.0 + self.smith_lambda(wo) + self.smith_lambda(wi));
        self.distribution((wo + wi).normalize()) * g2 / (4.0 * wo.z)
    }

    fn sample(&self, wo: DVec3, u: [f64; 2]) -> BrdfSample {
        self.view(wo).sample(&SquarePoint::new(u))
    }

    fn sample_all(&self, wo: DVec3, points: &[SquarePoint], drawn: &mut Vec<BrdfSample>) {
        let view = self.view(wo);
        drawn.extend(points.iter().map(|point| view.sample(point)));
    }

    fn terms(&self, wo: DVec3, points: &[SquarePoint]) -> LobeTerms {
        self.view(wo).terms(points)
    }

    /// `D(wm) G1(wo) / (4 cos(theta_o))`. Directions below the horizon have a density too, because the sampler draws
    /// them.
    fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        let sum = wo + wi;
        if wo.z <= 0.0 || sum.z <= 0.0 {
            return 0.0;
        }
        self.distribution(sum.normalize()) / (4.0 * wo.z * (1.0 + self.smith_lambda(wo)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Lattice, direction};

    /// Lobes from broad to needle-shaped, seen from above and at grazing angles: `(alpha_x, alpha_y, theta, phi)`.
    const CONFIGURATIONS: [(f64, f64, f64, f64); 5] = [
        (1.0, 1.0, 0.0, 0.0),
        (0.5, 0.5, 0.8, 0.3),
        (0.6, 0.2, 1.1, 0.9),
        (0.3, 0.9, 1.4, 2.5),
        (0.25, 0.15, 0.4, 4.0),
    ];

    /// Compares the terms in f32 lanes with a loop in f64, for broad and narrow lobes and for incomplete last chunks.
    #[test]
    fn the_terms_are_means_over_samples() {
        let sharp = [(1e-3, 1e-3, 1.55, 0.2), (1e-5, 1e-5, 0.3, 1.0), (0.8, 1e-4, 1.57, 1.2), (1e-8, 1e-8, 1.2, 2.0)];
        for (alpha_x, alpha_y, theta, phi) in CONFIGURATIONS.into_iter().chain(sharp) {
            let (ggx, wo) = (Ggx { alpha_x, alpha_y }, direction(theta, phi));
            for count in [1, 7, 8, 513] {
                let points: Vec<SquarePoint> = Lattice::new(count, [0.3, 0.6]).points().map(SquarePoint::new).collect();
                let LobeTerms { amplitude, fresnel } = ggx.terms(wo, &points);
                let mean = |of: fn(BrdfSample) -> f64| {
                    points.iter().map(|point| of(ggx.sample(wo, point.u))).sum::<f64>() / count as f64
                };
                let wanted = [mean(|s| s.weight), mean(|s| s.weight * (1.0 - s.cos_theta_d).max(0.0).powi(5))];
                assert!((amplitude - wanted[0]).abs() < 2e-6, "{ggx:?} {theta} {count}: {amplitude} {wanted:?}");
                assert!((fresnel - wanted[1]).abs() < 2e-6, "{ggx:?} {theta} {count}: {fresnel} {wanted:?}");
            }
        }
    }
}
