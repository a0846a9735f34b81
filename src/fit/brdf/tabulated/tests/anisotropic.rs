//! Tests of files with azimuths of the view.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec3, Vec3Swizzles as _};

use super::{TabulatedAxes, TabulatedBrdf, even, faults};
use crate::{
    brdf::{Brdf as _, BrdfKind, planted_anisotropic},
    math::{Lattice, cosine_hemisphere, direction},
};

/// One surface with 3 x 3 x 3 x 5 nodes.
fn axes() -> TabulatedAxes {
    let quarter = even(3, FRAC_PI_2);
    TabulatedAxes {
        theta_o: quarter.clone(),
        phi_o: quarter.clone(),
        theta_i: quarter,
        phi: even(5, TAU),
        ..TabulatedAxes::default()
    }
}

/// Tests a view of the file and its mirror images, with the larger roughness along x or y.
#[test]
fn nodes_have_the_models_values_in_every_quadrant() {
    let (model, axes) = (planted_anisotropic(), axes_of_planted());
    let mut compared = 0;
    for (alpha, ratio) in [(0.4, 0.5), (1.0, 0.5), (0.4, 1.0)] {
        for (o, v, i, p) in [(1, 0, 5, 3), (3, 2, 8, 9), (7, 0, 20, 12), (12, 8, 3, 21), (20, 5, 24, 20), (9, 4, 0, 6)]
        {
            let (wo, wi) = (
                direction(axes.theta_o[o], axes.phi_o[v]),
                direction(axes.theta_i[i].min(FRAC_PI_2 - 1e-4), axes.phi_o[v] + axes.phi[p]),
            );
            for signs in [[1.0, 1.0], [-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]] {
                let mirrored = [wo, wi].map(|w| w * DVec3::new(signs[0], signs[1], 1.0));
                for (roughness, [wo, wi]) in
                    [([alpha, alpha * ratio], mirrored), ([alpha * ratio, alpha], mirrored.map(DVec3::yxz))]
                {
                    let [found, wanted] = [model.surface(roughness), BrdfKind::Ggx.surface(roughness)]
                        .map(|surface| surface.eval_cos(wo, wi));
                    assert!((found / wanted - 1.0).abs() < 1e-9, "{roughness:?} {wo} {wi}: {found} {wanted}");
                    compared += 1;
                }
            }
        }
    }
    assert_eq!(compared, 3 * 6 * 4 * 2);
}

fn axes_of_planted() -> TabulatedAxes {
    planted_anisotropic().file().and_then(|file| file.data()).expect("its numbers").axes().clone()
}

/// Interpolated values are within a few percent of the largest value of GGX, for all surfaces, views and lights.
#[test]
fn between_nodes_it_is_about_ggx() {
    let (model, mut worst) = (planted_anisotropic(), 0.0_f64);
    let views = Lattice::new(60, [0.1, 0.3]).points().map(|u| direction(1.4 * u[0], TAU * u[1]));
    let from_the_pole = [DVec3::Z, DVec3::new(-0.0, 0.0, 1.0), DVec3::new(0.0, -0.0, 1.0), direction(1e-12, 4.0)];
    for (k, wo) in views.chain(from_the_pole).enumerate() {
        let roughness = [[0.4, 0.2], [1.0, 1.0], [0.5, 1.0]][k % 3];
        let [file, ggx] = [model.surface(roughness), BrdfKind::Ggx.surface(roughness)];
        let pairs: Vec<[f64; 2]> = Lattice::new(400, [0.2; 2])
            .points()
            .map(|u| [&file, &ggx].map(|surface| surface.eval_cos(wo, cosine_hemisphere(u))))
            .collect();
        let most = pairs.iter().map(|pair| pair[1]).fold(0.0, f64::max);
        worst = pairs.iter().map(|pair| (pair[0] - pair[1]).abs() / most).fold(worst, f64::max);
    }
    println!("{worst}");
    assert!((1e-3..0.12).contains(&worst), "{worst}");
}

