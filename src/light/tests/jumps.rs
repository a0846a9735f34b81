//! Tests that closed forms do not jump along random paths.

use glam::DQuat;
use rayon::prelude::*;

use crate::LightModel;
use crate::cases::{Draw, Roughness, jump};
use ltcforge_fit::Sides;

/// Lights turn about the shaded point. They rise and set, and their edges cross the mirror direction. At the same time
/// the view sinks and the surface turns.
#[test]
fn nothing_jumps_along_random_paths() {
    for roughness in [Roughness::All, Roughness::Anisotropic, Roughness::Extreme] {
        let models = [LightModel::Normals, LightModel::LtcFormula];
        for form in models.into_iter().flat_map(LightModel::closed_forms) {
            let most = |seed: u64| {
                let mut draw = Draw::new(2000 + seed);
                let lit = draw.lit_by(roughness, [0.05, 50.0]);
                let axis = draw.vector().normalize();
                let [angle, phi] = [0.0, 0.0].map(|_: f64| draw.within(-1.0, 1.0));
                let theta = draw.within(0.0, 1.5);
                jump(|t| {
                    let mut moved = lit.clone();
                    let turn = DQuat::from_axis_angle(axis, angle * (t - 0.5));
                    moved.vertices.iter_mut().for_each(|v| *v = turn * *v);
                    moved.at.phi += 0.1 * phi * t;
                    moved.at.theta += (theta - lit.at.theta) * 0.1 * t;
                    let light = moved.light(Sides::Two);
                    let metal = form.reflected(&moved.at, &light).expect("a surface").energy;
                    // The lobe of this model depends on the material.
                    let is_shaped = form.model() == LightModel::LtcFormula;
                    let plastic = is_shaped.then(|| form.of_material(&moved.at, &light, [0.04, 1.0]));
                    metal + plastic.map_or(0.0, |light| light.expect("a surface"))
                })
            };
            let most = (0..1000).into_par_iter().map(most).reduce(|| 0.0, f64::max);
            println!("{roughness:?}, {form:?}: jumps by {most:.1e} at most");
            assert!(most < 1e-7, "{roughness:?}, {form:?}: {most}");
        }
    }
}
