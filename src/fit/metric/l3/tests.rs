use super::*;
use crate::{
    brdf::{Brdf, Ggx, Mirrors},
    lobe::ltc::Ltc,
    math::{SquarePoint, direction},
    metric::{Metric, PlantedBrdf, Target},
    stop_check::unstopped,
};

const GGX: Ggx = Ggx { alpha_x: 0.3, alpha_y: 0.3 };

fn target(brdf: &dyn Brdf, wo: DVec3) -> Target {
    let points: Vec<SquarePoint> = Lattice::new(4096, [0.1, 0.6]).points().map(SquarePoint::new).collect();
    Target::sample(brdf, wo, Mirrors::of(wo), &points)
}

/// Calls `check` with the loss to a lobe, with this many samples of the LTC.
fn with_loss<T>(lobe: &Lobe, samples: usize, check: impl FnOnce(&mut dyn Loss, &mut StopCheck) -> T) -> T {
    let mut distance = Metric::L3.rules().distance(&Samples { count: samples, directions: 4, shift: [0.2, 0.7] });
    let mut go_on = unstopped;
    let mut stop_check = StopCheck::new(&mut go_on);
    let mut loss = distance.to(lobe, &mut stop_check).expect("nothing stops it");
    check(&mut *loss, &mut stop_check)
}

/// A lobe close to the lobe of `GGX`, in its frame.
fn near() -> DMat3 {
    DMat3::from_cols(DVec3::new(0.5, 0.0, 0.05), DVec3::new(0.0, 0.45, 0.0), DVec3::new(0.1, 0.0, 1.0))
}

/// The loss by the midpoint rule over the whole sphere, in the lobe's frame, with half a million directions.
fn by_quadrature(lobe: &Lobe, m: &DMat3) -> f64 {
    let ltc = Ltc::new(*m).expect("a regular matrix");
    let (rows, columns) = (1000, 500);
    let (mut albedo, mut values) = (0.0, Vec::new());
    for (i, j) in (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))) {
        // The rows are dense around the pole.
        let t = (f64::from(i) + 0.5) / f64::from(rows);
        let (theta, phi) = (PI * t * t, 2.0 * PI * (f64::from(j) + 0.5) / f64::from(columns));
        let area = theta.sin() * 2.0 * PI * t / f64::from(rows) * 2.0 * PI / f64::from(columns);
        let wi = direction(theta, phi);
        let value = lobe.brdf.eval_cos(lobe.wo, lobe.target.frame * wi);
        albedo += value * area;
        values.push((value, ltc.pdf(wi), area));
    }
    let of = |power: &dyn Fn(f64, f64) -> f64| -> f64 {
        values.iter().map(|(f, d, area)| power(f / albedo, *d) * area).sum()
    };
    (of(&|g, d| (g - d).abs().powi(3)) / of(&|g, _| g.powi(3))).cbrt()
}

#[test]
fn the_value_is_that_of_quadrature() {
    for (alpha, theta) in [(0.3, 0.6), (0.1, 1.2), (0.8, 1.4)] {
        let (ggx, wo) = (Ggx { alpha_x: alpha, alpha_y: alpha }, direction(theta, 0.0));
        let target = target(&ggx, wo);
        let lobe = Lobe { brdf: &ggx, wo, target: &target };
        let m = DMat3::from_cols(DVec3::X * 1.5 * alpha, DVec3::Y * 1.4 * alpha, DVec3::new(0.1 * alpha, 0.0, 1.0));
        let expected = by_quadrature(&lobe, &m);
        let (found, fixed) = with_loss(&lobe, 2048, |loss, stop_check| {
            let spread = loss.spread();
            let value = loss.value(&m, stop_check).expect("nothing stops it") / spread;
            let (fixed, _) = loss.value_and_gradient(&m, Grain::Full, stop_check).expect("nothing stops it");
            (value, fixed / spread)
        });
        assert!((found / expected - 1.0).abs() < 0.02, "{alpha} {theta}: {found} {expected}");
        // At the matrix of the fixed samples both estimates are the same.
        assert!((fixed / found - 1.0).abs() < 1e-12, "{alpha} {theta}: {fixed} {found}");
    }
}

#[test]
fn the_gradient_is_that_of_central_differences() {
    let wo = direction(0.7, 0.0);
    let target = target(&GGX, wo);
    let lobe = Lobe { brdf: &GGX, wo, target: &target };
    with_loss(&lobe, 512, |loss, stop_check| {
        for grain in [Grain::Coarse, Grain::Full] {
            let start = loss.value_and_gradient(&near(), grain, stop_check).expect("nothing stops it").0;
            // A matrix close to the matrix of the fixed samples.
            let m = near() * 1.03 + DMat3::from_cols(DVec3::Z * 0.01, DVec3::ZERO, DVec3::Y * 0.02);
            let (value, gradient) = loss.value_and_gradient(&m, grain, stop_check).expect("nothing stops it");
            assert!(value != start);
            for (column, row) in (0..3).flat_map(|column| (0..3).map(move |row| (column, row))) {
                let step = 1e-5;
                let mut at = |step: f64| {
                    let mut m = m;
                    m.col_mut(column)[row] += step;
                    loss.value_and_gradient(&m, grain, stop_check).expect("nothing stops it").0
                };
                let expected = (at(step) - at(-step)) / (2.0 * step);
                let found = gradient.col(column)[row];
                assert!((found - expected).abs() < 1e-4 * value, "{grain:?} {column} {row}: {found} {expected}");
            }
        }
    });
}

/// A lobe that is an LTC has a distance of zero to this LTC, and a positive distance to all other LTCs.
#[test]
fn only_the_lobe_itself_is_at_distance_zero() {
    let planted =
        PlantedBrdf::new(DMat3::from_rotation_y(0.1) * near() * DMat3::from_diagonal(DVec3::new(0.3, 0.3, 1.0)));
    let target = target(&planted, DVec3::Z);
    let lobe = Lobe { brdf: &planted, wo: DVec3::Z, target: &target };
    let own = target.frame.transpose() * planted.matrix();
    let [same, other] = [own, own * DMat3::from_diagonal(DVec3::new(1.1, 1.0, 1.0))].map(|m| {
        with_loss(&lobe, 512, |loss, stop_check| loss.value(&m, stop_check).expect("nothing stops it") / loss.spread())
    });
    assert!(same < 0.01 && other > 5.0 * same, "{same} {other}");
}