/// For constant values, the coordinates of a sample are the fraction of a turn and the fraction of all light.
#[test]
fn a_constant_is_lambert_s_reflection() {
    let count = axes().shape().iter().product();
    let brdf = std::sync::Arc::new(TabulatedBrdf::new(axes(), vec![0.25 / PI; count]).expect("a BRDF"));
    assert!(brdf.albedos().len() == 9 && brdf.albedos().iter().all(|albedo| (albedo - 0.25).abs() < 1e-15));
    assert_eq!(brdf.asymmetry().map(|found| found.largest), Some(0.0));
    for (roughness, wo) in [([0.5, 0.2], direction(0.8, 0.4)), ([0.2, 0.5], DVec3::Z)] {
        let surface = brdf.surface(roughness);
        for u in Lattice::new(64, [0.2, 0.6]).points() {
            let sample = surface.sample(wo, u);
            assert!((sample.weight - 0.25).abs() < 1e-15);
            assert!((1.0 - sample.wi.z * sample.wi.z - u[1]).abs() < 1e-12, "{u:?}: {}", sample.wi);
            assert!((surface.pdf(wo, sample.wi) - sample.wi.z / PI).abs() < 1e-14);
        }
    }
}

#[test]
fn every_fault_of_azimuths_is_reported_at_once() {
    let bad = TabulatedAxes {
        ratio: vec![0.5, 1.5, f64::INFINITY],
        phi_o: vec![0.0, 1.0, 0.5, 1.5],
        phi: vec![0.0, 1.0, PI, TAU],
        ..axes()
    };
    let mut values = vec![0.1; 3 * 3 * 4 * 3 * 4];
    (values[7], values[8]) = (f64::NAN, -1.0);
    let wanted = [
        "tensor «ratio»: node 2 is inf, not a finite number",
        "tensor «phi_o»: node 2 is 0.5 after 1; nodes must ascend by at least 0.000001",
        "tensor «phi_o»: nodes go from 0 to 1.5; they must go from 0 to 1.5707963267948966",
        "tensor «phi»: node 1 is 1, but its mirror image is 3.141592653589793; nodes must be symmetric about pi: phi \
         and 2 pi - phi",
        "tensor «value»: 1 of 432 numbers are not finite; the first is NaN, at ratio 0.5000, theta_o 0.0000, phi_o 0.0000, \
         theta_i 0.7854, phi 6.2832",
        "tensor «value»: 1 of 432 numbers are negative; the first is -1, at ratio 0.5000, theta_o 0.0000, phi_o 0.0000, theta_i \
         1.5708, phi 0.0000",
    ];
    assert_eq!(faults(bad, values), wanted);

    let half = TabulatedAxes { phi: even(5, PI), phi_o: vec![0.0], ..axes() };
    let wanted = [
        "tensor «phi_o»: 1 nodes; allowed: 2 or more",
        "tensor «phi_o»: nodes go from 0 to 0; they must go from 0 to 1.5707963267948966",
        "tensor «phi»: nodes go from 0 to 3.141592653589793; they must go from 0 to 6.283185307179586",
    ];
    assert_eq!(faults(half, vec![0.1; 3 * 3 * 5]), wanted);
    let without = TabulatedAxes { phi_o: vec![], ratio: vec![0.5], phi: even(3, PI), ..axes() };
    let messages = "tensor «ratio»: phi_o is missing: surfaces of ratios below 1 change with the azimuth of the view";
    assert_eq!(faults(without, vec![0.1; 27]), [messages]);
}

