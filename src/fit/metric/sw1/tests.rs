use glam::DVec2;

use super::*;
use crate::{brdf::Mirrors, metric::planted, stop_check::unstopped};

const NO_MIRRORS: Mirrors = Mirrors { x: false, y: false };

/// Uses the same number of samples for coarse and full evaluations.
fn samples(n: usize) -> [CosineSamples; 2] {
    [0; 2].map(|_: u32| CosineSamples::new(Lattice::new(n, [0.0; 2])))
}

fn directions(n: usize) -> Vec<DVec3> {
    (0..n).map(|i| fibonacci_hemisphere(i, n, 0.0)).collect()
}

fn lobe(scale: f64) -> DMat3 {
    DMat3::from_cols(
        DVec3::new(0.9 * scale, 0.1 * scale, 0.2 * scale),
        DVec3::new(-0.2 * scale, 0.4 * scale, 0.0),
        DVec3::new(-0.6, 0.2, 0.8),
    )
}

fn loss<'a>(
    target: &Target,
    samples: &'a [CosineSamples; 2],
    directions: &[DVec3],
    buffers: &'a mut Buffers,
) -> SlicedLoss<'a> {
    SlicedLoss::new(target, samples, directions, buffers, &mut StopCheck::new(&mut unstopped))
        .expect("nothing stops it")
}

fn value(loss: &mut SlicedLoss<'_>, m: &DMat3) -> f64 {
    loss.value(m, &mut StopCheck::new(&mut unstopped)).expect("nothing stops it")
}

/// A matrix close to the lobe, in its frame.
fn near(target: &Target, scale: f64) -> DMat3 {
    let m = target.frame.transpose() * lobe(scale);
    // The slope shrinks with the lobe. With a larger slope, one or two samples would move behind a sharp lobe.
    let slope = scale * DVec2::new(0.02, -0.03);
    m * DMat3::from_cols(DVec3::new(1.1, 0.05, slope.x), DVec3::new(0.05, 0.9, slope.y), DVec3::new(0.1, -0.05, 1.0))
}

/// Equation 10 of KT et al. 2022 on the loss's own samples: sorted projections, compared quantile by quantile.
fn by_sorting(target: &Target, m: &DMat3, samples: &[CosineSamples; 2], directions: &[DVec3]) -> f64 {
    let sorted = |values: &mut Vec<f64>| values.sort_by(f64::total_cmp);
    let mut sum = 0.0;
    for d in directions {
        let mut wanted: Vec<f64> = target.points.iter().map(|p| d.dot(*p)).collect();
        let CosineSamples { count, x, y, z, .. } = &samples[Grain::Full as usize];
        let cosine = |i: usize| DVec3::new(f64::from(x[i]), f64::from(y[i]), f64::from(z[i]));
        let mut ours: Vec<f64> = (0..*count).map(|i| d.dot((*m * cosine(i)).normalize() - DVec3::Z)).collect();
        sorted(&mut wanted);
        sorted(&mut ours);
        let of = |i: usize| (wanted[i] - ours[i * ours.len() / wanted.len()]).abs();
        sum += (0..wanted.len()).map(of).sum::<f64>() / wanted.len() as f64;
    }
    sum / directions.len() as f64
}

#[test]
fn equals_the_distance_by_sorting() {
    for scale in [1.0, 0.1, 1e-3] {
        let target = planted(lobe(scale), NO_MIRRORS);
        let (samples, directions) = (samples(2048), directions(16));
        let m = near(&target, scale);
        let mut buffers = Buffers::default();
        let loss = value(&mut loss(&target, &samples, &directions, &mut buffers), &m);
        let exact = by_sorting(&target, &m, &samples, &directions);
        assert!((loss / exact - 1.0).abs() < 0.01, "{scale}: {loss} {exact}");
    }
}

