//! Compares random histories of a queue with a simple model. Each history is generated from its number, the seed.

use std::env;

use proptest::{
    prelude::*,
    sample::Index,
    test_runner::{RngAlgorithm, TestRng, TestRunner},
};

use super::world::{LIMITS, World, lease, new_job, result};
use crate::{
    queue::{
        Depth, JobId, JobState, LeaseError, LeasedTask, Limits, QueueError, Release, StaleLease, StateName, Submitted,
        TaskKind,
    },
    store::{Batch, Tree},
};
use ltcforge_files::digest::Digest;

const SHARDS: usize = 3;
const TTL: i64 = 10;
const RECIPES: u8 = 3;
const MODEL_LIMITS: Limits = Limits { jobs: 2, ..LIMITS };

#[derive(Debug, Clone)]
enum Action {
    /// Submit a recipe. The flag is true if the table of a done job is still stored.
    Submit(u8, bool),
    Cancel(u8),
    Lease(usize),
    /// Deliver a result under a current or stale lease.
    Deliver(Index),
    Fail(Index),
    GiveBack(Index),
    /// Renew a lease with one finished entry. This also ends expired leases.
    Renew(Index),
    Pass(i64),
    Restart,
    /// Do something while the disk is full.
    Full(Box<Action>),
}

fn action() -> impl Strategy<Value = Action> {
    let index = any::<Index>;
    let write = prop_oneof![
        3 => (0..RECIPES, any::<bool>()).prop_map(|(n, has_table)| Action::Submit(n, has_table)),
        1 => (0..RECIPES).prop_map(Action::Cancel),
        8 => index().prop_map(Action::Deliver),
    ];
    prop_oneof![
        12 => write.clone(),
        8 => (1..4_usize).prop_map(Action::Lease),
        3 => index().prop_map(Action::Fail),
        1 => index().prop_map(Action::GiveBack),
        2 => index().prop_map(Action::Renew),
        1 => (1..2 * TTL).prop_map(Action::Pass),
        1 => Just(Action::Restart),
        2 => write.prop_map(|action| Action::Full(Box::new(action))),
    ]
}

#[derive(Debug, Clone, PartialEq)]
enum Task {
    Waiting,
    Leased { lease: usize, until: i64, entries: u64 },
    Finished,
}

#[derive(Debug, Clone)]
struct ModelJob {
    state: StateName,
    tasks: Vec<Task>,
    leases: Vec<u32>,
    failures: Vec<u32>,
}

#[derive(Default)]
struct Model {
    jobs: [Option<ModelJob>; RECIPES as usize],
    /// All leases so far, with their recipes.
    leases: Vec<(u8, LeasedTask)>,
    now: i64,
}

fn name(n: u8) -> String {
    format!("recipe {n}")
}

fn digest(n: u8) -> Digest {
    Digest::of(name(n).as_bytes())
}

fn task_number(task: &LeasedTask) -> usize {
    match task.kind {
        TaskKind::Shard(number) => number as usize,
        TaskKind::Assemble => SHARDS,
    }
}

impl ModelJob {
    fn is_open(&self) -> bool {
        !self.state.is_final()
    }

    fn is_available(&self, number: usize) -> bool {
        let all_finished = self.tasks[..SHARDS].iter().all(|task| *task == Task::Finished);
        self.is_open() && self.tasks[number] == Task::Waiting && (number < SHARDS || all_finished)
    }

    fn put_back(&mut self, number: usize) {
        self.tasks[number] = Task::Waiting;
        if self.failures[number] >= 5 || self.leases[number] >= 25 {
            self.state = StateName::Failed;
        }
    }
}

impl Model {
    fn open(&self) -> impl Iterator<Item = &ModelJob> {
        self.jobs.iter().flatten().filter(|job| job.is_open())
    }

    fn available(&self) -> usize {
        self.open().map(|job| (0..=SHARDS).filter(|number| job.is_available(*number)).count()).sum()
    }

    fn put_back_expired(&mut self) {
        for job in self.jobs.iter_mut().flatten() {
            for number in 0..=SHARDS {
                if job.is_open() && matches!(job.tasks[number], Task::Leased { until, .. } if until <= self.now) {
                    job.put_back(number);
                }
            }
        }
    }

    /// A lease, and its job if the lease is current.
    fn pick(&mut self, index: Index) -> Option<(u8, LeasedTask, Option<&mut ModelJob>)> {
        if self.leases.is_empty() {
            return None;
        }
        let at = index.index(self.leases.len());
        let (n, task) = self.leases[at].clone();
        let number = task_number(&task);
        let job = self.jobs[usize::from(n)].as_mut();
        let is_current = |job: &&mut ModelJob| {
            job.is_open() && matches!(job.tasks[number], Task::Leased { lease, .. } if lease == at)
        };
        Some((n, task, job.filter(is_current)))
    }

