//! Finds the constants that predict the seconds of a fit: in `src/fit/cost.rs`, `metric` and `solver`.
//!
//! For each solver, the study measures fits of a few lobes at several samples and directions, in processor seconds of
//! one thread. It finds the constants with the least relative error. The speed of the machine scales all constants by
//! one factor, which the study prints. Only their proportions matter.

use std::{fmt::Write as _, ops::ControlFlow};

use ltcforge::{
    BrdfKind, LobeModel, Metric, Recipe, RecipeDocument as _, Solver, Start,
    fit::{Plan, fit_seconds, fit_shard, width_between},
};

use crate::{
    clock::Clock,
    linear::{Measured, least_squares, predicted, relative_error},
    source::number,
    tables::fitted,
};

/// The name of a constant, its file, and its index in a list.
struct Constant {
    name: &'static str,
    file: &'static str,
    source: &'static str,
    index: usize,
}

macro_rules! constant {
    ($name:literal, $file:literal, $index:literal) => {
        Constant { name: $name, file: $file, source: include_str!(concat!("../../src/fit/", $file)), index: $index }
    };
}

const CONSTANTS: [Constant; 11] = [
    constant!("EVALUATION_SECONDS", "metric/sw1/mod.rs", 0),
    constant!("DIRECTION_SECONDS", "metric/sw1/mod.rs", 0),
    constant!("SAMPLE_SECONDS", "metric/l3/mod.rs", 0),
    constant!("IMAGE_SECONDS", "solver/bfgs/gaussian.rs", 0),
    constant!("DRAW_SECONDS", "solver/sgd.rs", 0),
    constant!("SORT_SECONDS", "solver/sgd.rs", 0),
    constant!("SORT_SECONDS", "solver/sgd.rs", 1),
    constant!("DENSITY_SECONDS", "solver/sgd.rs", 0),
    constant!("REST_SECONDS", "solver/sgd.rs", 0),
    constant!("SAMPLING_SECONDS", "cost.rs", 0),
    constant!("ENTRY_SECONDS", "cost.rs", 0),
];
const STEP_SAMPLING: Constant = constant!("STEP_SAMPLING", "cost.rs", 0);
const POINT: Constant = constant!("POINT_SECONDS", "measure/effort.rs", 0);
/// The numbers of evaluations that the model assumes for a fit by `bfgs`, a fit by `nelder_mead`, and a step of
/// `nelder_mead`. The study does not search for them, because the seconds per evaluation depend on them.
const EVALUATIONS: [Constant; 3] = [
    constant!("EVALUATIONS", "solver/bfgs/mod.rs", 0),
    constant!("EVALUATIONS", "solver/nelder_mead/mod.rs", 0),
    constant!("STEP_EVALUATIONS", "solver/nelder_mead/mod.rs", 0),
];

impl Constant {
    /// The current value. NaN if the source has no such constant. A test checks that it is not NaN.
    fn current(&self) -> f64 {
        number(self.source, self.name, self.index).unwrap_or(f64::NAN)
    }
}

/// Lobes per measured fit. No two lobes of the table are equal.
const ISOTROPIC_LOBES: u32 = 9;
const LOBES: u32 = 18;

/// A fit to measure.
#[derive(Debug, Clone, Copy)]
struct Task {
    brdf: BrdfKind,
    lobe: LobeModel,
    metric: Metric,
    solver: Solver,
    samples: u32,
    directions: u32,
    steps: u32,
}

const USUAL: Task = Task {
    brdf: BrdfKind::Ggx,
    lobe: LobeModel::Ltc,
    metric: Metric::Sw1,
    solver: Solver::Bfgs,
    samples: 512,
    directions: 16,
    steps: 60,
};

impl Task {
    fn is_isotropic(&self) -> bool {
        self.solver == Solver::NelderMead || self.brdf.is_isotropic()
    }

    /// # Errors
    /// The settings are out of bounds.
    fn recipe(&self) -> Result<Recipe, ltcforge::Error> {
        let Self { brdf, lobe, metric, solver, samples, directions, steps } = *self;
        let builder = Recipe::builder().brdf(brdf).lobe(lobe).metric(metric).solver(solver);
        let builder = builder.samples(samples).directions(directions).steps(steps);
        let builder =
            builder.range("alpha", 0.1, 0.9).resolution("alpha", 3).range("theta", 0.2, 1.3).resolution("theta", 3);
        let builder = if solver == Solver::NelderMead { builder.start(Start::Independent) } else { builder };
        if self.is_isotropic() {
            return builder.isotropic().build();
        }
        builder.range("ratio", 0.3, 0.3).range("phi", 0.3, 1.2).resolution("phi", 2).build()
    }

