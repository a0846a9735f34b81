//! The queue compared with a simple model of it, under random histories with restarts, power cuts and full disks.

use std::{
    collections::{BTreeMap, BTreeSet},
    num::{NonZeroU32, NonZeroUsize},
    time::Duration,
};

use proptest::{prelude::*, test_runner::TestCaseResult};

use super::{
    actions::{Action, LEASE_SECONDS, SHARDS, recipe, result},
    world::{World, results},
};
use crate::{
    queue::{
        Demand, FailureKind, JobId, JobState, LeaseError, LeasedTask, Limits, MOST_DEATHS, Offer, QueueError,
        Submitted, TaskKind,
    },
    store::Batch,
};
use ltcforge_files::digest::Digest;

const MAX_ATTEMPTS: u32 = 3;

/// The state that a job must have, given the queue's answers so far.
#[derive(Debug, Clone)]
struct ExpectedJob {
    stage: Stage,
    /// Shards whose completion was acknowledged in this submission, or kept from a failed one.
    finished: BTreeSet<u32>,
    /// Its result was refused because the job failed while it was on its way to the disk. It may be kept nevertheless.
    refused: Option<u32>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Stage {
    /// Acknowledged and neither done, failed nor cancelled since.
    Open,
    Done,
    Cancelled,
    Failed,
    /// It failed while the disk was full, so this state may be lost with the process.
    FailedUnsaved,
}

impl ExpectedJob {
    fn concluded(stage: Stage) -> Self {
        Self { stage, finished: BTreeSet::new(), refused: None }
    }

    fn is_open(&self) -> bool {
        self.stage == Stage::Open
    }
}

struct Run<W> {
    world: W,
    seconds: i64,
    /// Leases that may still be current, with the time of their last renewal.
    held: Vec<(LeasedTask, i64)>,
    /// Leases that are certainly not current.
    spent: Vec<LeasedTask>,
    jobs: BTreeMap<JobId, ExpectedJob>,
    /// A task may have failed: a worker said so, or a lease may have expired.
    may_fail: bool,
    /// How often the process ended.
    restarts: u32,
}

pub(super) const LIMITS: Limits = Limits {
    jobs: 2,
    lease_ttl: Duration::from_secs(LEASE_SECONDS.cast_unsigned()),
    max_attempts: NonZeroU32::new(MAX_ATTEMPTS).unwrap(),
    keep_ended: None,
    most_ended: None,
};

impl<W: World> Run<W> {
    fn pass(&mut self, seconds: i64) {
        self.seconds += seconds;
        self.world.pass(Duration::from_secs(seconds.cast_unsigned()));
    }

    fn is_current(&self, leased: &LeasedTask, seen: i64) -> bool {
        self.seconds < seen + LEASE_SECONDS && self.jobs[&leased.job].is_open()
    }

    /// Takes out a held lease. The flag tells whether the queue must accept it.
    fn take(&mut self, index: prop::sample::Index) -> Option<(LeasedTask, bool)> {
        if self.held.is_empty() {
            return None;
        }
        let (leased, seen) = self.held.remove(index.index(self.held.len()));
        let current = self.is_current(&leased, seen);
        self.spent.push(leased.clone());
        Some((leased, current))
    }

    /// Leases of a job that is no longer open are spent, and stay so when it is submitted again.
    fn close(&mut self, id: JobId) {
        let (spent, held) = std::mem::take(&mut self.held).into_iter().partition(|(leased, _)| leased.job == id);
        self.held = held;
        let spent: Vec<(LeasedTask, i64)> = spent;
        self.spent.extend(spent.into_iter().map(|(leased, _)| leased));
    }

    /// Records jobs that the queue has failed, which only too many failed attempts may cause.
    fn notice_failures(&mut self, disk_was_full: bool) {
        let open: Vec<JobId> = self.jobs.iter().filter(|(_, job)| job.is_open()).map(|(id, _)| *id).collect();
        for id in open {
            let job = self.world.queue().job(id).unwrap().unwrap();
            if let JobState::Failed { error } = job.state {
                assert_eq!(error.kind, FailureKind::Attempts);
                assert!(job.attempts >= MAX_ATTEMPTS);
                if error.detail.contains("process ended") {
                    assert!(self.restarts >= MOST_DEATHS, "{error:?} after {} ends of the process", self.restarts);
                } else {
                    assert!(self.may_fail, "{error:?}");
                }
                let expected = self.jobs.get_mut(&id).unwrap();
                expected.stage = if disk_was_full { Stage::FailedUnsaved } else { Stage::Failed };
                self.close(id);
            }
        }
    }

    fn deliver(&mut self, leased: &LeasedTask) -> Result<(), LeaseError> {
        match leased.kind {
            TaskKind::Shard(_) => {
                let answers = self.world.queue().complete(&[(leased.lease, result(leased).as_bytes())])?;
                let [answer] = answers[..] else { panic!("{answers:?}") };
                Ok(answer?)
            }
            TaskKind::Assemble => {
                let results = results(self.world.queue(), &leased.lease)?.expect("no result was damaged");
                let wanted: Vec<_> =
                    (0..SHARDS).map(|n| format!("{}/Shard({n})", leased.recipe).into_bytes()).collect();
                assert_eq!(results, wanted, "every shard's own result, once");
                self.world.queue().finish(&leased.lease, Digest::of(leased.recipe.as_bytes()), Batch::default())
            }
        }
    }

