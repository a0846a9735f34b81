use rayon::prelude::*;

use super::{
    cases::{Case, Draw, Set, Truth, errors, f32_errors, mean_and_max},
    *,
};

const ETAS: [f64; 2] = [1.5, 1.0 / 1.5];

/// A square at height `z` with half side `size`, moved along x by `x`.
fn square<T: Scalar>(x: f64, size: f64, z: f64) -> [Triple<T>; 4] {
    [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)].map(|(u, v)| [x + u * size, v * size, z].map(T::of))
}

fn view(theta: f64, phi: f64) -> [f64; 3] {
    [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()]
}

/// Measured on 200 cases of each set. The largest error of the visible part is 2.4e-5. The energy has a mean error of
/// 7.5e-4 and a largest error of 0.017. With the Fresnel term, the errors are 1.2e-3 and 0.026.
#[test]
fn polygons_agree_with_quadrature_over_their_area() {
    for eta in ETAS {
        for set in [Set::Isotropic, Set::Anisotropic, Set::Cut, Set::Facing, Set::Horizon, Set::Anywhere] {
            let [visible, energy, dielectric, schlick] = errors(set, eta, 30, 1e-6);
            assert!(visible[1] < 5e-5, "{set:?} {eta}: {visible:?}");
            assert!(energy[0] < 1e-3 && energy[1] < 0.02, "{set:?} {eta}: {energy:?}");
            for fresnel in [dielectric, schlick] {
                assert!(fresnel[0] < 1.5e-3 && fresnel[1] < 0.03, "{set:?} {eta}: {fresnel:?}");
            }
        }
        // Most lights of these sets are neither cut nor clipped.
        for set in [Set::Isotropic, Set::Anisotropic] {
            let [_, energy, dielectric, schlick] = errors(set, eta, 30, 1e-6).map(|[mean, _]| mean);
            assert!(energy < 3e-4 && dielectric < 5e-4 && schlick < 6e-4, "{set:?}: {energy} {dielectric} {schlick}");
        }
    }
}

/// Every normal that faces the viewer refracts into a denser medium.
#[test]
fn all_that_is_below_is_all_that_is_seen() {
    for eta in [1.05, 1.5, 2.5] {
        for (alpha, theta) in [([0.3, 0.7], 0.0), ([1.0, 1.0], 0.7), ([0.05, 0.4], 1.4), ([0.9, 0.2], 1.56)] {
            let interface = Interface::new(alpha, view(theta, 0.9), eta);
            let arcs = outline(&interface, &square::<f64>(0.0, 1.0, -1e-9), Sides::Two);
            let visible = Region::new(&interface, &arcs).part(&interface);
            assert!((visible - 1.0).abs() < 1e-6, "{eta} {theta}: {visible}");
        }
    }
}

/// Light passes a smooth interface at the angle of Snell's law, except for reflected and shadowed light.
#[test]
fn a_smooth_interface_follows_snell_and_fresnel() {
    for (eta, theta) in [(1.5, 0.9), (1.0 / 1.5, 0.5), (2.0, 0.0)] {
        let wo = view(theta, 0.3);
        let cos_i = (1.0 - (theta.sin() / eta).powi(2)).sqrt();
        let wi = [-wo[0] / eta, -wo[1] / eta, -cos_i];
        let across = (wo[2] - eta * cos_i) / (wo[2] + eta * cos_i);
        let along = (eta * wo[2] - cos_i) / (eta * wo[2] + cos_i);
        let wanted = 1.0 - 0.5 * (across * across + along * along);
        let around = |x: f64, y: f64| [wi[0] / cos_i + x, wi[1] / cos_i + y, -1.0];
        let light = [(-0.1, -0.1), (-0.1, 0.1), (0.1, 0.1), (0.1, -0.1)].map(|(x, y)| around(x, y));
        let found = transmitted([1e-4, 1e-4], wo, eta, &light, Sides::Two);
        assert!((found.dielectric - wanted).abs() < 1e-3, "{eta}: {found:?} {wanted}");
        assert!((found.energy - 1.0).abs() < 1e-5, "{found:?}");
        let beside = light.map(|[x, y, z]| [x + 0.3, y, z]);
        assert!(transmitted([1e-4, 1e-4], wo, eta, &beside, Sides::Two).energy < 1e-5);
    }
}

/// Sampling uses neither cones nor clips. The sum over 20,000 normals is within 0.01 of the closed form.
#[test]
fn sampled_normals_give_the_same_light() {
    let mut draw = Draw::new(78);
    for eta in ETAS {
        let cases: Vec<Case> = (0..60).map(|_| draw.case(Set::Anisotropic, eta)).collect();
        let difference = |case: &Case| {
            let Case { alpha, wo, vertices, .. } = *case;
            let light = [Sides::One, Sides::Two].map(|sides| {
                let by_normals = transmitted(alpha, wo, eta, &vertices, sides);
                let reference = sampled(alpha, wo, eta, &vertices, sides, 20_000, [0.3, 0.6]);
                [
                    by_normals.energy - reference.energy,
                    by_normals.dielectric - reference.dielectric,
                    by_normals.schlick - reference.schlick,
                ]
            });
            light.into_iter().flatten().map(f64::abs).fold(0.0, f64::max)
        };
        let [mean, max] = mean_and_max(cases.iter().map(difference));
        assert!(mean < 2e-3 && max < 0.02, "{eta}: {mean} {max}");
    }
}

