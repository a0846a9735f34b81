//! Layout `kt2022`: uniform axes, and `M` itself [KT et al. 2022, sections 6 to 8].
//!
//! Nodes are uniform in alpha, ratio, theta and phi. A node below a floor is raised to the floor. The range of theta is
//! clamped to the ceiling before it is divided into steps.

use glam::Vec3;

use super::{
    precision::Precision,
    rules::{Interpolation, LayoutRules, LayoutShader, LobeNumbers, ShaderNumbers},
    shader_axes::{ShaderAxes, ShaderPlace},
    spacing::{ALPHA_FLOOR, RATIO_FLOOR, Spacing, below_ceiling},
};
use crate::{
    axes::PerAxis,
    brdf::{LobeTerms, Mirrors},
    lobe::ltc::align,
    math::quadrant,
};

pub(super) struct Kt2022;

impl LayoutRules for Kt2022 {
    /// The paper's resolution.
    fn default_resolution(&self) -> PerAxis<u32> {
        PerAxis { alpha: 8, ratio: 8, theta: 8, phi: 8 }
    }

    fn spacing(&self) -> PerAxis<Spacing> {
        PerAxis { alpha: Spacing::Even, ratio: Spacing::Even, theta: Spacing::Even, phi: Spacing::Even }
    }

    fn nodes(&self, range: &PerAxis<[f64; 2]>, n: &PerAxis<u32>) -> PerAxis<Vec<f64>> {
        let PerAxis { alpha, ratio, theta, phi } = self.spacing();
        let above = |nodes: Vec<f64>, floor: f64| nodes.into_iter().map(|x| x.max(floor)).collect();
        PerAxis {
            alpha: above(alpha.divide(range.alpha, n.alpha), ALPHA_FLOOR),
            ratio: above(ratio.divide(range.ratio, n.ratio), RATIO_FLOOR),
            theta: theta.divide(below_ceiling(range.theta), n.theta),
            phi: phi.divide(range.phi, n.phi),
        }
    }

    /// The limit applies to the block of `M` itself. It is ten times larger than f32 needs. With this limit, a shader's
    /// inverse of a needle-shaped lobe at the horizon has an error below 1e-3.
    fn flattest(&self, precision: Precision) -> f64 {
        match precision {
            Precision::F32 => 1e-4,
            Precision::F16 => 1.0 / 256.0,
        }
    }

    fn store(&self, place: &PerAxis<f64>, lobe: &LobeNumbers, mirrors: Mirrors, precision: Precision) -> LobeNumbers {
        LobeNumbers {
            matrix: align(&lobe.matrix, mirrors, self.flattest(precision)),
            terms: self.store_terms(place, lobe.terms),
        }
    }

    fn store_terms(&self, _: &PerAxis<f64>, terms: LobeTerms) -> LobeTerms {
        terms
    }

    fn restore(&self, _: &PerAxis<f64>, stored: &LobeNumbers) -> LobeNumbers {
        *stored
    }

    fn place_in_shader(&self, axes: &ShaderAxes, alpha: f32, ratio: f32, wo: Vec3) -> ShaderPlace {
        let [theta, phi] = [(wo.truncate().length(), wo.z), (wo.y, wo.x)].map(|(y, x)| quadrant(y, x));
        let mut place = axes.place([alpha, ratio, theta, phi]);
        let [below, above] = axes.around(place.lower);
        for (i, (x, least)) in [(alpha, axes.roughness[0]), (ratio, axes.roughness[2])].into_iter().enumerate() {
            let below = below[i].max(least);
            place.weight[i] = ((x - below) / (above[i] - below)).clamp(0.0, 1.0);
        }
        place
    }

    fn restore_in_shader(&self, stored: &ShaderNumbers, _: f32, _: f32, _: Vec3) -> ShaderNumbers {
        *stored
    }

    // Measured in a full run of docs/tradeoff.md, with preset `draft` and one axis changed at a time. Each number in
    // `step` is the added error divided by the difference of the squared steps.
    fn interpolation(&self) -> Interpolation {
        Interpolation { limit: 0.0652, step: PerAxis { alpha: 0.5, ratio: 0.04, theta: 1.25, phi: 3.25 } }
    }

    fn shader(&self) -> LayoutShader {
        LayoutShader {
            sources: &[ltcforge_wgsl::LAYOUT_KT2022],
            restore: "ltc_restore_kt2022",
            place: "ltc_place_kt2022",
            is_isotropic: false,
            number: 0,
        }
    }
}
