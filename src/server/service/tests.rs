//! The service with a fake engine.

mod fake_engine;

use std::{
    fs,
    num::NonZeroUsize,
    path::Path,
    sync::{Arc, atomic::Ordering},
    time::Duration,
};

use fake_engine::{FakeEngine, Shared};

use super::*;
use crate::files::manifest::MANIFEST_VERSION;
use crate::{
    files::digest::Digest,
    server::{
        queue::{FailureKind, JobId, JobState, StateName},
        store::{Batch, Catalogue, ManifestRow, Rows, Store, Tree, memory::MemoryRows},
    },
};

fn config(dir: &Path) -> Config {
    Config {
        data_dir: dir.to_owned(),
        workers: NonZeroUsize::new(2).unwrap(),
        queue_limit: 2,
        entry_limit: 100,
        job_seconds: 86_400,
        lease_ttl: Duration::from_secs(60),
        adapter: crate::view::preview::Adapter::Cpu,
        max_attempts: 3,
        picture_limit: Duration::from_secs(60),
    }
}

fn start(dir: &Path, shared: &Arc<Shared>) -> Arc<Service> {
    Service::open_with(config(dir), Store::open(dir).unwrap(), Box::new(FakeEngine(Arc::clone(shared)))).unwrap()
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
    match service.submit(recipe.as_bytes()).unwrap() {
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
    assert!(service.is_ready());
    assert!(matches!(service.submit(b"nonsense"), Err(SubmitError::Recipe(_))));
    let table = fitted(&service, "gold 5");
    assert_eq!(service.table(table).unwrap().unwrap().as_slice(), b"TABLE gold 5 0 1 2 3 4");
    assert!(service.table(Digest::of(b"unknown")).unwrap().is_none());
    match service.submit(b"gold 5").unwrap() {
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
    assert!(matches!(service.submit(b"copper 1"), Err(SubmitError::QueueFull { limit: 2, .. })));
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
    assert_eq!(service.cancel(id).unwrap().unwrap().job.state, JobState::Cancelled);
    let runtime = tokio::runtime::Builder::new_current_thread().build().unwrap();
    let notified = runtime.block_on(receiver.wait_for(|snapshot| snapshot.job.state == JobState::Cancelled));
    assert!(notified.is_ok(), "its followers are notified");
    drop(notified);
    shared.set(|b| b.held = false);
    fitted(&service, "silver 1");
    assert_eq!(shared.begun(), 3, "no other shard of the cancelled job was begun");
    fitted(&service, "gold 8");
    assert!(service.cancel(id).unwrap().unwrap().job.finished_at.is_some(), "a finished job stays");
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
fn a_full_disk_fails_the_job_and_room_brings_it_back_with_its_finished_shards() {
    let dir = tempfile::tempdir().unwrap();
    let shared = Arc::new(Shared::default());
    let rows = Arc::new(MemoryRows::default());
    let store = Store::with_rows(dir.path(), rows.clone());
    let service = Service::open_with(config(dir.path()), store, Box::new(FakeEngine(Arc::clone(&shared)))).unwrap();
    let first = fitted(&service, "silver 1");
    shared.set(|b| b.held = true);
    let (id, _) = submit(&service, "gold 4");
    shared.wait_for_begun(3);
    rows.full.store(true, Ordering::Relaxed);
    shared.set(|b| b.held = false);
    match end_of(&service, id) {
        JobState::Failed { error } => assert_eq!(error.kind, FailureKind::DiskFull),
        other => panic!("{other:?}"),
    }
    assert!(matches!(service.submit(b"copper 1"), Err(SubmitError::Store(ServiceError::DiskFull))));
    assert!(service.table(first).unwrap().is_some(), "a stored table is served");
    rows.full.store(false, Ordering::Relaxed);
    fitted(&service, "gold 4");
    assert_eq!(rows.len(Tree::Results) + rows.len(Tree::Shards), 0);
}

#[test]
fn a_damaged_table_is_reported_once_and_fitted_again() {
    let dir = tempfile::tempdir().unwrap();
    let shared = Arc::new(Shared::default());
    let service = start(dir.path(), &shared);
    let table = fitted(&service, "gold 1");
    let hex = table.hex();
    fs::write(dir.path().join("blobs").join(&hex[..2]).join(&hex), "noise").unwrap();
    assert!(matches!(service.table(table), Err(ServiceError::Corrupt { expected, .. }) if expected == table));
    assert!(service.table(table).unwrap().is_none());
    assert!(service.tables(None, 10).unwrap().items.is_empty());
    assert_eq!(service.metrics().unwrap().blobs_corrupt, 1);
    assert_eq!(fitted(&service, "gold 1"), table);
    assert_eq!(shared.begun(), 2);
    assert!(service.table(table).unwrap().is_some());
}

#[test]
fn the_manifest_of_a_damaged_table_is_refused_like_the_table() {
    let dir = tempfile::tempdir().unwrap();
    let shared = Arc::new(Shared::default());
    let service = start(dir.path(), &shared);
    let table = fitted(&service, "gold 1");
    assert!(service.manifest(table).unwrap().is_some());
    let hex = table.hex();
    let blob = dir.path().join("blobs").join(&hex[..2]).join(&hex);
    fs::write(&blob, "noise").unwrap();
    assert!(matches!(service.manifest(table), Err(ServiceError::Corrupt { expected, .. }) if expected == table));
    assert!(!blob.exists(), "it was moved to quarantine");
    assert!(service.manifest(table).unwrap().is_none());
    assert_eq!(service.metrics().unwrap().blobs_corrupt, 1);
    assert_eq!(fitted(&service, "gold 1"), table);
    assert!(service.manifest(table).unwrap().is_some());
    fs::remove_file(&blob).unwrap();
    assert!(service.manifest(table).unwrap().is_none(), "no manifest without its table");
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
    while service.is_ready() {
        std::thread::yield_now();
    }
    shared.set(|b| b.held = false);
    stopper.join().unwrap();
    assert!(matches!(service.submit(b"copper 1"), Err(SubmitError::Stopping)));
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
fn a_lost_database_leaves_the_tables() {
    let dir = tempfile::tempdir().unwrap();
    let shared = Arc::new(Shared::default());
    let service = start(dir.path(), &shared);
    let table = fitted(&service, "gold 2");
    drop(service);
    fs::remove_dir_all(dir.path().join("db")).unwrap();
    let service = start(dir.path(), &shared);
    assert_eq!(service.tables(None, 10).unwrap().items.len(), 1);
    let SubmitReply::Ready { job, table: again } = service.submit(b"gold 2").unwrap() else { panic!("it is there") };
    assert_eq!(again, table);
    assert_eq!(service.job(job.id).unwrap().unwrap().job, job, "the job can be looked up");
    assert_eq!(shared.begun(), 2);
}

/// sled may lose rows when a write error closes it while the service runs.
#[test]
fn a_database_that_is_opened_again_gets_back_the_jobs_and_tables_that_it_lost() {
    let dir = tempfile::tempdir().unwrap();
    let service = start(dir.path(), &Arc::new(Shared::default()));
    let table = fitted(&service, "gold 2");
    let without: Arc<dyn Rows> = Arc::new(MemoryRows::default());
    service.state.tables.store.checks.run(&without).unwrap();
    let id = JobId::of_recipe(&Digest::of(b"gold 2"));
    assert!(without.get(Tree::Jobs, id.as_bytes()).unwrap().is_some());
    assert_eq!(Catalogue::new(without).page(None, 9).unwrap().0[0].digest, table);
}

#[test]
fn a_manifest_is_made_once_with_the_table() {
    let dir = tempfile::tempdir().unwrap();
    let shared = Arc::new(Shared::default());
    let service = start(dir.path(), &shared);
    let table = fitted(&service, "gold 2");
    let made = || shared.behaviour.lock().unwrap().manifests;
    assert_eq!(made(), 1);
    assert_eq!(service.manifest(table).unwrap().unwrap(), "of 16 bytes");
    assert_eq!(made(), 1, "it was stored with the table");
    assert!(service.manifest(Digest::of(b"unknown")).unwrap().is_none());
    drop(service);
    let service = start(dir.path(), &shared);
    assert_eq!(service.manifest(table).unwrap().unwrap(), "of 16 bytes");
    assert_eq!(made(), 1, "it outlives the process");
}

#[test]
fn a_table_from_before_gets_its_manifest_when_it_is_asked_for() {
    let dir = tempfile::tempdir().unwrap();
    let shared = Arc::new(Shared::default());
    let service = start(dir.path(), &shared);
    let table = fitted(&service, "gold 2");
    let rows = &service.state.tables.store.rows;
    let made = || shared.behaviour.lock().unwrap().manifests;
    let mut none = Batch::default();
    none.remove(Tree::Manifests, *table.as_bytes());
    let other = ManifestRow { version: MANIFEST_VERSION + 1, text: "of another version".to_owned() };
    for (made_before, stored) in [(1, none), (2, Catalogue::manifest_entry(table, &other).unwrap())] {
        assert_eq!(made(), made_before);
        rows.commit(&stored).unwrap();
        for _ in 0..2 {
            assert_eq!(service.manifest(table).unwrap().unwrap(), "of 16 bytes");
            assert_eq!(made(), made_before + 1);
        }
    }
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

/// Its shards may take minutes. Nothing of them is lost when a worker turns to the small job in the middle of one.
#[test]
fn a_small_job_is_done_while_a_long_one_has_all_workers() {
    let dir = tempfile::tempdir().unwrap();
    let shared = Arc::new(Shared::default());
    shared.set(|b| b.endless = Some("long 6".to_owned()));
    let service = start(dir.path(), &shared);
    let (long, _) = submit(&service, "long 6");
    shared.wait_for_begun(2);
    fitted(&service, "small 3");
    assert_eq!(service.job(long).unwrap().unwrap().job.state, JobState::Running);
    shared.set(|b| b.endless = None);
    assert!(matches!(end_of(&service, long), JobState::Done { .. }));
    let behaviour = shared.behaviour.lock().unwrap();
    assert!(behaviour.begun.values().all(|begun| *begun == 1), "a shard was begun twice: {:?}", behaviour.begun);
}

#[test]
fn a_job_that_would_take_too_long_is_refused_with_the_prediction() {
    let dir = tempfile::tempdir().unwrap();
    let engine = || Box::new(FakeEngine(Arc::new(Shared::default())));
    let config = |job_seconds| Config { job_seconds, ..config(dir.path()) };
    let service = Service::open_with(config(3), Store::open(dir.path()).unwrap(), engine()).unwrap();
    // Two workers share the eight seconds that the engine expects.
    let refused = service.submit(b"gold 2").unwrap_err();
    assert!(matches!(refused, SubmitError::TooExpensive { predicted: 4.0, limit: 3 }), "{refused}");
    assert!(refused.to_string().contains("4 s") && refused.to_string().contains("--job-seconds"), "{refused}");
    drop(service);
    let service = Service::open_with(config(4), Store::open(dir.path()).unwrap(), engine()).unwrap();
    fitted(&service, "gold 2");
}

/// A lack of descriptors is no fault of the job's.
#[test]
fn a_job_outlasts_a_lack_of_descriptors() {
    let dir = tempfile::tempdir().unwrap();
    let shared = Arc::new(Shared::default());
    let rows = Arc::new(MemoryRows::default());
    let store = Store::with_rows(dir.path(), rows.clone());
    let service = Service::open_with(config(dir.path()), store, Box::new(FakeEngine(Arc::clone(&shared)))).unwrap();
    shared.set(|b| b.held = true);
    let (id, _) = submit(&service, "gold 4");
    shared.wait_for_begun(2);
    rows.without_descriptors.store(true, Ordering::Relaxed);
    shared.set(|b| b.held = false);
    while rows.refused.load(Ordering::Relaxed) < 2 {
        std::thread::yield_now();
    }
    rows.without_descriptors.store(false, Ordering::Relaxed);
    assert!(matches!(end_of(&service, id), JobState::Done { .. }));
    assert_eq!(service.metrics().unwrap().shard_failures, 0);
    assert!(shared.behaviour.lock().unwrap().begun.values().all(|begun| *begun == 1), "a fitted shard was thrown away");
}