    /// Applies an action to the queue and to the model, and compares their results.
    fn act<W: World>(&mut self, world: &mut W, action: &Action, is_full: bool) -> Result<(), TestCaseError> {
        match action {
            Action::Submit(n, has_table) => self.submit(world, *n, *has_table, is_full)?,
            Action::Cancel(n) => {
                let answer = world.queue().cancel(JobId::of_recipe(&digest(*n)), None);
                match &mut self.jobs[usize::from(*n)] {
                    None => prop_assert!(answer.unwrap().is_none()),
                    Some(job) if job.is_open() && is_full => prop_assert!(answer.is_err()),
                    Some(job) => {
                        if job.is_open() {
                            job.state = StateName::Cancelled;
                        }
                        prop_assert_eq!(answer.unwrap().unwrap().state.name(), job.state);
                    }
                }
            }
            Action::Lease(most) => {
                let tasks = lease(world.queue(), *most);
                prop_assert_eq!(tasks.len(), self.available().min(*most));
                for task in tasks {
                    let n = (0..RECIPES).find(|n| name(*n) == task.recipe).unwrap();
                    let number = task_number(&task);
                    let job = self.jobs[usize::from(n)].as_mut().unwrap();
                    prop_assert!(job.is_available(number), "{:?}", task);
                    job.state = StateName::Running;
                    job.leases[number] += 1;
                    job.tasks[number] = Task::Leased { lease: self.leases.len(), until: self.now + TTL, entries: 0 };
                    self.leases.push((n, task));
                }
            }
            Action::Deliver(index) => self.deliver(world, *index, is_full)?,
            Action::Fail(index) | Action::GiveBack(index) => {
                let Some((_, task, job)) = self.pick(*index) else { return Ok(()) };
                let is_failure = matches!(action, Action::Fail(_));
                let how = if is_failure { Release::Failed("x".to_owned()) } else { Release::GiveBack };
                let answer = world.queue().release(&task.lease, how);
                let number = task_number(&task);
                match job {
                    None => prop_assert!(matches!(answer, Err(LeaseError::Stale(_)))),
                    Some(job) => {
                        prop_assert!(answer.is_ok(), "{:?}", answer);
                        job.failures[number] += u32::from(is_failure);
                        job.leases[number] -= u32::from(!is_failure);
                        job.put_back(number);
                    }
                }
            }
            Action::Renew(index) => {
                let now = self.now;
                let Some((_, task, job)) = self.pick(*index) else { return Ok(()) };
                let answer = world.queue().renew(&[(task.lease, 1)]).unwrap();
                prop_assert_eq!(answer, [job.is_some().then_some(()).ok_or(StaleLease)]);
                if let Some(Task::Leased { until, entries, .. }) = job.map(|job| &mut job.tasks[task_number(&task)]) {
                    (*until, *entries) = (now + TTL, 1);
                }
                self.put_back_expired();
            }
            Action::Pass(seconds) => {
                world.pass(*seconds);
                self.now += seconds;
            }
            Action::Restart => {
                world.restart(MODEL_LIMITS);
                for job in self.jobs.iter_mut().flatten().filter(|_| !W::LEASES_SURVIVE) {
                    let is_unstarted = job.is_open() && !job.tasks.contains(&Task::Finished);
                    job.tasks.iter_mut().filter(|task| **task != Task::Finished).for_each(|task| *task = Task::Waiting);
                    job.failures.fill(0);
                    job.leases.fill(0);
                    if is_unstarted {
                        job.state = StateName::Queued;
                    }
                }
            }
            Action::Full(action) => {
                if world.fill(true) {
                    self.act(world, action, true)?;
                    world.fill(false);
                }
            }
        }
        self.agree(world)
    }

    fn submit<W: World>(&mut self, world: &W, n: u8, has_table: bool, is_full: bool) -> Result<(), TestCaseError> {
        let open = self.open().count();
        let answer = world.queue().submit(new_job(&name(n), SHARDS, 1.0), &|_| has_table);
        let slot = &mut self.jobs[usize::from(n)];
        match slot.as_ref().map(|job| job.state) {
            Some(state) if !state.is_final() => prop_assert!(matches!(answer, Ok(Submitted::Joined(_)))),
            Some(StateName::Done) if has_table => prop_assert!(matches!(answer, Ok(Submitted::Done(..)))),
            _ if open >= MODEL_LIMITS.jobs => prop_assert!(matches!(answer, Err(QueueError::Full(_))), "full"),
            _ if is_full => prop_assert!(matches!(answer, Err(QueueError::Store(_)))),
            state => {
                prop_assert!(matches!(answer, Ok(Submitted::Queued(_))), "{:?}", answer);
                let mut tasks = vec![Task::Waiting; SHARDS + 1];
                if let Some(job) = slot.as_ref().filter(|_| state == Some(StateName::Failed)) {
                    tasks.clone_from(&job.tasks);
                    tasks.iter_mut().filter(|task| **task != Task::Finished).for_each(|task| *task = Task::Waiting);
                }
                let zeros = vec![0; SHARDS + 1];
                *slot = Some(ModelJob { state: StateName::Queued, tasks, leases: zeros.clone(), failures: zeros });
            }
        }
        Ok(())
    }

