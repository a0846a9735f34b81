//! The service with a fake backend.

mod exports;
mod fake_backend;
mod reconciled;
mod retention;
mod scrub;
mod storage;

use std::{num::NonZeroUsize, path::Path, sync::Arc, time::Duration};

use fake_backend::{FakeBackend, Shared};

use super::*;
use crate::{
    queue::{FailureKind, JobId, JobState, StateName},
    store::Store,
};
use ltcforge_files::digest::Digest;

pub(super) fn config(dir: &Path) -> Config {
    Config {
        data_dir: dir.to_owned(),
        workers: NonZeroUsize::new(2).unwrap(),
        queue_limit: 2,
        entry_limit: 100,
        job_seconds: 86_400,
        keep_ended: None,
        most_ended: None,
        store_bytes: None,
        unused_for: Duration::ZERO,
        lease_ttl: Duration::from_secs(60),
        adapter: ltcforge_view::preview::Adapter::Cpu,
        max_attempts: 3,
        pictures: PictureLimits::default(),
        brdf_limit: 2,
        light_texture_limit: 2,
        export_bytes: 100,
    }
}

fn start(dir: &Path, shared: &Arc<Shared>) -> Arc<Service> {
    Service::open_with(config(dir), Store::open(dir).unwrap(), Arc::new(FakeBackend(Arc::clone(shared)))).unwrap()
}

/// Follows a job to its end and checks that its snapshots come in order.
fn end_of(service: &Service, id: JobId) -> JobState {
    let mut receiver = service.watch(id).unwrap().unwrap();
    let runtime = tokio::runtime::Builder::new_current_thread().build().unwrap();
    runtime.block_on(async {
        let mut last = 0;
        loop {
            let snapshot = receiver.borrow_and_update().clone();
            assert!(snapshot.sequence > last, "{last} then {snapshot:?}");
            last = snapshot.sequence;
            if snapshot.job.state.name().is_final() {
                return snapshot.job.state;
            }
            receiver.changed().await.expect("the last snapshot has the final state");
        }
    })
}

fn submit(service: &Service, recipe: &str) -> (JobId, bool) {
    match service.submit(recipe.as_bytes(), None).unwrap() {
        SubmitReply::InFlight { job, joined } => (job.id, joined),
        SubmitReply::Ready { .. } => panic!("{recipe} is not to be ready yet"),
    }
}

