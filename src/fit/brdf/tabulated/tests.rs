use std::{
    f64::consts::{FRAC_PI_2, PI},
    sync::Arc,
};

mod anisotropic;

use super::*;
use crate::{
    brdf::BrdfKind,
    math::{Lattice, direction},
};

fn even(n: usize, end: f64) -> Vec<f64> {
    (0..n).map(|i| end * i as f64 / (n - 1) as f64).collect()
}

fn axes(alpha: &[f64], thetas: usize, phis: usize) -> TabulatedAxes {
    let theta = even(thetas, FRAC_PI_2);
    TabulatedAxes {
        alpha: alpha.to_vec(),
        theta_o: theta.clone(),
        theta_i: theta,
        phi: even(phis, PI),
        ..TabulatedAxes::default()
    }
}

/// A BRDF that is constant over all directions; `1 / pi` is Lambertian reflection.
fn lambert(axes: TabulatedAxes, value: f64) -> Result<TabulatedBrdf, Vec<TabulatedFault>> {
    let count = axes.shape().iter().product();
    TabulatedBrdf::new(axes, vec![value; count])
}

fn faults(axes: TabulatedAxes, values: Vec<f64>) -> Vec<String> {
    TabulatedBrdf::new(axes, values).expect_err("faults").iter().map(ToString::to_string).collect()
}

#[test]
fn a_constant_reflects_pi_times_itself_on_any_nodes() {
    let uneven = TabulatedAxes {
        alpha: vec![],
        theta_o: vec![0.0, 0.1, 1.5],
        theta_i: vec![0.0, 1e-4, 0.3, 1.57, FRAC_PI_2],
        phi: vec![0.0, 3.0, PI],
        ..TabulatedAxes::default()
    };
    let brdf = Arc::new(lambert(uneven, 0.25 / PI).expect("a BRDF"));
    assert!(brdf.albedos().iter().all(|albedo| (albedo - 0.25).abs() < 1e-15), "{:?}", brdf.albedos());
    let (surface, wo) = (brdf.surface([0.5; 2]), direction(0.8, 2.0));
    for u in Lattice::new(256, [0.2, 0.6]).points() {
        let sample = surface.sample(wo, u);
        assert!((sample.weight - 0.25).abs() < 1e-15);
        // The marginal distribution of Lambertian reflection is sin^2.
        assert!((1.0 - sample.wi.z * sample.wi.z - u[1]).abs() < 1e-12, "{u:?}: {}", sample.wi);
        assert!((surface.pdf(wo, sample.wi) - sample.wi.z / PI).abs() < 1e-14);
    }
}

/// The fraction of light below the sample of `u` equals `u`, in both coordinates.
#[test]
fn samples_invert_the_cumulative_light() {
    let brdf = TabulatedBrdf::tabulate(BrdfKind::Ggx, TabulatedAxes::spread(vec![0.5], 32, 32)).expect("a BRDF");
    let surface = Arc::new(brdf).surface([0.5; 2]);
    let wo = direction(0.9, 0.0);
    let n = 400;
    let reflected = |theta_end: f64, phi: [f64; 2]| {
        let step = [theta_end / f64::from(n), (phi[1] - phi[0]) / f64::from(n)];
        let mut sum = 0.0;
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let theta = (f64::from(i) + 0.5) * step[0];
            sum += surface.eval_cos(wo, direction(theta, phi[0] + (f64::from(j) + 0.5) * step[1])) * theta.sin();
        }
        sum * step[0] * step[1]
    };
    let total = 2.0 * reflected(FRAC_PI_2, [0.0, PI]);
    assert!((surface.sample(wo, [0.3, 0.3]).weight - total).abs() < 1e-4, "{total}");
    for below in [0.03, 0.4, 0.9, 0.999] {
        let wi = surface.sample(wo, [0.3, below]).wi;
        let part = 2.0 * reflected(wi.z.acos(), [0.0, PI]) / total;
        assert!((part - below).abs() < 1e-3, "{below}: {part}");
    }
    for turn in [0.1, 0.26, 0.45, 0.6, 0.9] {
        let wi = surface.sample(wo, [turn, 0.7]).wi;
        let azimuth = wi.y.atan2(wi.x);
        let theta = wi.z.acos();
        let ring = |end: f64| {
            let at = |j: i32| surface.eval_cos(wo, direction(theta, end * (f64::from(j) + 0.5) / f64::from(n)));
            (0..n).map(at).sum::<f64>() * end / f64::from(n)
        };
        let part = 0.5 * ring(azimuth.abs()) / ring(PI);
        let part = if azimuth < 0.0 { 1.0 - part } else { part };
        assert!((part - turn).abs() < 1e-4, "{turn}: {part}");
    }
}

#[test]
fn nodes_have_the_models_values_and_roughness_is_interpolated() {
    let axes = TabulatedAxes::spread(vec![0.2, 0.6], 48, 25);
    let brdf = Arc::new(TabulatedBrdf::tabulate(BrdfKind::OrenNayar, axes.clone()).expect("a BRDF"));
    let (wo, wi) = (direction(axes.theta_o[15], 1.0), direction(axes.theta_i[31], 1.0 - axes.phi[7]));
    let exact = [0.2, 0.6].map(|alpha| BrdfKind::OrenNayar.surface([alpha; 2]).eval_cos(wo, wi));
    for (alpha, part) in [(0.01, 0.0), (0.2, 0.0), (0.3, 0.25), (0.6, 1.0), (1.0, 1.0)] {
        let wanted = exact[0] * (1.0 - part) + exact[1] * part;
        let found = brdf.surface([alpha; 2]).eval_cos(wo, wi);
        assert!((found - wanted).abs() < 1e-12, "{alpha}: {found} {wanted}");
    }
}

