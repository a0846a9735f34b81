//! Measured against predicted seconds of each solver.
//!
//! `cargo bench -p ltcforge-benches --bench cost [-- LARGEST]`: each solver's fits of a small table, at samples from 128
//! to 65,536, or to LARGEST, and 8 and 64 directions, in processor seconds of the thread, beside the prediction of
//! `fit_seconds`: some minutes. How fast the machine is changes all rows by the same factor; a row that differs from the
//! others shows a wrong prediction.

use std::{fs, ops::ControlFlow, time::Instant};

use ltcforge::{
    Recipe, RecipeDocument as _,
    fit::{Plan, Solver, fit_seconds, fit_shard},
};

const SAMPLES: [u32; 4] = [128, 512, 4096, 65_536];
const DIRECTIONS: [u32; 2] = [8, 64];
/// Steps of each solver: `bfgs` converges sooner; each of `sgd` is like the next.
const STEPS: [(Solver, u32); 2] = [(Solver::Bfgs, 60), (Solver::Sgd, 10)];
/// Nodes of the table.
const RESOLUTION: [(&str, u32); 4] = [("alpha", 3), ("ratio", 3), ("theta", 3), ("phi", 2)];

fn main() {
    let largest = std::env::args().skip(1).find_map(|argument| argument.parse().ok()).unwrap_or(SAMPLES[3]);
    println!("solver  steps  samples  directions |  measured  predicted  ratio");
    for (solver, steps) in STEPS {
        for samples in SAMPLES.into_iter().filter(|samples| *samples <= largest) {
            for directions in DIRECTIONS {
                let builder = Recipe::builder().solver(solver).samples(samples).directions(directions).steps(steps);
                let recipe = RESOLUTION.iter().fold(builder, |builder, (axis, nodes)| builder.resolution(axis, *nodes));
                let recipe = recipe.build().expect("settings within their bounds");
                let predicted = fit_seconds(&recipe);
                let measured = measure(&Plan::new(&recipe));
                println!(
                    "{solver:6}  {steps:5}  {samples:7}  {directions:10} | {measured:9.4}  {predicted:9.4}  {:5.2}",
                    measured / predicted
                );
            }
        }
    }
}

/// Processor seconds of the fit on this thread.
fn measure(plan: &Plan) -> f64 {
    let start = Clock::now();
    for shard in 0..plan.shards() {
        fit_shard(plan, shard, &mut |_| ControlFlow::Continue(())).expect("nothing stops it");
    }
    start.seconds()
}

/// A moment, and the processor time of the thread until then where the system tells it.
struct Clock {
    wall: Instant,
    nanoseconds: Option<u64>,
}

impl Clock {
    fn now() -> Self {
        Self { wall: Instant::now(), nanoseconds: processor_nanoseconds() }
    }

    fn seconds(&self) -> f64 {
        let since = |start: u64| processor_nanoseconds().map(|now| 1e-9 * (now - start) as f64);
        self.nanoseconds.and_then(since).unwrap_or_else(|| self.wall.elapsed().as_secs_f64())
    }
}

/// Processor time of this thread, which Linux tells.
fn processor_nanoseconds() -> Option<u64> {
    fs::read_to_string("/proc/thread-self/schedstat").ok()?.split_ascii_whitespace().next()?.parse().ok()
}