    /// The factor of each constant in the seconds of one entry.
    fn factors(&self) -> [f64; CONSTANTS.len()] {
        let [samples, directions, steps] = [self.samples, self.directions, self.steps].map(f64::from);
        let [bfgs, simplex, of_step] = EVALUATIONS.map(|constant| constant.current());
        let evaluations = match self.solver {
            Solver::Bfgs => steps.min(bfgs),
            Solver::NelderMead => (steps * of_step).min(simplex),
            Solver::Sgd => 0.0,
        };
        let is_sw1 = self.metric == Metric::Sw1;
        let sw1 = if is_sw1 { evaluations } else { 0.0 };
        let numbers = match self.lobe {
            LobeModel::Ltc => 0.0,
            LobeModel::Sg => 4.0,
            LobeModel::Asg => 6.0,
        };
        let samples_of_steps = if self.solver == Solver::Sgd { steps * samples } else { 0.0 };
        let sorted = if is_sw1 { samples_of_steps * directions } else { 0.0 };
        let is_descent = if self.solver == Solver::Sgd { 1.0 } else { 0.0 };
        [
            sw1 * directions * samples,
            sw1 * directions,
            (evaluations - sw1) * samples,
            evaluations * samples * numbers,
            samples_of_steps,
            sorted,
            sorted * samples.log2(),
            if is_sw1 { 0.0 } else { samples_of_steps },
            is_descent * samples * directions,
            samples,
            1.0,
        ]
    }

    /// Processor seconds of one entry: the least of `runs` runs.
    fn measure(&self, runs: usize) -> Result<f64, ltcforge::Error> {
        let lobes = if self.is_isotropic() { ISOTROPIC_LOBES } else { LOBES };
        Ok(seconds_of(&self.recipe()?, runs) / f64::from(lobes))
    }

    fn current(&self) -> Result<f64, ltcforge::Error> {
        let lobes = if self.is_isotropic() { ISOTROPIC_LOBES } else { LOBES };
        Ok(fit_seconds(&self.recipe()?) / f64::from(lobes))
    }

    fn name(&self) -> String {
        let Self { brdf, lobe, metric, solver, samples, directions, steps } = self;
        format!("{brdf} {lobe}, `{metric}` by `{solver}` | {samples} x {directions} x {steps}")
    }
}

