//! Compares our fitter with the published algorithm, run to its end, on the same lobes at the same time.
//!
//! `cargo bench --bench speedup [-- STEPS]` fits each entry with preset `paper`, and with solver `sgd` at the paper's
//! settings: 10,000 steps by default, with 2048 samples and 64 directions. It takes a quarter of an hour on two cores.
//! It prints the time and the error of both fits for 16 lobes. It writes the matrices, in the format of `ltcforge
//! lookup`, to `target/speedup/{ours,published}.csv` in the current folder.

use std::{
    fs,
    ops::ControlFlow,
    time::{Duration, Instant},
};

use ltcforge::glam::DMat3;
use ltcforge::{
    Preset, Recipe, RecipeBuilder, RecipeDocument as _,
    fit::{
        FitSettings, Fitter, Solver, StopCheck,
        brdf::Ggx,
        math::{direction, from_row_major, recurrence4, row_major},
    },
};
use rayon::prelude::*;

const LOBES: usize = 16;
/// Repetitions of our fit, which takes milliseconds. The bench prints the median.
const REPEATS: usize = 31;

/// The time of one lobe, and its error.
struct Row {
    place: [f64; 4],
    ours: (Duration, f64, DMat3),
    published: (Duration, f64, DMat3),
}

/// The fit settings of a recipe.
fn settings(builder: RecipeBuilder) -> FitSettings {
    builder.build().expect("settings within their bounds").fit()
}

fn main() {
    let steps = std::env::args().skip(1).find_map(|argument| argument.parse().ok()).unwrap_or(10_000);
    let sgd = settings(Recipe::builder().solver(Solver::Sgd).samples(2048).directions(64).steps(steps));
    let rows: Vec<Row> = (0..LOBES).into_par_iter().with_max_len(1).map(|k| compare(k, &sgd)).collect();

    println!("alpha_x  alpha_y   theta     phi |    ours   error | published   error | times");
    for Row { place: [alpha_x, alpha_y, theta, phi], ours, published } in &rows {
        let times = published.0.as_secs_f64() / ours.0.as_secs_f64();
        println!(
            "{alpha_x:7.4}  {alpha_y:7.4} {theta:7.4} {phi:7.4} | {:5.2} ms {:.5} | {:7.2} s {:.5} | {times:.0}",
            1e3 * ours.0.as_secs_f64(),
            ours.1,
            published.0.as_secs_f64(),
            published.1
        );
    }
    let mean = |value: fn(&Row) -> f64| rows.iter().map(value).sum::<f64>() / LOBES as f64;
    let (ours, published) = (mean(|row| row.ours.0.as_secs_f64()), mean(|row| row.published.0.as_secs_f64()));
    println!(
        "mean: {:.0} times faster ({published:.1} s against {:.2} ms), error {:.5} against {:.5}; lower on {} of {LOBES}",
        published / ours,
        1e3 * ours,
        mean(|row| row.ours.1),
        mean(|row| row.published.1),
        rows.iter().filter(|row| row.ours.1 <= row.published.1).count()
    );
    write("ours", &rows, |row| row.ours.2);
    write("published", &rows, |row| row.published.2);
}

/// Lobe `k`: alpha, the smaller alpha, theta and phi. Lobes are of materials as artists set them, evenly distributed in
/// perceptual roughness, ratio, theta and phi.
fn place(k: usize) -> [f64; 4] {
    let [roughness, ratio, theta, phi] = recurrence4(k, [0.5, 0.1, 0.9, 0.3]);
    let alpha = (0.05 + 0.95 * roughness) * (0.05 + 0.95 * roughness);
    [alpha, alpha * (0.05 + 0.95 * ratio), 1.55 * theta, 1.57 * phi]
}

fn compare(k: usize, sgd: &FitSettings) -> Row {
    let place = place(k);
    let [alpha_x, alpha_y, theta, phi] = place;
    let (ggx, wo) = (Ggx { alpha_x, alpha_y }, direction(theta, phi));
    let mut go_on = || ControlFlow::Continue(());

    let mut fitter = Fitter::new(&Preset::Paper.fit());
    let mut fitted = || {
        let start = Instant::now();
        let entry = fitter.fit(&ggx, wo, 0, &mut StopCheck::new(&mut go_on)).expect("nothing stops it");
        (start.elapsed(), from_row_major(&entry.matrix))
    };
    let mut runs: Vec<(Duration, DMat3)> = (0..REPEATS).map(|_| fitted()).collect();
    runs.sort_by_key(|(time, _)| *time);
    let (our_time, our_matrix) = runs[REPEATS / 2];

    let mut descend = Fitter::new(sgd);
    let start = Instant::now();
    let their_matrix =
        descend.descended(&ggx, wo, k as u64, &mut StopCheck::new(&mut go_on)).expect("nothing stops it");
    let their_time = start.elapsed();

    // Samples that neither fit used.
    let mut judge = Fitter::new(&settings(Recipe::builder().samples(4096).directions(64).seed(7)));
    let mut error = |m: &DMat3| judge.error(&ggx, wo, m);
    let (our_error, their_error) = (error(&our_matrix), error(&their_matrix));
    Row { place, ours: (our_time, our_error, our_matrix), published: (their_time, their_error, their_matrix) }
}

fn write(name: &str, rows: &[Row], matrix: fn(&Row) -> DMat3) {
    let line = |row: &Row| {
        let numbers: Vec<String> =
            row.place.into_iter().chain(row_major(&matrix(row))).map(|x| format!("{x:?}")).collect();
        numbers.join(",") + "\n"
    };
    let text: String = rows.iter().map(line).collect();
    let written =
        fs::create_dir_all("target/speedup").and_then(|()| fs::write(format!("target/speedup/{name}.csv"), text));
    if let Err(error) = written {
        eprintln!("target/speedup/{name}.csv: {error}");
    }
}
