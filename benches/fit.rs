//! The cost of an entry: one evaluation, one entry for each preset, and one step of the paper's algorithm.
//!
//! At its end, `cargo bench --bench fit` prints the speed-up over the paper's fitter. This is the time of the paper's
//! fit, divided by the time of an entry with preset `paper`. The paper's fit has 10,000 steps with 2048 samples and 64
//! directions. Its time comes from a step measured in the same run.
#![allow(missing_docs, reason = "criterion's macros define undocumented functions")]

use std::{
    hint::black_box,
    ops::ControlFlow,
    time::{Duration, Instant},
};

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use ltcforge::glam::DVec3;
use ltcforge::{
    Recipe, RecipeDocument as _,
    files::recipe_document::Preset,
    fit::{FitSettings, Fitter, Solver, StopCheck, brdf::Ggx, math::sin_cos},
};

/// The paper's schedule [KT et al. 2022, section 4].
const PAPER_STEPS: u32 = 10_000;
const PAPER_SAMPLES: u32 = 2048;
const PAPER_DIRECTIONS: u32 = 64;

/// Lobes across the domain: from broad to needle-like and mirror-like, and from views from above to grazing views.
const LOBES: [(f64, f64, f64, f64); 16] = [
    (1.0, 1.0, 0.3, 0.2),
    (1.0, 0.3, 0.9, 1.2),
    (0.8, 0.1, 1.2, 0.7),
    (0.8, 0.6, 1.5, 0.4),
    (0.6, 0.6, 0.6, 1.0),
    (0.6, 0.05, 0.2, 0.5),
    (0.5, 0.2, 1.0, 0.1),
    (0.4, 0.3, 1.4, 1.4),
    (0.3, 0.3, 0.1, 0.8),
    (0.3, 0.01, 0.8, 0.6),
    (0.2, 0.1, 1.3, 1.1),
    (0.1, 0.1, 0.5, 0.3),
    (0.1, 0.02, 1.1, 0.9),
    (0.03, 0.03, 0.7, 1.3),
    (0.01, 0.002, 1.2, 0.5),
    (0.001, 0.001, 0.4, 0.6),
];

fn view(theta: f64, phi: f64) -> DVec3 {
    let ((sin_theta, cos_theta), (sin_phi, cos_phi)) = (sin_cos(theta), sin_cos(phi));
    DVec3::new(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta)
}

fn go_on() -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn settings(solver: Solver, samples: u32, directions: u32, steps: u32) -> FitSettings {
    let builder = Recipe::builder().solver(solver).samples(samples).directions(directions).steps(steps);
    builder.build().expect("settings within their bounds").fit()
}

/// Fits every lobe once.
fn fit_all(fitter: &mut Fitter) {
    for (alpha_x, alpha_y, theta, phi) in LOBES {
        black_box(fitter.fit(&Ggx { alpha_x, alpha_y }, view(theta, phi), 0, &mut StopCheck::new(&mut go_on)));
    }
}

fn evaluation(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("loss and gradient");
    for preset in Preset::ALL {
        let fit = preset.fit();
        let ggx = Ggx { alpha_x: 0.4, alpha_y: 0.1 };
        Fitter::new(&fit).with_evaluation(&ggx, view(1.0, 0.6), |evaluate| {
            group.bench_function(BenchmarkId::from_parameter(preset.name()), |bencher| bencher.iter(&mut *evaluate));
        });
    }
    group.finish();
}

fn entry(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("16 entries");
    group.sample_size(10);
    for preset in Preset::ALL {
        let mut fitter = Fitter::new(&preset.fit());
        group.bench_function(BenchmarkId::from_parameter(preset.name()), |bencher| {
            bencher.iter(|| fit_all(&mut fitter));
        });
    }
    group.finish();
}

fn paper_step(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("16 entries, one step of sgd");
    group.sample_size(10);
    let mut descend = Fitter::new(&settings(Solver::Sgd, PAPER_SAMPLES, PAPER_DIRECTIONS, 1));
    group.bench_function("2048 x 64", |bencher| {
        bencher.iter(|| {
            for (alpha_x, alpha_y, theta, phi) in LOBES {
                black_box(descend.descended(
                    &Ggx { alpha_x, alpha_y },
                    view(theta, phi),
                    0,
                    &mut StopCheck::new(&mut go_on),
                ));
            }
        });
    });
    group.finish();
}

/// The medians of seven runs of both fits. The runs alternate, so a busy machine slows both.
fn speed_up(_: &mut Criterion) {
    const RUNS: usize = 7;
    const STEPS: u32 = 4;
    let mut ours = Fitter::new(&Preset::Paper.fit());
    let mut theirs = Fitter::new(&settings(Solver::Sgd, PAPER_SAMPLES, PAPER_DIRECTIONS, STEPS));
    let timed = |work: &mut dyn FnMut()| {
        let start = Instant::now();
        work();
        start.elapsed()
    };
    let (mut entries, mut steps) = (Vec::new(), Vec::new());
    for _ in 0..RUNS {
        entries.push(timed(&mut || fit_all(&mut ours)) / LOBES.len() as u32);
        steps.push(
            timed(&mut || {
                for (alpha_x, alpha_y, theta, phi) in LOBES {
                    black_box(theirs.descended(
                        &Ggx { alpha_x, alpha_y },
                        view(theta, phi),
                        0,
                        &mut StopCheck::new(&mut go_on),
                    ));
                }
            }) / (LOBES.len() as u32 * STEPS),
        );
    }
    let median = |times: &mut Vec<Duration>| {
        times.sort();
        times[times.len() / 2]
    };
    let (entry, step) = (median(&mut entries), median(&mut steps));
    println!(
        "speed-up over the paper's algorithm: {:.0} ({PAPER_STEPS} steps of {step:?} against {entry:?} per entry)",
        step.as_secs_f64() * f64::from(PAPER_STEPS) / entry.as_secs_f64()
    );
}

criterion_group!(benches, evaluation, entry, paper_step, speed_up);
criterion_main!(benches);