/// Samples and directions of the fits, in all combinations. Some fits find the constants, and others test them.
#[derive(Debug, Clone, Copy)]
pub struct Efforts {
    /// The fits that find the constants.
    pub training: [&'static [u32]; 2],
    /// The fits that test the constants.
    pub held_out: [&'static [u32]; 2],
    /// Runs of each fit. Only the shortest run counts.
    pub runs: usize,
}

impl Efforts {
    /// The full study. It takes half a minute.
    pub const WHOLE: Self = Self { training: [&[128, 512, 4096], &[8, 64]], held_out: [&[256, 1024], &[32]], runs: 5 };
}

/// The fits for GGX.
fn tasks([samples, directions]: [&'static [u32]; 2]) -> Vec<Task> {
    let grid = || samples.iter().flat_map(|s| directions.iter().map(|d| Task { samples: *s, directions: *d, ..USUAL }));
    let few = || samples.iter().map(|s| Task { samples: (*s).min(2048), ..USUAL });
    let mut tasks: Vec<Task> = grid().collect();
    tasks.extend(grid().map(|task| Task { solver: Solver::Sgd, steps: 10, ..task }));
    // Fits with few steps show the time spent outside the steps.
    tasks.extend(grid().map(|task| Task { solver: Solver::Sgd, steps: 1, ..task }));
    tasks.extend(few().map(|task| Task { metric: Metric::L3, ..task }));
    tasks.extend(few().map(|task| Task { metric: Metric::L3, solver: Solver::NelderMead, ..task }));
    tasks.extend(few().map(|task| Task { metric: Metric::L3, solver: Solver::Sgd, steps: 10, ..task }));
    for lobe in [LobeModel::Sg, LobeModel::Asg] {
        tasks.extend(few().map(|task| Task { lobe, ..task }));
    }
    tasks
}

/// The found constants, and the errors of the seconds that the found and the current constants predict.
#[derive(Debug, Clone)]
struct Found {
    /// The found constants, ordered as in the printed table.
    constants: [f64; CONSTANTS.len()],
    /// Relative errors for the training fits and for the held-out fits.
    relative_errors: [f64; 2],
    /// Measured seconds divided by the seconds that the current constants predict, for every fit.
    over_current: Vec<f64>,
}

/// Finds the constants. `seconds_of` returns the seconds of a fit. Calls `report` for each fit, with its name and its
/// measured and predicted seconds.
fn find(
    efforts: &Efforts,
    seconds_of: impl Fn(&Task) -> Result<f64, ltcforge::Error>,
    mut report: impl FnMut(&str, f64, f64),
) -> Result<Found, ltcforge::Error> {
    let mut over_current = Vec::new();
    let mut measure = |tasks: Vec<Task>| -> Result<Vec<Measured<11>>, ltcforge::Error> {
        let measured = tasks.iter().map(|task| {
            let (value, current) = (seconds_of(task)?, task.current()?);
            report(&task.name(), value, current);
            over_current.push(value / current);
            Ok(Measured { factors: task.factors(), value })
        });
        measured.collect()
    };
    let (training, held_out) = (measure(tasks(efforts.training))?, measure(tasks(efforts.held_out))?);
    let constants = least_squares(&training);
    let relative_errors = [&training, &held_out].map(|measured| relative_error(measured, &constants));
    Ok(Found { constants, relative_errors, over_current })
}

fn median(mut ratios: Vec<f64>) -> f64 {
    ratios.sort_by(f64::total_cmp);
    ratios[ratios.len() / 2]
}

/// The constants as text: the current values, the found values, and the found values scaled to the speed of the current
/// values.
///
/// # Errors
/// None, because the settings of all fits are within bounds.
pub fn text(efforts: &Efforts) -> Result<String, ltcforge::Error> {
    let runs = efforts.runs;
    let mut out =
        "| fit | samples x directions x steps | measured, ms | over current |\n|---|---|---|---|\n".to_owned();
    // Writing to a String cannot fail.
    let found = find(
        efforts,
        |task| task.measure(runs),
        |name, measured, current| {
            let _ = writeln!(out, "| {name} | {:.3} | {:.2} |", 1e3 * measured, measured / current);
        },
    )?;
    let speed = median(found.over_current.clone());
    let [training, held_out] = found.relative_errors.map(|error| 100.0 * error);
    let _ = writeln!(
        out,
        "\nThis machine takes {speed:.2} times as long. Relative error of the found constants: {training:.0} % for the training fits, {held_out:.0} % for other fits.\n"
    );
    out += "| constant | file | current | found | found, at the speed of the current values |\n|---|---|---|---|---|\n";
    let mut line = |constant: &Constant, found: f64| {
        let Constant { name, file, index, .. } = constant;
        let _ = writeln!(
            out,
            "| `{name}`, {index} | `src/fit/{file}` | {:.2e} | {found:.1e} | {:.1e} |",
            constant.current(),
            found / speed
        );
    };
    for (constant, found) in CONSTANTS.iter().zip(found.constants) {
        line(constant, found);
    }
    line(&POINT, point_seconds()?);
    out += &factors(runs, &found.constants)?;
    Ok(out)
}

/// Seconds per configuration of a report, on all threads.
fn point_seconds() -> Result<f64, ltcforge::Error> {
    const POINTS: usize = 256;
    let table = fitted(&Recipe::builder().preset(ltcforge::Preset::Draft).build()?);
    let start = Clock::of_process();
    let _ = width_between(&table, POINTS);
    Ok(start.seconds() / POINTS as f64)
}

/// The cost of samples for other scattering models relative to samples for GGX, and the share of these samples in a
/// step.
fn factors(runs: usize, constants: &[f64; 11]) -> Result<String, ltcforge::Error> {
    let few = Task { samples: 4096, directions: 4, steps: 1, ..USUAL };
    let sampling = constants[9] * f64::from(few.samples);
    let mut out = "\n| model | cost of its samples over GGX's |\n|---|---|\n".to_owned();
    let (mut beckmann, ggx_seconds) = (1.0, few.measure(runs)?);
    for brdf in BrdfKind::formulas().filter(|kind| *kind != BrdfKind::Ggx) {
        // A model with only isotropic lobes is compared with isotropic lobes for GGX.
        let ggx = if brdf.is_isotropic() { isotropic_ggx(&few, runs)? } else { ggx_seconds };
        let over = 1.0 + (Task { brdf, ..few }.measure(runs)? - ggx) / sampling;
        if brdf == BrdfKind::Beckmann {
            beckmann = over;
        }
        let _ = writeln!(out, "| `{brdf}` | {over:.1} |");
    }
    let descent = Task { metric: Metric::L3, solver: Solver::Sgd, steps: 10, samples: 2048, ..USUAL };
    let rest = |over: f64| {
        predicted(&Task { steps: 0, ..descent }.factors(), constants)
            + constants[9] * (over - 1.0) * f64::from(descent.samples)
    };
    let steps = Task { brdf: BrdfKind::Beckmann, ..descent }.measure(runs)? - rest(beckmann);
    let ggx_steps = descent.measure(runs)? - rest(1.0);
    let found = (steps / ggx_steps - 1.0) / (beckmann - 1.0);
    let _ = writeln!(out, "\n`STEP_SAMPLING`: {:.2} current, {found:.2} found", STEP_SAMPLING.current());
    Ok(out)
}

/// The seconds of a task with isotropic lobes for GGX.
fn isotropic_ggx(task: &Task, runs: usize) -> Result<f64, ltcforge::Error> {
    let builder = Recipe::builder().samples(task.samples).directions(task.directions).steps(task.steps);
    let builder =
        builder.range("alpha", 0.1, 0.9).resolution("alpha", 3).range("theta", 0.2, 1.3).resolution("theta", 3);
    Ok(seconds_of(&builder.isotropic().build()?, runs) / f64::from(ISOTROPIC_LOBES))
}

/// Processor seconds of the fits of a recipe on one thread: the least of `runs` runs.
fn seconds_of(recipe: &Recipe, runs: usize) -> f64 {
    let plan = Plan::new(recipe);
    let run = || {
        let start = Clock::of_thread();
        for shard in 0..plan.shards() {
            let _ = fit_shard(&plan, shard, &mut |_| ControlFlow::Continue(()));
        }
        start.seconds()
    };
    (0..runs).map(|_| run()).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The factors of the study agree with the model: with the current constants they give `fit_seconds`.
    #[test]
    fn the_current_constants_predict_the_seconds_of_the_model() {
        let current = CONSTANTS.map(|constant| constant.current());
        assert!(current.iter().chain([&STEP_SAMPLING.current(), &POINT.current()]).all(|x| x.is_finite()));
        for task in tasks(Efforts::WHOLE.training) {
            let [found, wanted] = [predicted(&task.factors(), &current), task.current().expect("a recipe")];
            assert!((found / wanted - 1.0).abs() < 1e-9, "{task:?}: {found} {wanted}");
        }
    }

    /// The study can find the constants of a machine on which they have other proportions.
    #[test]
    fn planted_seconds_give_planted_constants() {
        let mut planted = CONSTANTS.map(|constant| constant.current());
        for (i, constant) in planted.iter_mut().enumerate() {
            *constant *= 1.0 + 0.2 * (i % 4) as f64;
        }
        let seconds_of = |task: &Task| Ok(predicted(&task.factors(), &planted));
        let found = find(&Efforts::WHOLE, seconds_of, |_, _, _| {}).expect("recipes");
        assert!(found.relative_errors.iter().all(|error| *error < 1e-6), "{found:?}");
        for (found, planted) in found.constants.iter().zip(planted) {
            assert!((found / planted - 1.0).abs() < 1e-3, "{found:e} {planted:e}");
        }
    }

    /// On every machine, a fit takes more than zero seconds.
    #[test]
    fn a_fit_takes_time() {
        let few = Task { samples: 64, directions: 4, steps: 1, ..USUAL };
        assert!(few.measure(1).expect("a recipe") > 0.0);
    }
}
