//! Where a continuous function jumps, and whether the closed form does so along random paths.

use glam::DQuat;
use rayon::prelude::*;

use crate::cases::{Draw, Roughness};
use crate::{NormalsRule, by_normals};
use ltcforge_fit::Sides;

/// A hundredth of a path is halved so often that lobes of roughness 1e-5 change over it by 1e-8.
const HALVINGS: u32 = 36;

/// The largest change of a function over an interval in [0, 1] that is as good as a point: halves of the three of a
/// hundred intervals over which it changes most, each time the half over which it changes more.
pub(crate) fn jump(of: impl Fn(f64) -> f64) -> f64 {
    let mut steps: Vec<[f64; 2]> = (0..100).map(|i| [i, i + 1].map(|i| f64::from(i) / 100.0)).collect();
    let change = |[from, to]: [f64; 2]| (of(to) - of(from)).abs();
    steps.sort_by_cached_key(|step| std::cmp::Reverse((change(*step) * 1e12) as u64));
    let narrowed = steps.into_iter().take(3).map(|mut step| {
        for _ in 0..HALVINGS {
            let middle = 0.5 * (step[0] + step[1]);
            let halves = [[step[0], middle], [middle, step[1]]];
            step = if change(halves[0]) > change(halves[1]) { halves[0] } else { halves[1] };
        }
        change(step)
    });
    narrowed.fold(0.0, f64::max)
}

/// Lights turn about the shaded point, which rises and sets them and lets their edges pass the mirror direction, while
/// the view sinks and the surface turns.
#[test]
fn nothing_jumps_along_random_paths() {
    for roughness in [Roughness::All, Roughness::Anisotropic, Roughness::Extreme] {
        for rule in NormalsRule::ALL {
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
                    by_normals(&moved.at, &moved.light(Sides::Two), *rule).expect("a surface").energy
                })
            };
            let most = (0..1000).into_par_iter().map(most).reduce(|| 0.0, f64::max);
            println!("{roughness:?}, {rule}: jumps by {most:.1e} at most");
            assert!(most < 1e-7, "{roughness:?}, {rule}: {most}");
        }
    }
}
