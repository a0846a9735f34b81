//! Layout `reflected`, the default. Nodes are denser where lobes change faster. Entries are `K^-1 M` with the
//! [`Reflection`] `K`.
//!
//! Nodes are uniform in `u`, with alpha = `u^1.6`, ratio = `u^1.3`, theta = `1 - (1 - u)^2` of the way to its ceiling,
//! and phi = `u pi/2`. The first node is at the lower end of the range or at the floor, and the last node is at the
//! upper end. A range that covers only a part of the domain is divided in the same way.

use glam::{Mat3, Vec3};

use super::{
    precision::Precision,
    reflection::Reflection,
    rules::{Interpolation, LayoutRules, LayoutShader, LobeNumbers, ShaderNumbers},
    shader_axes::{ShaderAxes, ShaderPlace},
    spacing::{ALPHA_FLOOR, RATIO_FLOOR, Spacing, THETA_CEILING, below_ceiling},
};
use crate::{
    axes::{LEAST_ALPHA, PerAxis},
    brdf::{LobeTerms, Mirrors},
    lobe::ltc::align_to,
    math::{pow, quadrant},
};

pub(super) struct Reflected;

impl LayoutRules for Reflected {
    /// At most as many entries as the paper's 8^4, with more nodes on the axes where nodes reduce the error most.
    fn default_resolution(&self) -> PerAxis<u32> {
        PerAxis { alpha: 10, ratio: 6, theta: 9, phi: 7 }
    }

    fn spacing(&self) -> PerAxis<Spacing> {
        PerAxis { alpha: Spacing::Power(1.6), ratio: Spacing::Power(1.3), theta: Spacing::Grazing, phi: Spacing::Even }
    }

    fn nodes(&self, range: &PerAxis<[f64; 2]>, n: &PerAxis<u32>) -> PerAxis<Vec<f64>> {
        let PerAxis { alpha, ratio, theta, phi } = self.spacing();
        PerAxis {
            alpha: alpha.divide(range.alpha.map(|alpha| alpha.max(ALPHA_FLOOR)), n.alpha),
            ratio: ratio.divide(range.ratio.map(|ratio| ratio.max(RATIO_FLOOR)), n.ratio),
            theta: theta.divide(below_ceiling(range.theta), n.theta),
            phi: phi.divide(range.phi, n.phi),
        }
    }

    fn is_relative(&self) -> bool {
        true
    }

    fn flattest(&self, precision: Precision) -> f64 {
        match precision {
            Precision::F32 => 1e-5,
            Precision::F16 => 1.0 / 256.0,
        }
    }

    fn store(&self, place: &PerAxis<f64>, lobe: &LobeNumbers, mirrors: Mirrors, precision: Precision) -> LobeNumbers {
        let reflection = Reflection::at(place);
        LobeNumbers {
            matrix: align_to(&reflection.matrix, &lobe.matrix, mirrors, self.flattest(precision)),
            terms: reflection.relative_terms(lobe.terms),
        }
    }

    fn store_terms(&self, place: &PerAxis<f64>, terms: LobeTerms) -> LobeTerms {
        Reflection::at(place).relative_terms(terms)
    }

    fn restore(&self, place: &PerAxis<f64>, stored: &LobeNumbers) -> LobeNumbers {
        let reflection = Reflection::at(place);
        LobeNumbers { matrix: reflection.matrix * stored.matrix, terms: reflection.terms(stored.terms) }
    }

    fn place_in_shader(&self, axes: &ShaderAxes, alpha: f32, ratio: f32, wo: Vec3) -> ShaderPlace {
        let power = |x: f32, y: f64| pow(f64::from(x), y) as f32;
        let theta = quadrant(wo.truncate().length(), wo.z) / THETA_CEILING as f32;
        let u = 1.0 - (1.0 - theta).max(0.0).sqrt();
        let mut place = axes.place([power(alpha, 0.625), power(ratio, 1.0 / 1.3), u, quadrant(wo.y, wo.x)]);
        let [below, above] = axes.around(place.lower);
        let values = |u: [f32; 4]| [power(u[0], 1.6), power(u[1], 1.3), (2.0 - u[2]) * u[2]];
        let (low, high) = (values(below), values(above));
        for (i, x) in [alpha, ratio, theta].into_iter().enumerate() {
            place.weight[i] = ((x - low[i]) / (high[i] - low[i])).clamp(0.0, 1.0);
        }
        place
    }

    fn restore_in_shader(&self, stored: &ShaderNumbers, alpha_x: f32, ratio: f32, wo: Vec3) -> ShaderNumbers {
        let alpha = Vec3::new(alpha_x, (alpha_x * ratio).max(LEAST_ALPHA as f32), 1.0);
        let stretched = alpha * wo;
        let size = stretched.length();
        let wm = (alpha * (stretched / size + Vec3::Z)).normalize();
        let d = wo.dot(wm);
        let r = 2.0 * d * wm - wo;
        let column = |s: Vec3| {
            let flat = 2.0 * alpha_x * Vec3::new(s.x, s.y, 0.0);
            d * flat - r.dot(flat) * wm + s.z * r
        };
        let s = &stored.matrix;
        let matrix = Mat3::from_cols(column(s.x_axis), column(s.y_axis), column(s.z_axis));
        let height = r.z.abs();
        let g2_over_g1 = height * (size + wo.z) / (height * size + wo.z * (alpha * r).length()).max(1e-30);
        let amplitude = stored.amplitude * g2_over_g1 * g2_over_g1;
        let grazing = (stored.fresnel + 1.0 - d).max(0.0);
        let grazing2 = grazing * grazing;
        ShaderNumbers { matrix, amplitude, fresnel: amplitude * (grazing2 * grazing2 * grazing) }
    }

    // Measured in a full run of docs/tradeoff.md, with preset `draft` and one axis changed at a time. Each number in
    // `step` is the added error divided by the difference of the squared steps.
    fn interpolation(&self) -> Interpolation {
        Interpolation { limit: 0.0463, step: PerAxis { alpha: 0.02, ratio: 0.018, theta: 0.137, phi: 0.01 } }
    }

    fn shader(&self) -> LayoutShader {
        LayoutShader {
            sources: &[ltcforge_wgsl::PLACE_REFLECTED, ltcforge_wgsl::LAYOUT_REFLECTED],
            restore: "ltc_restore_reflected",
            place: "ltc_place_reflected",
            is_isotropic: false,
            number: 1,
        }
    }
}

impl Reflection {
    /// The inverse of [`Reflection::terms`]. Domain: an amplitude above zero, as every lobe of a view above the horizon
    /// has.
    fn relative_terms(&self, terms: LobeTerms) -> LobeTerms {
        let grazing = pow(terms.fresnel / terms.amplitude, 0.2);
        LobeTerms { amplitude: terms.amplitude / self.amplitude, fresnel: grazing - self.grazing }
    }
}