#[test]
fn total_internal_reflection_transmits_no_light() {
    // Seen straight down from the denser side, all refracted light has wo . wi < -eta.
    let light = [[-9.0, -1.0, -1.0], [-9.0, 1.0, -1.0], [-4.0, 1.0, -1.0], [-4.0, -1.0, -1.0]];
    assert_eq!(transmitted([0.8, 0.5], [0.0, 0.0, 1.0], 0.5, &light, Sides::Two).energy, 0.0);
    let nearer = light.map(|[x, y, z]| [x + 4.0, y, z]);
    assert!(transmitted([0.8, 0.5], [0.0, 0.0, 1.0], 0.5, &nearer, Sides::Two).energy > 0.0);
    // Beyond the critical angle a smooth interface reflects everything.
    let all = square(0.0, 1.0, -1e-3);
    assert!(transmitted([0.02, 0.02], view(1.2, 0.4), 0.5, &all, Sides::Two).energy < 1e-3);
}

#[test]
fn lights_above_the_surface_give_exactly_zero() {
    let none = Transmitted { energy: 0.0, dielectric: 0.0, schlick: 0.0 };
    for eta in ETAS {
        let through = |light: &[[f64; 3]]| transmitted([0.4, 0.2], view(0.5, 1.0), eta, light, Sides::Two);
        assert_eq!(through(&square(0.0, 1.0, 1.0)), none);
        assert_eq!(through(&square(0.0, 1.0, 0.0)), none);
        assert_eq!(through(&square::<f64>(0.0, 1.0, -1.0)[..2]), none);
        assert_eq!(through(&[[0.0, 0.0, -1.0]; 4]), none);
        assert_eq!(through(&[]), none);
    }
}

#[test]
fn one_side_sees_what_the_other_does_not() {
    let mut light = square(0.2, 1.0, -1.0);
    let through = |light: &[[f64; 3]], sides| transmitted([0.4, 0.2], view(0.5, 1.0), 1.5, light, sides);
    // The vertices run clockwise as seen from above, where the shaded point is.
    let front = through(&light, Sides::One);
    assert!(front.energy > 0.1, "{front:?}");
    light.reverse();
    assert_eq!(through(&light, Sides::One).energy, 0.0);
    assert!((through(&light, Sides::Two).energy - front.energy).abs() < 1e-12);
}

/// The visible parts of two halves add up, for all clips. The factor of nearly straight arcs has an error of 3e-5.
#[test]
fn halves_make_a_whole() {
    let mut draw = Draw::new(8);
    for i in 0..600 {
        let set = [Set::Cut, Set::Facing, Set::Horizon, Set::Huge][i % 4];
        let eta = draw.within(1.1, 2.5);
        let case = draw.case(set, if i % 8 < 4 { eta } else { 1.0 / eta });
        let [a, b, c, d] = case.vertices;
        let (low, high) = (scaled(plus(a, b), 0.5), scaled(plus(c, d), 0.5));
        let half = |vertices| Case { vertices, ..case }.model()[0];
        let sum = half([a, low, high, d]) + half([low, b, c, high]);
        assert!((sum - case.model()[0]).abs() < 1e-4, "{sum} {case:?}");
    }
}

/// The measured differences are 1e-7 to 7e-7 on average and 5e-5 at most. They reach 1.5e-4 if f32 splits an arc for
/// the weight and f64 does not.
#[test]
fn f32_is_f64_but_for_rounding() {
    for (etas, alphas) in [
        ([1.5, 1.5], [0.05, 1.0]),
        ([1.0 / 1.5, 1.0 / 1.5], [0.05, 1.0]),
        ([1.02, 1.2], [0.05, 1.0]),
        ([0.83, 0.98], [0.05, 1.0]),
        ([1.8, 3.0], [0.001, 0.05]),
        ([1.0 / 3.0, 0.55], [0.001, 0.05]),
    ] {
        let [mean, max] = f32_errors(etas, alphas, 4000);
        assert!(mean < 1.5e-6 && max < 5e-4, "{etas:?} {alphas:?}: {mean:.1e} {max:.1e}");
    }
}

/// A light of a thousandth of its distance keeps most of its digits in f32, because its plane part is summed around a
/// corner.
#[test]
fn small_lights_keep_their_digits() {
    for eta in ETAS {
        let case = Case { alpha: [0.4, 0.3], eta, wo: view(0.4, 0.3), vertices: square(-0.2, 5e-4, -1.0) };
        let (exact, rounded) = (case.model(), case.model32());
        for (exact, rounded) in exact.into_iter().zip(rounded) {
            assert!(exact > 1e-8 && (rounded / exact - 1.0).abs() < 2e-3, "{eta}: {rounded:e} {exact:e}");
        }
    }
}