#[test]
fn every_fault_is_reported_at_once() {
    let good = axes(&[0.2, 0.6], 4, 3);
    let mut values = vec![0.2; 2 * 4 * 4 * 3];
    let bad = TabulatedAxes {
        alpha: vec![0.6, 0.2],
        theta_o: vec![0.0, 0.5, 0.5, 1.6],
        theta_i: vec![0.1, 0.5, 1.0, FRAC_PI_2],
        phi: vec![0.0, f64::NAN, PI],
        ..TabulatedAxes::default()
    };
    (values[5], values[7], values[40]) = (-1.0, f64::NAN, -2.0);
    let messages = faults(bad, values.clone());
    let wanted = [
        "tensor «alpha»: node 1 is 0.2 after 0.6; nodes must ascend by at least 0.000001",
        "tensor «theta_o»: node 3 is 1.6; allowed: 0 to 1.5707963267948966",
        "tensor «theta_o»: node 2 is 0.5 after 0.5; nodes must ascend by at least 0.000001",
        "tensor «theta_i»: nodes go from 0.1 to 1.5707963267948966; they must go from 0 to 1.5707963267948966",
        "tensor «phi»: node 1 is NaN, not a finite number",
        "tensor «value»: 1 of 96 numbers are not finite; the first is NaN, at alpha 0.6000, theta_o 0.0000, theta_i 1.0000, phi NaN",
        "tensor «value»: 2 of 96 numbers are negative; the first is -1, at alpha 0.6000, theta_o 0.0000, theta_i 0.5000, phi 3.1416",
    ];
    assert_eq!(messages, wanted);
    values.pop();
    let messages = faults(good.clone(), values);
    assert!(messages.contains(&"tensor «value»: 95 numbers; the axes need 2 x 4 x 4 x 3".to_owned()), "{messages:?}");
    let messages = faults(TabulatedAxes::default(), vec![]);
    assert_eq!(messages.len(), 4, "{messages:?}");
    assert!(messages[0].ends_with("theta_o»: 0 nodes; allowed: 2 or more"), "{messages:?}");
}

#[test]
fn energy_is_bounded_above_and_below() {
    let messages =
        |axes: TabulatedAxes, value: f64| lambert(axes, value).map(|_| ()).map_err(|faults| faults[0].to_string());
    let axes = || axes(&[0.2, 0.6], 4, 3);
    assert_eq!(messages(axes(), 1.0009 / PI), Ok(()));
    let most = "tensor «value»: 8 of 8 views reflect more than 1.001 of uniform light, up to 1.0020 at alpha 0.6000, theta_o 1.5708";
    assert_eq!(messages(axes(), 1.002 / PI), Err(most.to_owned()));
    let none = "tensor «value»: no light is reflected at alpha 0.2000, theta_o 0.0000; end the axis before this node or give it values above 0";
    assert_eq!(messages(axes(), 0.0), Err(none.to_owned()));
    assert!(messages(axes(), f64::MAX).is_err_and(|fault| fault.contains("up to inf")));
}

/// Views that are too bright, negative values and NaN are reported together. A view that has only invalid values is not
/// reported as dark too.
#[test]
fn energy_faults_are_reported_with_wrong_values() {
    let mut values = vec![1.5 / PI; 2 * 4 * 4 * 3];
    (values[0], values[13]) = (-0.001, f64::NAN);
    values[36..48].fill(-1.0);
    let messages = faults(axes(&[0.2, 0.6], 4, 3), values);
    assert_eq!(messages.len(), 3, "{messages:?}");
    assert!(messages[0].contains("1 of 96 numbers are not finite"), "{messages:?}");
    assert!(messages[1].contains("13 of 96 numbers are negative"), "{messages:?}");
    assert!(messages[2].contains("7 of 8 views reflect more than 1.001 of uniform light, up to 1.5"), "{messages:?}");
}

#[test]
fn ends_in_f32_are_quarter_turns() {
    let single = |x: f64| f64::from(x as f32);
    let rounded = TabulatedAxes {
        alpha: vec![],
        theta_o: vec![0.0, single(FRAC_PI_2)],
        theta_i: vec![0.0, single(FRAC_PI_2)],
        phi: vec![0.0, single(PI)],
        ..TabulatedAxes::default()
    };
    let brdf = lambert(rounded, 0.3).expect("a BRDF");
    assert_eq!((brdf.axes().theta_i[1], brdf.axes().theta_o[1], brdf.axes().phi[1]), (FRAC_PI_2, FRAC_PI_2, PI));
}

#[test]
fn asymmetry_is_found_where_it_was_planted() {
    let axes = axes(&[0.5], 5, 3);
    let mut values = vec![0.2; 75];
    assert_eq!(
        TabulatedBrdf::new(axes.clone(), values.clone()).expect("a BRDF").asymmetry().map(|a| a.largest),
        Some(0.0)
    );
    // The value at node 1 of theta_o, node 3 of theta_i and node 2 of phi.
    values[(5 + 3) * 3 + 2] = 0.25;
    let found = TabulatedBrdf::new(axes.clone(), values).expect("a BRDF").asymmetry().expect("views and lights");
    assert!((found.largest - 0.2).abs() < 1e-12, "{found:?}");
    assert_eq!((found.theta_o, found.theta_i, found.phi), (axes.theta_o[1], axes.theta_i[3], PI));
}