fn fitted(service: &Service, recipe: &str) -> Digest {
    let (id, _) = submit(service, recipe);
    match end_of(service, id) {
        JobState::Done { table } => table,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_recipe_becomes_a_table_once() {
    let dir = tempfile::tempdir().unwrap();
    let shared = Arc::new(Shared::default());
    let service = start(dir.path(), &shared);
    assert_eq!(service.fault(), None);
    assert!(matches!(service.submit(b"nonsense", None), Err(SubmitError::Recipe(_))));
    let table = fitted(&service, "gold 5");
    assert_eq!(service.table(table).unwrap().unwrap().as_slice(), b"TABLE gold 5 0 1 2 3 4");
    assert!(service.table(Digest::of(b"unknown")).unwrap().is_none());
    match service.submit(b"gold 5", None).unwrap() {
        SubmitReply::Ready { job, table: again } => {
            assert_eq!((again, job.entries_done, job.entries_total), (table, 20, 20));
            assert!(job.started_at.is_some() && job.finished_at.is_some());
        }
        SubmitReply::InFlight { .. } => panic!("it is there"),
    }
    assert_eq!(shared.begun(), 5);
    let digest = Digest::of(b"gold 5");
    assert_eq!(service.recipe(digest).unwrap(), Some(("gold 5".to_owned(), Some(table))));
    let metrics = service.metrics().unwrap();
    assert_eq!((metrics.entries_fitted, metrics.tables, metrics.table_bytes), (20, 1, 22));
    assert!(metrics.jobs.contains(&(StateName::Done, 1)));
    assert_eq!(service.tables(None, 10).unwrap().items[0].digest, table);
}

#[test]
fn equal_recipes_share_a_job_and_the_queue_has_a_limit() {
    let dir = tempfile::tempdir().unwrap();
    let shared = Arc::new(Shared::default());
    shared.set(|b| b.held = true);
    let service = start(dir.path(), &shared);
    let (id, joined) = submit(&service, "gold 3");
    assert!(!joined);
    assert_eq!(submit(&service, "gold 3"), (id, true));
    submit(&service, "silver 1");
    assert!(matches!(service.submit(b"copper 1", None), Err(SubmitError::QueueFull { limit: 2, .. })));
    shared.wait_for_begun(2);
    let running = service.job(id).unwrap().unwrap().job;
    assert_eq!(running.state, JobState::Running);
    let expected = service.job(id).unwrap().unwrap().expected.unwrap();
    // Eight seconds of one thread, on two.
    assert_eq!((expected.seconds, expected.error), (4.0, 0.25));
    shared.set(|b| b.held = false);
    assert!(matches!(end_of(&service, id), JobState::Done { .. }));
    let learnt = service.job(id).unwrap().unwrap().expected.unwrap();
    assert_ne!(learnt.seconds, expected.seconds);
    assert_eq!(shared.behaviour.lock().unwrap().begun[&("gold 3".to_owned(), 0)], 1);
    fitted(&service, "copper 1");
    let newest = service.jobs(None, None, 2).unwrap();
    let names: Vec<_> = newest.items.iter().map(|snapshot| snapshot.job.recipe.as_str()).collect();
    assert_eq!(names, ["copper 1", "silver 1"]);
    let rest = service.jobs(None, newest.next.map(|next| next.parse().unwrap()), 2).unwrap();
    assert_eq!((rest.items[0].job.recipe.as_str(), rest.next), ("gold 3", None));
}

#[test]
fn a_cancelled_job_stops_and_can_be_submitted_again() {
    let dir = tempfile::tempdir().unwrap();
    let shared = Arc::new(Shared::default());
    shared.set(|b| b.held = true);
    let service = start(dir.path(), &shared);
    let (id, _) = submit(&service, "gold 8");
    shared.wait_for_begun(2);
    let mut receiver = service.watch(id).unwrap().unwrap();
    assert_eq!(service.cancel(id, None).unwrap().unwrap().job.state, JobState::Cancelled);
    let runtime = tokio::runtime::Builder::new_current_thread().build().unwrap();
    let notified = runtime.block_on(receiver.wait_for(|snapshot| snapshot.job.state == JobState::Cancelled));
    assert!(notified.is_ok(), "its followers are notified");
    drop(notified);
    shared.set(|b| b.held = false);
    fitted(&service, "silver 1");
    assert_eq!(shared.begun(), 3, "no other shard of the cancelled job was begun");
    fitted(&service, "gold 8");
    assert!(service.cancel(id, None).unwrap().unwrap().job.finished_at.is_some(), "a finished job stays");
    assert!(matches!(service.job(id).unwrap().unwrap().job.state, JobState::Done { .. }));
}

#[test]
fn a_panic_is_a_failed_attempt_and_too_many_fail_the_job_alone() {
    let dir = tempfile::tempdir().unwrap();
    let shared = Arc::new(Shared::default());
    shared.set(|b| b.panics = 2);
    let service = start(dir.path(), &shared);
    fitted(&service, "gold 2");
    assert_eq!(service.metrics().unwrap().shard_failures, 4);
    shared.set(|b| b.panics = u32::MAX);
    let (id, _) = submit(&service, "silver 2");
    match end_of(&service, id) {
        JobState::Failed { error } => {
            assert_eq!(error.kind, FailureKind::Attempts);
            assert!(error.detail.contains("the lobe fell over"), "{error:?}");
        }
        other => panic!("{other:?}"),
    }
    shared.set(|b| b.panics = 0);
    fitted(&service, "silver 2");
}

#[test]
fn stopping_gives_back_and_the_next_start_goes_on_where_it_was() {
    let dir = tempfile::tempdir().unwrap();
    let shared = Arc::new(Shared::default());
    let service = start(dir.path(), &shared);
    fitted(&service, "gold 8");
    shared.set(|b| b.held = true);
    let (id, _) = submit(&service, "silver 6");
    shared.wait_for_begun(10);
    let stopper = {
        let service = Arc::clone(&service);
        std::thread::spawn(move || service.stop())
    };
    while service.fault().is_none() {
        std::thread::yield_now();
    }
    shared.set(|b| b.held = false);
    stopper.join().unwrap();
    assert!(matches!(service.submit(b"copper 1", None), Err(SubmitError::Stopping)));
    let job = service.job(id).unwrap().unwrap().job;
    assert_eq!((job.state, job.entries_done), (JobState::Running, 0));
    assert_eq!(service.metrics().unwrap().shard_failures, 0, "giving back is no failure");
    drop(service);

    let service = start(dir.path(), &shared);
    assert!(matches!(end_of(&service, id), JobState::Done { .. }));
    let behaviour = shared.behaviour.lock().unwrap();
    let begun: u32 = behaviour.begun.iter().filter(|((recipe, _), _)| recipe == "silver 6").map(|(_, n)| n).sum();
    assert_eq!(begun, 8, "two were given back");
    drop(behaviour);
    assert_eq!(service.metrics().unwrap().shard_failures, 0, "giving back is no failure");
}

#[test]
fn followers_of_finished_jobs_cost_nothing() {
    let dir = tempfile::tempdir().unwrap();
    let shared = Arc::new(Shared::default());
    let service = start(dir.path(), &shared);
    let (id, _) = submit(&service, "gold 2");
    end_of(&service, id);
    assert!(!service.state.hub.is_watched(id));
    let receiver = service.watch(id).unwrap().unwrap();
    assert!(matches!(receiver.borrow().job.state, JobState::Done { .. }));
    assert!(!service.state.hub.is_watched(id));
    assert!(service.watch(JobId::of_recipe(&Digest::of(b"unknown"))).unwrap().is_none());
}

/// A service with one worker.
fn start_one(dir: &Path, shared: &Arc<Shared>) -> Arc<Service> {
    let config = Config { workers: NonZeroUsize::MIN, queue_limit: 64, ..config(dir) };
    Service::open_with(config, Store::open(dir).unwrap(), Arc::new(FakeBackend(Arc::clone(shared)))).unwrap()
}

/// Its shards may take minutes. Nothing of them is lost when the small job is fitted in the middle of one.
#[test]
fn a_small_job_is_done_while_a_long_one_has_all_workers() {
    let dir = tempfile::tempdir().unwrap();
    let shared = Arc::new(Shared::default());
    shared.set(|b| b.endless = Some("long 6".to_owned()));
    let service = start(dir.path(), &shared);
    let (long, _) = submit(&service, "long 6");
    shared.wait_for_begun(2);
    fitted(&service, "small 3");
    // No shard of the long job came to its end before.
    assert_eq!(shared.behaviour.lock().unwrap().gave_up, 0);
    assert_eq!(service.job(long).unwrap().unwrap().job.state, JobState::Running);
    shared.set(|b| b.endless = None);
    assert!(matches!(end_of(&service, long), JobState::Done { .. }));
    let behaviour = shared.behaviour.lock().unwrap();
    assert_eq!(behaviour.order[2], "small 3", "{:?}", behaviour.order);
    assert!(behaviour.begun.values().all(|begun| *begun == 1), "a shard was begun twice: {:?}", behaviour.begun);
}

/// The shards of both are leased together, since those before were short; then the long one's keeps the only worker.
#[test]
fn a_small_job_leased_behind_a_long_shard_is_done() {
    let dir = tempfile::tempdir().unwrap();
    let shared = Arc::new(Shared::default());
    let service = start_one(dir.path(), &shared);
    fitted(&service, "quick 9");
    shared.set(|b| b.held = true);
    submit(&service, "first 1");
    shared.wait_for_begun(10);
    shared.set(|b| b.endless = Some("long".to_owned()));
    let (long, _) = submit(&service, "long 4");
    let (small, _) = submit(&service, "small 9");
    shared.set(|b| b.held = false);
    assert!(matches!(end_of(&service, small), JobState::Done { .. }));
    let behaviour = || shared.behaviour.lock().unwrap();
    let begun = behaviour().order.iter().filter(|begun| *begun == "long 4").count();
    assert_eq!((begun, behaviour().gave_up), (1, 0), "{:?}", behaviour().order);
    assert_eq!(service.cancel(long, None).unwrap().unwrap().job.state, JobState::Cancelled);
    fitted(&service, "other 3");
    shared.set(|b| b.endless = None);
    fitted(&service, "long 4");
    assert_eq!(service.metrics().unwrap().shard_failures, 0, "giving back is no failure");
}

#[test]
fn shards_are_fitted_while_a_table_is_measured() {
    let dir = tempfile::tempdir().unwrap();
    let shared = Arc::new(Shared::default());
    shared.set(|b| b.endless_measure = Some("large 1".to_owned()));
    let service = start_one(dir.path(), &shared);
    let (large, _) = submit(&service, "large 1");
    shared.wait_for_manifests(1);
    let (small, _) = submit(&service, "small 3");
    shared.wait_for_begun(4);
    assert_eq!(service.job(large).unwrap().unwrap().job.state, JobState::Running);
    shared.set(|b| b.endless_measure = None);
    for id in [large, small] {
        assert!(matches!(end_of(&service, id), JobState::Done { .. }));
    }
}

/// However many long shards are being fitted, a small job is begun, goes on and ends; and all stop at once.
#[test]
fn a_small_job_is_done_beside_many_long_ones() {
    let dir = tempfile::tempdir().unwrap();
    let shared = Arc::new(Shared::default());
    let names: Vec<String> = (0..40).map(|i| format!("long{i} 2")).collect();
    shared.set(|b| b.endless = Some("long".to_owned()));
    let service = start_one(dir.path(), &shared);
    let long: Vec<JobId> = names.iter().map(|name| submit(&service, name).0).collect();
    shared.wait_for_begun(40);
    fitted(&service, "small 3");
    assert_eq!(shared.behaviour.lock().unwrap().gave_up, 0);
    assert_eq!(shared.behaviour.lock().unwrap().order[40], "small 3");
    for id in &long {
        assert_eq!(service.job(*id).unwrap().unwrap().job.state, JobState::Running);
    }
    service.stop();
    let behaviour = shared.behaviour.lock().unwrap();
    assert!(behaviour.begun.values().all(|begun| *begun == 1), "a shard was begun twice: {:?}", behaviour.begun);
}

#[test]
fn a_job_that_would_take_too_long_is_refused_with_the_prediction() {
    let dir = tempfile::tempdir().unwrap();
    let backend = || Arc::new(FakeBackend(Arc::new(Shared::default())));
    let config = |job_seconds| Config { job_seconds, ..config(dir.path()) };
    let service = Service::open_with(config(3), Store::open(dir.path()).unwrap(), backend()).unwrap();
    // Two workers share the eight seconds that the backend expects.
    let refused = service.submit(b"gold 2", None).unwrap_err();
    assert!(matches!(refused, SubmitError::TooExpensive { predicted: 4.0, limit: 3 }), "{refused}");
    assert!(refused.to_string().contains("4 s") && refused.to_string().contains("--job-seconds"), "{refused}");
    drop(service);
    let service = Service::open_with(config(4), Store::open(dir.path()).unwrap(), backend()).unwrap();
    fitted(&service, "gold 2");
}
