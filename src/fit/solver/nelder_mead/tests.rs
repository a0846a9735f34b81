use super::*;
use crate::{
    brdf::Mirrors,
    math::{Lattice, SquarePoint},
    metric::{Lobe, Metric, PlantedBrdf, Samples},
    stop_check::unstopped,
};

/// The matrix that a search finds for the lobe of `m`. Up to a small rotation, `m` is in the frame of the lobe's mean
/// direction. The search starts from `near`, or else from the guess for the lobe.
fn found(metric: Metric, shear: Shear, m: DMat3, near: Option<DMat3>) -> DMat3 {
    let planted = PlantedBrdf::new(DMat3::from_rotation_y(0.4) * m);
    let points: Vec<SquarePoint> = Lattice::new(4096, [0.3, 0.8]).points().map(SquarePoint::new).collect();
    let target = Target::sample(&planted, DVec3::Z, Mirrors { x: false, y: true }, &points);
    let mut distance = metric.rules().distance(&Samples { count: 2048, directions: 16, shift: [0.0; 2] });
    let mut go_on = unstopped;
    let mut stop_check = StopCheck::new(&mut go_on);
    let mut loss =
        distance.to(&Lobe { brdf: &planted, wo: DVec3::Z, target: &target }, &mut stop_check).expect("no stop");
    let start = near.map_or_else(|| Numbers::guessed(&target, shear), |m| Numbers::of(&m, shear));
    let matrix = search(&mut *loss, start, &target, 200, &mut stop_check).expect("nothing stops it");
    target.frame * matrix
}

/// The mean direction of a symmetric lobe is its axis, so the planted numbers are in its own frame.
#[test]
fn planted_numbers_are_recovered_by_every_metric_from_any_start() {
    let planted = DMat3::from_diagonal(DVec3::new(0.2, 0.3, 1.0));
    let far = DMat3::from_cols(DVec3::X * 0.6, DVec3::Y * 0.6, DVec3::new(0.1, 0.0, 1.0));
    for &metric in Metric::ALL {
        for shear in Shear::ALL {
            for near in [None, Some(far)] {
                let found = DMat3::from_rotation_y(-0.4) * found(metric, *shear, planted, near);
                let found = found * (1.0 / found.z_axis.z);
                assert!(found.abs_diff_eq(planted, 0.01), "{metric} {shear} {near:?}: {found}");
            }
        }
    }
}

/// Tests that the numbers of a matrix give the matrix again, and that a step of the simplex changes lobes of any width
/// in proportion.
#[test]
fn numbers_of_a_matrix_give_it_again() {
    for shear in Shear::ALL {
        let numbers = Numbers { m11: 0.2, m22: 0.1, skew: 0.03, shear: *shear };
        assert_eq!(Numbers::of(&numbers.matrix(), *shear), numbers);
        let scaled = Numbers::of(&(numbers.matrix() * 3.0), *shear);
        assert!((scaled.m11 - 0.2).abs() < 1e-12 && (scaled.skew - 0.03).abs() < 1e-12, "{scaled:?}");
        let moved = numbers.moved([0.1, 0.0, 0.5]);
        assert!((moved.m11 / 0.2 - 0.1_f64.exp()).abs() < 1e-12 && moved.m22 == 0.1, "{moved:?}");
        let unit = if *shear == Shear::X { 0.2 } else { 1.0 };
        assert!((moved.skew - (0.03 + 0.5 * unit)).abs() < 1e-12, "{moved:?}");
    }
}