    fn deliver<W: World>(&mut self, world: &W, index: Index, is_full: bool) -> Result<(), TestCaseError> {
        let Some((n, task, job)) = self.pick(index) else { return Ok(()) };
        if let TaskKind::Shard(number) = task.kind {
            let one = (task.lease, result(&task).into_bytes());
            let answer = world.queue().complete(&[one.clone(), one]);
            match job {
                Some(_) if is_full => prop_assert!(answer.is_err()),
                Some(job) => {
                    prop_assert_eq!(answer.unwrap(), [Ok(()), Err(StaleLease)]);
                    job.tasks[number as usize] = Task::Finished;
                }
                // PostgreSQL accepts the same result under the same lease again.
                None => prop_assert_eq!(answer.unwrap()[1], Err(StaleLease)),
            }
            return Ok(());
        }
        let results = world.queue().results(&task.lease);
        let mut rows = Batch::default();
        rows.put(Tree::Recipes, digest(n).as_bytes().as_slice(), "row");
        let finished = world.queue().finish(&task.lease, digest(n), rows);
        match job {
            None => prop_assert!(matches!(results, Err(LeaseError::Stale(_)))),
            Some(job) => {
                let wanted = (0..SHARDS as u32).map(|number| format!("{}/{:?}", name(n), TaskKind::Shard(number)));
                prop_assert_eq!(results.unwrap(), wanted.map(String::into_bytes).collect::<Vec<_>>());
                if is_full {
                    prop_assert!(matches!(finished, Err(LeaseError::Store(_))));
                } else {
                    prop_assert!(finished.is_ok());
                    job.state = StateName::Done;
                }
            }
        }
        Ok(())
    }

    /// Checks that queue and model agree on all jobs, the depth and the stored results.
    fn agree<W: World>(&self, world: &W) -> Result<(), TestCaseError> {
        let (mut depth, mut results) = (Depth::default(), 0);
        for (n, wanted) in (0..RECIPES).zip(&self.jobs) {
            let job = world.queue().job(JobId::of_recipe(&digest(n))).unwrap();
            prop_assert_eq!(job.as_ref().map(|job| job.state.name()), wanted.as_ref().map(|job| job.state));
            let (Some(job), Some(wanted)) = (job, wanted) else { continue };
            let shards = &wanted.tasks[..SHARDS];
            let finished = shards.iter().filter(|task| **task == Task::Finished).count();
            if wanted.is_open() {
                let leased = shards.iter().filter_map(|task| match task {
                    Task::Leased { entries, .. } => Some(*entries),
                    _ => None,
                });
                depth.leased += leased.clone().count() as u64;
                depth.waiting += shards.iter().filter(|task| **task == Task::Waiting).count() as u64;
                prop_assert_eq!(job.entries_done, 2 * finished as u64 + leased.sum::<u64>());
                prop_assert_eq!(job.attempts, *wanted.leases.iter().max().unwrap());
            }
            let keeps = wanted.is_open() || wanted.state == StateName::Failed;
            results += if keeps { finished } else { 0 };
            if let JobState::Done { table } = job.state {
                prop_assert_eq!(table, digest(n));
                prop_assert_eq!(world.queue().job_of_table(table).unwrap().unwrap().id, job.id);
            }
        }
        prop_assert_eq!(world.queue().statistics().unwrap().depth, depth);
        prop_assert_eq!(world.results(), results);
        Ok(())
    }
}

fn agrees<W: World>(mut world: W, actions: &[Action]) -> Result<(), TestCaseError> {
    let mut model = Model::default();
    actions.iter().try_for_each(|action| model.act(&mut world, action, false))
}

/// The number in an environment variable.
fn number(name: &str) -> Option<u64> {
    env::var(name).ok().map(|text| text.parse().unwrap_or_else(|_| panic!("{name} must be a number, got {text}")))
}

/// Runs a history for each seed up to [`World::HISTORIES`] or `LTCFORGE_TEST_HISTORIES`, or only `LTCFORGE_TEST_SEED`.
pub(super) fn every_history_agrees_with_the_model<W: World>() {
    let seeds = match number("LTCFORGE_TEST_SEED") {
        Some(seed) => seed..seed + 1,
        None => 0..number("LTCFORGE_TEST_HISTORIES").map_or(W::HISTORIES, |all| all.div_ceil(W::PART)),
    };
    for seed in seeds {
        let mut bytes = [0; 32];
        bytes[..8].copy_from_slice(&seed.to_le_bytes());
        let config = ProptestConfig { cases: 1, failure_persistence: None, ..ProptestConfig::default() };
        let mut runner = TestRunner::new_with_rng(config, TestRng::from_seed(RngAlgorithm::ChaCha, &bytes));
        let ran = runner.run(&prop::collection::vec(action(), 1..120), |actions| match W::new(MODEL_LIMITS) {
            Some(world) => agrees(world, &actions),
            None => Ok(()),
        });
        ran.unwrap_or_else(|error| panic!("LTCFORGE_TEST_SEED={seed} replays this history: {error}"));
    }
}
