//! Layout `materials`: the numbers of layout [`reflected`](super::reflected) for a few surfaces of given roughness.
//!
//! Alpha and ratio form one axis. Its nodes are pairs, the materials, in the order of the recipe. Nothing is
//! interpolated between materials: a lookup reads the entries of the nearest material in `(sqrt(alpha), ratio)`. Theta
//! and phi are as in layout `reflected`.
//!
//! Textures contain the pairs as well, for shaders that look a material up by its index. The unused channel of the
//! terms stores alpha at the first theta and the ratio at the second. Tables therefore have at least [`LEAST_THETAS`]
//! thetas.

use glam::Vec3;

use super::{
    precision::Precision,
    reflected::Reflected,
    rules::{Interpolation, LayoutRules, LayoutShader, LobeNumbers, ShaderNumbers},
    shader_axes::{ShaderAxes, ShaderPlace},
    spacing::{Spacing, THETA_CEILING},
};
use crate::{
    axes::PerAxis,
    brdf::{LobeTerms, Mirrors},
    math::quadrant,
};

/// The largest number of materials of a table.
pub const MOST_MATERIALS: usize = 256;
/// The smallest number of nodes of theta.
pub const LEAST_THETAS: u32 = 2;

/// The index of the material nearest to a roughness in `(sqrt(alpha), ratio)`; the first if several are equally near.
/// Domain: at least one pair of alpha and ratio.
#[must_use]
pub(crate) fn nearest_material(pairs: impl IntoIterator<Item = [f64; 2]>, alpha: f64, ratio: f64) -> usize {
    let away = |[a, r]: [f64; 2]| {
        let (x, y) = (a.sqrt() - alpha.sqrt(), r - ratio);
        x * x + y * y
    };
    let all = pairs.into_iter().map(away).enumerate();
    all.fold((0, f64::INFINITY), |best, (index, away)| if away < best.1 { (index, away) } else { best }).0
}

pub(super) struct Materials;

impl LayoutRules for Materials {
    fn is_of_materials(&self) -> bool {
        true
    }

    fn default_resolution(&self) -> PerAxis<u32> {
        PerAxis { alpha: 1, ratio: 1, ..Reflected.default_resolution() }
    }

    fn spacing(&self) -> PerAxis<Spacing> {
        PerAxis { alpha: Spacing::Even, ratio: Spacing::Even, ..Reflected.spacing() }
    }

    /// Materials along the diagonal of the range, for recipes without a list of materials.
    fn nodes(&self, range: &PerAxis<[f64; 2]>, n: &PerAxis<u32>) -> PerAxis<Vec<f64>> {
        Reflected.nodes(range, &PerAxis { ratio: n.alpha, ..*n })
    }

    fn is_relative(&self) -> bool {
        true
    }

    fn flattest(&self, precision: Precision) -> f64 {
        Reflected.flattest(precision)
    }

    fn store(&self, place: &PerAxis<f64>, lobe: &LobeNumbers, mirrors: Mirrors, precision: Precision) -> LobeNumbers {
        Reflected.store(place, lobe, mirrors, precision)
    }

    fn store_terms(&self, place: &PerAxis<f64>, terms: LobeTerms) -> LobeTerms {
        Reflected.store_terms(place, terms)
    }

    fn restore(&self, place: &PerAxis<f64>, stored: &LobeNumbers) -> LobeNumbers {
        Reflected.restore(place, stored)
    }

    /// `alpha` is the index of the material.
    fn place_in_shader(&self, axes: &ShaderAxes, alpha: f32, _: f32, wo: Vec3) -> ShaderPlace {
        let theta = quadrant(wo.truncate().length(), wo.z) / THETA_CEILING as f32;
        let u = 1.0 - (1.0 - theta).max(0.0).sqrt();
        let mut place = axes.place([alpha, 0.0, u, quadrant(wo.y, wo.x)]);
        let [low, high] = axes.around(place.lower).map(|u| (2.0 - u[2]) * u[2]);
        place.weight[2] = ((theta - low) / (high - low)).clamp(0.0, 1.0);
        place
    }

    fn restore_in_shader(&self, stored: &ShaderNumbers, alpha: f32, ratio: f32, wo: Vec3) -> ShaderNumbers {
        Reflected.restore_in_shader(stored, alpha, ratio, wo)
    }

    /// The prediction of layout `reflected`, without the error between surfaces.
    fn interpolation(&self) -> Interpolation {
        let Interpolation { limit, step } = Reflected.interpolation();
        Interpolation { limit, step: PerAxis { alpha: 0.0, ratio: 0.0, ..step } }
    }