/// Views and lights on the axes, edges in line with the view, vertices on the circles of the clips and on the surface.
#[test]
fn degenerate_placements_are_numbers_between_zero_and_one() {
    fn check<T: Scalar>(alpha: [f64; 2], wo: [f64; 3], eta: f64, light: &[[f64; 3]]) {
        let light: Vec<Triple<T>> = light.iter().map(|v| v.map(T::of)).collect();
        let found = transmitted(alpha.map(T::of), wo.map(T::of), T::of(eta), &light, Sides::Two);
        let Transmitted { energy, dielectric, schlick } = found;
        for x in [dielectric, schlick] {
            assert!(x >= T::ZERO && x <= energy && energy <= T::ONE, "{found:?} {alpha:?} {wo:?} {eta} {light:?}");
        }
    }
    let third = 1.0 / 3.0;
    for eta in [1.5, 1.0 / 1.5, 1.02, 0.98, 3.0, third] {
        for alpha in [[0.3, 0.3], [0.5, 0.1], [1.0, 1.0], [1e-4, 1e-4], [1.0, 1e-4]] {
            for (theta, phi) in [0.0, 0.5, 1.0, (1.0 / 1.5_f64).asin(), 1.57, 1e-9]
                .into_iter()
                .flat_map(|theta| [0.0, 0.25, 0.125].map(|turn| (theta, turn * std::f64::consts::TAU)))
            {
                let wo = view(theta, phi);
                // The corners are at the depth of the circle h.z = 0.
                let depth = (wo[2] / eta).min(0.999);
                let on_circle = (0.5 * (1.0 - depth * depth)).sqrt();
                for x in [0.0, -1.0, 0.5] {
                    for size in [1.0, 1e-3, 1e-7, 30.0, 1e6, on_circle / depth.max(0.01)] {
                        for z in [-1.0, -1e-9] {
                            check::<f64>(alpha, wo, eta, &square(x, size, z));
                            check::<f32>(alpha, wo, eta, &square(x, size, z));
                        }
                    }
                    for [low, high] in [[-1.0, 0.0], [-1.0, 1.0], [-1e-6, 1e-6]] {
                        let wall = [[x, -1.0, low], [x, 1.0, low], [x, 1.0, high], [x, -1.0, high]];
                        check::<f64>(alpha, wo, eta, &wall);
                        check::<f32>(alpha, wo, eta, &wall);
                    }
                }
            }
        }
    }
}

/// A light moves across the clips. A jump is a large second difference, which is small on a smooth path. The visible
/// part has no jumps. The mean weight has small jumps if an arc splits into more parts. Measured maxima: 4.3e-5 and
/// 3.8e-4.
#[test]
fn a_moving_light_never_jumps() {
    const STEPS: u32 = 8000;
    let mut shapes = Vec::new();
    for eta in [1.5, 1.0 / 1.5, 2.5, 0.4] {
        for (alpha, theta) in [([0.4, 0.4], 1.0), ([0.6, 0.25], 0.6), ([0.3, 0.3], 0.1)] {
            for lean in [0.0, -0.6] {
                let at = |i: u32| {
                    let x = 4.0 - 8.0 * f64::from(i) / f64::from(STEPS);
                    let vertices = square::<f64>(0.0, 0.5, -1.0).map(|[u, y, z]| [x + u, y, z + lean * (u + 0.8 * x)]);
                    Case { alpha, eta, wo: view(theta, 0.4), vertices }
                };
                let model = |i: u32| (at(i).model(), at(i).kinds());
                let path: Vec<_> = (0..=STEPS).into_par_iter().map(model).collect();
                let bends = path
                    .windows(3)
                    .map(|w| std::array::from_fn::<f64, 4, _>(|j| (w[0].0[j] - 2.0 * w[1].0[j] + w[2].0[j]).abs()));
                let [visible, energy, dielectric, schlick] =
                    bends.fold([0.0; 4], |a: Truth, b| std::array::from_fn(|j| a[j].max(b[j])));
                assert!(visible < 1e-4, "{eta} {alpha:?} {theta} {lean}: {visible:.1e}");
                let largest = energy.max(dielectric).max(schlick);
                assert!(largest < 1e-3, "{eta} {alpha:?} {theta} {lean}: {largest:.1e}");
                shapes.extend(path.into_iter().map(|(_, kinds)| kinds));
            }
        }
    }
    for kind in [ArcKind::Surface, ArcKind::Horizon, ArcKind::Grazing, ArcKind::Critical] {
        assert!(shapes.iter().flatten().any(|(has, _)| *has == kind), "no light is clipped by {kind:?}");
    }
}