    /// Hands over the result of a shard, and acts until it is on the disk.
    fn deliver_while(&mut self, index: prop::sample::Index, other: &Action) {
        let shards: Vec<_> = self.held.iter().filter(|(leased, _)| leased.kind != TaskKind::Assemble).collect();
        if shards.is_empty() {
            return;
        }
        let at = index.index(shards.len());
        let (leased, seen) = shards[at].clone();
        let was_current = self.is_current(&leased, seen);
        let Some(arrive) = self.world.hand_over(leased.lease, result(&leased)) else {
            self.act(&Action::Deliver(index));
            return self.act(other);
        };
        for (held, seen) in &mut self.held {
            if was_current && held.lease == leased.lease {
                *seen = self.seconds;
            }
        }
        self.act(other);
        self.notice_failures(false);
        let answer = arrive().expect("the disk has room");
        let held = self.held.iter().position(|(held, _)| held.lease == leased.lease);
        let is_current = was_current && held.is_some_and(|at| self.is_current(&leased, self.held[at].1));
        assert_eq!(answer.is_ok(), is_current, "{leased:?}");
        if let Some(at) = held {
            self.held.remove(at);
            self.spent.push(leased.clone());
        }
        if is_current {
            self.delivered(&leased);
        } else if was_current && let TaskKind::Shard(shard) = leased.kind {
            self.jobs.get_mut(&leased.job).unwrap().refused = Some(shard);
        }
    }

    fn delivered(&mut self, leased: &LeasedTask) {
        let job = self.jobs.get_mut(&leased.job).unwrap();
        match leased.kind {
            TaskKind::Shard(shard) => assert!(job.finished.insert(shard), "a shard was finished twice"),
            TaskKind::Assemble => {
                assert_eq!(job.finished.len(), SHARDS as usize, "assembled before all shards were finished");
                *job = ExpectedJob::concluded(Stage::Done);
                self.close(leased.job);
            }
        }
    }

    fn act(&mut self, action: &Action) {
        match action {
            Action::Submit(n) => self.submit(*n),
            Action::Cancel(n) => {
                let id = JobId::of_recipe(&recipe(*n).recipe_digest);
                let known = self.jobs.get(&id).cloned();
                match self.world.queue().cancel(id, None) {
                    Ok(job) => assert_eq!(job.is_some(), known.is_some()),
                    Err(_) => return,
                }
                if known.is_some_and(|job| job.is_open()) {
                    self.jobs.insert(id, ExpectedJob::concluded(Stage::Cancelled));
                    self.close(id);
                }
            }
            Action::Lease(most) => {
                let most = NonZeroUsize::new(*most).unwrap();
                let Offer::Tasks(tasks) = self.world.queue().lease(Demand::Any, most) else { return };
                assert!((1..=most.get()).contains(&tasks.len()));
                for leased in tasks {
                    self.leased(leased);
                }
            }
            Action::Deliver(index) => {
                let Some((leased, current)) = self.take(*index) else { return };
                match self.deliver(&leased) {
                    Ok(()) => {
                        assert!(current, "a stale result was taken");
                        self.delivered(&leased);
                    }
                    Err(LeaseError::Stale(_)) => assert!(!current, "a current result was refused"),
                    // Still leased, and nobody delivers it, so it will expire.
                    Err(LeaseError::Store(_)) => assert!(current),
                }
            }
            Action::DeliverWhile(index, other) => self.deliver_while(*index, other),
            Action::DeliverAgain(index) => {
                if !self.spent.is_empty() {
                    let leased = self.spent[index.index(self.spent.len())].clone();
                    // One whose delivery met a full disk may still be current.
                    if self.deliver(&leased).is_ok() {
                        self.delivered(&leased);
                    }
                }
            }
            Action::Fail(index) => {
                let Some((leased, current)) = self.take(*index) else { return };
                assert_eq!(self.world.queue().fail(&leased.lease, "bad luck").is_ok(), current);
                self.may_fail |= current;
            }
            Action::GiveBack(index) => {
                let Some((leased, current)) = self.take(*index) else { return };
                assert_eq!(self.world.queue().give_back(&leased.lease).is_ok(), current);
            }
            Action::Progress(index) => {
                if self.held.is_empty() {
                    return;
                }
                let at = index.index(self.held.len());
                let (leased, seen) = self.held[at].clone();
                let current = self.is_current(&leased, seen);
                assert_eq!(self.world.queue().progress(&leased.lease, 1).is_ok(), current);
                if current {
                    self.held[at].1 = self.seconds;
                }
            }
            Action::Tick(seconds) => {
                self.pass(*seconds);
                self.may_fail = true;
            }
            Action::PowerCut | Action::Kill => {
                self.restarts += 1;
                if matches!(action, Action::PowerCut) {
                    self.world.lose_power();
                }
                self.world.reopen(LIMITS);
                if !W::LEASES_SURVIVE {
                    self.held.clear();
                    self.spent.clear();
                }
                for (id, expected) in self.jobs.iter_mut().filter(|(_, job)| job.stage == Stage::FailedUnsaved) {
                    let job = self.world.queue().job(*id).unwrap().unwrap();
                    expected.stage = if job.state.name().is_final() { Stage::Failed } else { Stage::Open };
                }
            }
            Action::Faulty(fault, action) => {
                self.world.set_fault(Some(*fault));
                if !matches!(**action, Action::PowerCut | Action::Kill) {
                    self.act(action);
                }
                self.world.set_fault(None);
            }
            Action::Turn => self.world.turn(),
        }
    }