    fn shader(&self) -> LayoutShader {
        LayoutShader {
            sources: &[ltcforge_wgsl::LAYOUT_REFLECTED, ltcforge_wgsl::PLACE_MATERIALS],
            restore: "ltc_restore_reflected",
            place: "ltc_place_materials",
            is_isotropic: false,
            number: 8,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::{f64::consts::FRAC_PI_2, ops::ControlFlow};

    use super::*;
    use crate::{
        BrdfKind, Configuration, FITTER_VERSION, FitSettings, GivenNodes, Layout, LobeModel, Metric, Plan, Recipe,
        Solver, StoredTerms, Table, fit_plan, report,
    };

    const PAIRS: [[f64; 2]; 3] = [[0.5, 0.3], [0.09, 1.0], [0.3, 0.3]];

    fn fitted(layout: Layout, pairs: &[[f64; 2]]) -> Table {
        let extent = |axis: usize| {
            let values = || pairs.iter().map(|pair| pair[axis]);
            [values().fold(1.0, f64::min), values().fold(0.0, f64::max)]
        };
        let given =
            if layout.is_of_materials() { GivenNodes::default().with_materials(pairs) } else { GivenNodes::default() };
        let recipe = Recipe {
            fitter: FITTER_VERSION,
            brdf: BrdfKind::Ggx.into(),
            lobe: LobeModel::Ltc,
            layout,
            resolution: PerAxis { alpha: pairs.len() as u32, ratio: 1, theta: 4, phi: 3 },
            range: PerAxis { alpha: extent(0), ratio: extent(1), theta: [0.0, FRAC_PI_2], phi: [0.0, FRAC_PI_2] },
            given,
            fit: FitSettings {
                metric: Metric::Sw1,
                solver: Solver::Bfgs,
                samples: 64,
                directions: 4,
                steps: 5,
                seed: 0,
                simplex: None,
            },
            terms: StoredTerms::F82,
            precision: Precision::F32,
        };
        fit_plan(&Plan::new(&recipe), &|_| ControlFlow::Continue(())).expect("nothing stops it")
    }

    /// The entries of a material equal the entries of layout `reflected` for its roughness alone.
    #[test]
    fn each_material_has_the_entries_of_its_own_table() {
        let table = fitted(Layout::Materials, &PAIRS);
        assert_eq!(table.lengths(), PerAxis { alpha: 3, ratio: 1, theta: 4, phi: 3 });
        for (material, pair) in PAIRS.iter().enumerate() {
            let own = fitted(Layout::Reflected, &[*pair]);
            let entries = material * 12..(material + 1) * 12;
            assert_eq!(table.matrix[entries.clone()], own.matrix);
            let [all, alone] = [&table, &own].map(|table| table.terms.as_ref().expect("terms"));
            assert_eq!(all.edge.as_ref().expect("F82")[entries.clone()], *alone.edge.as_ref().expect("F82"));
            assert_eq!(all.fresnel[entries], alone.fresnel);
            for (theta, phi) in [(0.0, 0.0), (0.7, 4.0), (1.2, 2.0)] {
                let wanted = own.lookup(&Configuration { alpha_x: pair[0], alpha_y: pair[0] * pair[1], theta, phi });
                assert_eq!(table.lookup_material(material, theta, phi), Some(wanted));
                // Tests the material turned by a right angle. Rounding can move its ratio away from the material's
                // ratio.
                let [alpha_x, alpha_y] = [pair[0] * pair[1], pair[0]];
                let turned = Configuration { alpha_x, alpha_y, theta, phi };
                assert_eq!(table.lookup(&turned), own.lookup(&turned));
            }
        }
        assert_eq!(table.lookup_material(3, 0.0, 0.0), None);
    }

    #[test]
    fn a_report_measures_the_materials_and_nothing_between_them() {
        let table = fitted(Layout::Materials, &PAIRS);
        let range = PerAxis { alpha: [0.09, 0.5], ratio: [0.3, 1.0], theta: [0.0, FRAC_PI_2], phi: [0.0, FRAC_PI_2] };
        let all = report(&table, &range, 64);
        let own: Vec<f64> = PAIRS
            .iter()
            .map(|pair| {
                let alone = fitted(Layout::Reflected, &[*pair]);
                report(&alone, &range, 64).between.width.mean
            })
            .collect();
        let mean = own.iter().sum::<f64>() / 3.0;
        assert!((all.between.width.mean / mean - 1.0).abs() < 0.2, "{} {own:?}", all.between.width.mean);
        assert_eq!((all.floors.theta.nodes, all.floors.theta.entries, all.matrices.entries), (1, 9, 36));
    }

    #[test]
    fn the_nearest_material_is_the_first_of_the_nearest() {
        assert_eq!(nearest_material(PAIRS, 0.31, 0.35), 2);
        assert_eq!(nearest_material(PAIRS, 0.04, 0.9), 1);
        assert_eq!(nearest_material([PAIRS[0], PAIRS[0]], 0.5, 0.3), 0);
    }
}