/// Tests numbers of samples that do not fill the last lanes, and a large number.
#[test]
fn any_number_of_samples_gives_the_distance() {
    let target = planted(lobe(0.3), NO_MIRRORS);
    let (directions, m) = (directions(8), near(&target, 0.3));
    for count in [64, 65, 99, 1001, 8192] {
        let (samples, mut buffers) = (samples(count), Buffers::default());
        let mut loss = loss(&target, &samples, &directions, &mut buffers);
        let (value, gradient) =
            loss.value_and_gradient(&m, Grain::Full, &mut StopCheck::new(&mut unstopped)).expect("nothing stops it");
        let exact = by_sorting(&target, &m, &samples, &directions);
        assert!((value / exact - 1.0).abs() < 0.03, "{count}: {value} {exact}");
        assert!(gradient.to_cols_array().iter().all(|g| g.is_finite()), "{count}: {gradient}");
    }
}

/// Invalid directions must get a cell too.
#[test]
fn directions_that_are_not_finite_get_a_cell() {
    let target = planted(lobe(0.3), NO_MIRRORS);
    let (samples, directions, mut buffers) = (samples(64), directions(8), Buffers::default());
    let mut loss = loss(&target, &samples, &directions, &mut buffers);
    for m in [DMat3::ZERO, DMat3::IDENTITY * f64::NAN, DMat3::IDENTITY * f64::INFINITY, DMat3::IDENTITY * 1e-30] {
        let value = loss.value_and_gradient(&m, Grain::Full, &mut StopCheck::new(&mut unstopped));
        assert!(value.is_some_and(|(value, _)| value.is_nan() || value > 0.0), "{m}: {value:?}");
    }
}

#[test]
fn gradient_is_that_of_central_differences() {
    for scale in [1.0, 0.1, 1e-3, 1e-4] {
        let target = planted(lobe(scale), NO_MIRRORS);
        let (samples, directions) = (samples(8192), directions(16));
        let mut buffers = Buffers::default();
        let mut loss = loss(&target, &samples, &directions, &mut buffers);
        // The matrix is so far from the lobe that the two cumulatives cross at few points. The distance has a kink at
        // each crossing.
        let far = DMat3::from_cols(DVec3::new(1.8, 0.3, 0.0), DVec3::new(0.3, 0.5, 0.1), DVec3::new(0.5, -0.4, 1.0));
        let m = near(&target, scale) * far;
        let found = loss.value_and_gradient(&m, Grain::Full, &mut StopCheck::new(&mut unstopped));
        let (at_m, gradient) = found.expect("nothing stops it");
        assert_eq!(at_m, value(&mut loss, &m));
        // The step is small compared with the lobe's width, and large compared with the spacing of its samples, so
        // their kinks average out.
        let step = 3e-3 * scale;
        let norm = gradient.to_cols_array().iter().map(|g| g * g).sum::<f64>().sqrt();
        for k in 0..9 {
            let moved = |by: f64| {
                let mut numbers = m.to_cols_array();
                numbers[k] += by;
                DMat3::from_cols_array(&numbers)
            };
            let difference = value(&mut loss, &moved(step)) - value(&mut loss, &moved(-step));
            let slope = difference / (2.0 * step);
            let analytic = gradient.to_cols_array()[k];
            assert!((slope - analytic).abs() < 0.01 * norm, "{scale} {k}: {slope} {analytic}");
        }
    }
}

#[test]
fn the_planted_matrix_has_the_least_loss() {
    let target = planted(lobe(0.3), NO_MIRRORS);
    let (samples, directions) = (samples(1024), directions(16));
    let mut buffers = Buffers::default();
    let mut loss = loss(&target, &samples, &directions, &mut buffers);
    let at_truth = value(&mut loss, &(target.frame.transpose() * lobe(0.3)));
    let nearby = value(&mut loss, &near(&target, 0.3));
    assert!(at_truth < 0.1 * nearby && at_truth < 0.02 * loss.spread(), "{at_truth} {nearby}");
}