    fn leased(&mut self, leased: LeasedTask) {
        assert!(self.jobs[&leased.job].is_open(), "only open jobs are worked on");
        if let TaskKind::Shard(shard) = leased.kind {
            assert!(!self.jobs[&leased.job].finished.contains(&shard), "a finished shard was leased");
        }
        for (other, seen) in &self.held {
            let same = (other.job, other.kind) == (leased.job, leased.kind);
            assert!(!same || !self.is_current(other, *seen), "leased twice");
        }
        self.held.push((leased, self.seconds));
    }

    fn submit(&mut self, n: u8) {
        let id = JobId::of_recipe(&recipe(n).recipe_digest);
        let open = self.jobs.values().filter(|job| job.is_open()).count();
        let former = self.jobs.get(&id).cloned();
        match self.world.queue().submit(recipe(n), &|_| true) {
            Ok(Submitted::Joined(_)) => assert!(former.is_some_and(|job| job.is_open())),
            Ok(Submitted::Done(..)) => assert!(former.is_some_and(|job| job.stage == Stage::Done)),
            Ok(Submitted::Queued(job)) => {
                assert!(former.as_ref().is_none_or(|job| !matches!(job.stage, Stage::Open | Stage::Done)));
                assert!(open < 2);
                assert_eq!(job.attempts, 0);
                let refused = former.as_ref().and_then(|job| job.refused);
                let mut finished = former.map(|job| job.finished).unwrap_or_default();
                if job.entries_done > 2 * finished.len() as u64 {
                    finished.extend(refused);
                }
                assert_eq!(job.entries_done, 2 * finished.len() as u64, "finished shards are kept");
                self.jobs.insert(id, ExpectedJob { stage: Stage::Open, finished, refused: None });
            }
            Err(QueueError::Full { .. }) => assert_eq!(open, 2),
            Err(QueueError::Store(_)) => {}
        }
    }

    /// Checks that everything acknowledged is still there.
    fn check(&self) {
        for (id, expected) in &self.jobs {
            let job = self.world.queue().job(*id).unwrap().expect("an acknowledged job is there");
            match job.state {
                JobState::Queued | JobState::Running => {
                    assert!(expected.is_open());
                }
                JobState::Done { table } => {
                    assert_eq!(expected.stage, Stage::Done);
                    assert_eq!(table, Digest::of(job.recipe.as_bytes()));
                    assert_eq!(job.entries_done, job.entries_total);
                }
                JobState::Cancelled => assert_eq!(expected.stage, Stage::Cancelled),
                JobState::Failed { .. } => assert!(!matches!(expected.stage, Stage::Done | Stage::Cancelled)),
            }
            if expected.is_open() {
                assert!(job.entries_done >= 2 * expected.finished.len() as u64, "a finished shard was lost");
            }
        }
    }
}

/// Whether the queue answers as the model does, whatever happens.
pub(super) fn agrees<W: World>(world: W, actions: &[Action]) -> TestCaseResult {
    let mut run =
        Run { world, seconds: 0, held: vec![], spent: vec![], jobs: BTreeMap::new(), may_fail: false, restarts: 0 };
    for action in actions {
        run.act(action);
        run.notice_failures(matches!(action, Action::Faulty(..)));
        run.check();
    }
    run.act(&Action::PowerCut);
    run.notice_failures(false);
    run.check();

    // With enough time and room every open job gets done, each shard once.
    run.pass(2 * LEASE_SECONDS);
    run.may_fail = true;
    loop {
        run.notice_failures(false);
        let Offer::Tasks(tasks) = run.world.queue().lease(Demand::Any, NonZeroUsize::MIN) else { break };
        for leased in tasks {
            run.deliver(&leased).unwrap();
            run.delivered(&leased);
        }
    }
    prop_assert!(run.jobs.values().all(|job| !job.is_open()));
    // A failed job keeps its tasks, all others leave nothing.
    let failed = run.jobs.values().filter(|job| matches!(job.stage, Stage::Failed | Stage::FailedUnsaved)).count();
    if failed == 0 {
        run.world.queue().submit(recipe(9), &|_| true).unwrap();
        run.world.reopen(LIMITS);
        prop_assert_eq!(run.world.results(), 0);
    }
    Ok(())
}