/// Plants unequal values at the two ends of a turn, and asymmetric values for views along an axis. Excess light and
/// invalid values are reported too; the comparison skips invalid values.
#[test]
fn broken_symmetries_are_reported_at_once() {
    let mut values = vec![0.2; 3 * 3 * 3 * 5];
    let at = |o: usize, v: usize, i: usize, p: usize| ((o * 3 + v) * 3 + i) * 5 + p;
    values[at(1, 1, 2, 4)] = 0.1;
    values[at(2, 0, 1, 1)] = 0.21;
    values[at(2, 2, 0, 3)] = 0.15;
    // The first change is not for a view along an axis. The second change is within the tolerance.
    values[at(0, 1, 1, 1)] = 0.1;
    values[at(0, 0, 0, 1)] = 0.2 * (1.0 - 0.9e-3);
    let of_turn = "tensor «value»: 1 pairs of numbers differ at phi 0 and 2 pi, which are the same azimuth, by up to \
                   0.5000 of the view's largest number at theta_o 0.7854, phi_o 0.7854, theta_i 1.5708, phi 6.2832; \
                   allowed: 0.001";
    let of_mirror = "tensor «value»: 2 pairs of numbers differ at phi and 2 pi - phi for phi_o 0 or pi/2, where the surface \
                     is symmetric, by up to 0.2500 of the view's largest number at theta_o 1.5708, phi_o 1.5708, \
                     theta_i 0.0000, phi 1.5708; allowed: 0.001";
    assert_eq!(faults(axes(), values.clone()), [of_turn, of_mirror]);
    (values[at(1, 1, 2, 4)], values[at(1, 2, 0, 1)]) = (-1.0, f64::NAN);
    let messages = faults(axes(), values.iter().map(|x| x * 4.0).collect());
    let wanted =
        ["are not finite", "are negative", "2 pairs of numbers differ at phi and 2 pi - phi", "reflect more than"];
    assert!(messages.len() == 4 && messages.iter().zip(wanted).all(|(m, wanted)| m.contains(wanted)), "{messages:?}");
}

/// Six axes of 2048 nodes: their product overflows a usize.
#[test]
fn sizes_whose_product_overflows_are_refused() {
    let many = |end: f64| even(2048, end);
    let [quarter, one] = [FRAC_PI_2, 1.0].map(many);
    let huge = TabulatedAxes {
        alpha: one.clone(),
        ratio: one,
        theta_o: quarter.clone(),
        phi_o: quarter.clone(),
        theta_i: quarter,
        phi: many(TAU),
    };
    let shape = "2048 x 2048 x 2048 x 2048 x 2048 x 2048";
    let wanted = [
        format!("tensor «value»: {shape} numbers; allowed: at most 4194304"),
        format!("tensor «value»: 1 numbers; the axes need {shape}"),
    ];
    assert_eq!(faults(huge, vec![0.1]), wanted);
}

/// Exchanges view and light. The exchanged value is exact at a node of the view's azimuth, and interpolated between
/// nodes.
#[test]
fn asymmetry_is_found_where_it_was_planted() {
    let even_views = TabulatedAxes { ratio: vec![0.5], ..axes() };
    let mut values = vec![0.2; 3 * 3 * 3 * 5];
    // The value at theta_o pi/4, theta_i pi/2, phi_o pi/4 and phi pi/2. After the exchange, the view is at 3/4 pi, the
    // mirror image of pi/4.
    values[((3 + 1) * 3 + 2) * 5 + 1] = 0.25;
    let found = TabulatedBrdf::new(even_views, values.clone()).expect("a BRDF").asymmetry().expect("views and lights");
    assert!((found.largest - 0.2).abs() < 1e-12, "{found:?}");
    assert_eq!((found.alpha, found.ratio), (None, Some(0.5)));
    assert_eq!([found.theta_o, found.theta_i, found.phi], [FRAC_PI_2 / 2.0, FRAC_PI_2, FRAC_PI_2]);
    assert_eq!(found.phi_o, Some(FRAC_PI_2 / 2.0));
    // The exchanged value: a view at pi/2, whose light is mirrored to the other side.
    values[((2 * 3 + 1) * 3 + 1) * 5 + 1] = 0.25;
    let found = TabulatedBrdf::new(axes(), values).expect("a BRDF").asymmetry().expect("views and lights");
    assert_eq!(found.largest, 0.0, "{found:?}");
}
