//! The service when its storage fails, loses something or is full.

use std::{
    fs,
    sync::{
        Arc,
        atomic::{AtomicU64, AtomicUsize, Ordering},
    },
    thread,
    time::Duration,
};

use super::{
    config, end_of,
    fake_backend::{FakeBackend, Shared},
    fitted, start, submit, *,
};
use crate::{
    queue::{
        JobId, JobState, Queue,
        embedded::{Clock, EmbeddedQueue},
        postgres::{PostgresQueue, Process},
    },
    service::open::{ServiceParts, limits},
    store::{
        Batch, BlobInfo, Blobs, Catalogue, Database, ManifestRow, PostgresRows, Rows, Store, StoreError, Tree,
        memory::{Meanwhile, MemoryRows},
        throwaway,
    },
};
use ltcforge_files::{digest::Digest, manifest::MANIFEST_VERSION};

#[test]
fn a_job_waits_for_room_on_a_full_disk_and_keeps_its_shards() {
    let dir = tempfile::tempdir().unwrap();
    let shared = Arc::new(Shared::default());
    let rows = Arc::new(MemoryRows::default());
    let store = Store::with_rows(dir.path(), rows.clone());
    let service = Service::open_with(config(dir.path()), store, Arc::new(FakeBackend(Arc::clone(&shared)))).unwrap();
    let first = fitted(&service, "silver 1");
    shared.set(|b| b.held = true);
    let (id, _) = submit(&service, "gold 4");
    shared.wait_for_begun(3);
    rows.full.store(true, Ordering::Relaxed);
    shared.set(|b| b.held = false);
    while rows.refused.load(Ordering::Relaxed) < 3 {
        thread::yield_now();
    }
    assert!(service.fault().is_some_and(|fault| fault.contains("full")));
    assert_eq!(service.job(id).unwrap().unwrap().job.state, JobState::Running);
    assert!(matches!(service.submit(b"copper 1", None), Err(SubmitError::Store(ServiceError::DiskFull))));
    assert!(service.table(first).unwrap().is_some(), "a stored table is served");
    rows.full.store(false, Ordering::Relaxed);
    assert_eq!(service.fault(), None);
    assert!(matches!(end_of(&service, id), JobState::Done { .. }));
    assert_eq!(shared.begun(), 5, "no shard was fitted twice");
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
fn a_table_that_is_removed_or_renamed_while_the_service_runs_is_told_once() {
    let dir = tempfile::tempdir().unwrap();
    let service = start(dir.path(), &Arc::new(Shared::default()));
    let table = fitted(&service, "gold 1");
    let hex = table.hex();
    let blob = dir.path().join("blobs").join(&hex[..2]).join(&hex);
    let told = || service.metrics().unwrap().blobs_corrupt;
    assert!(service.table(Digest::of(b"unknown")).unwrap().is_none());
    assert_eq!(told(), 0);
    fs::rename(&blob, blob.with_file_name("renamed")).unwrap();
    for _ in 0..2 {
        assert!(service.table(table).unwrap().is_none());
        assert_eq!(told(), 1);
    }
    assert_eq!(fitted(&service, "gold 1"), table);
    assert!(service.table(table).unwrap().is_some());
    fs::remove_file(&blob).unwrap();
    // A submission asks for it too.
    assert_eq!(fitted(&service, "gold 1"), table);
    assert_eq!(told(), 2);
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
fn a_lost_database_leaves_the_tables() {
    let dir = tempfile::tempdir().unwrap();
    let shared = Arc::new(Shared::default());
    let service = start(dir.path(), &shared);
    let table = fitted(&service, "gold 2");
    drop(service);
    fs::remove_dir_all(dir.path().join("db")).unwrap();
    let service = start(dir.path(), &shared);
    assert_eq!(service.tables(None, 10).unwrap().items.len(), 1);
    let SubmitReply::Ready { job, table: again } = service.submit(b"gold 2", None).unwrap() else {
        panic!("it is there")
    };
    assert_eq!(again, table);
    assert_eq!(service.job(job.id).unwrap().unwrap().job, job, "the job can be looked up");
    assert_eq!(shared.begun(), 2);
}

/// sled may lose rows when a write error closes it while the service runs.
#[test]
fn a_database_that_is_opened_again_gets_back_the_tables_that_it_lost() {
    let dir = tempfile::tempdir().unwrap();
    let service = start(dir.path(), &Arc::new(Shared::default()));
    let table = fitted(&service, "gold 2");
    let without: Arc<dyn Rows> = Arc::new(MemoryRows::default());
    service.state.tables.store.reopen_check.get().unwrap()(&without).unwrap();
    assert_eq!(Catalogue::new(without).page(None, 9).unwrap().0[0].digest, table);
}

/// The disk takes longer than a lease lasts.
#[test]
fn a_lease_is_kept_while_its_result_is_being_stored() {
    let dir = tempfile::tempdir().unwrap();
    let shared = Arc::new(Shared::default());
    let rows = Arc::new(MemoryRows::default());
    let lease_ttl = Duration::from_secs(1);
    *rows.while_settling.lock().unwrap() = Some(Meanwhile(Box::new(move || thread::sleep(lease_ttl * 5 / 2))));
    let store = Store::with_rows(dir.path(), rows.clone());
    let config = Config { lease_ttl, ..config(dir.path()) };
    let service = Service::open_with(config, store, Arc::new(FakeBackend(Arc::clone(&shared)))).unwrap();
    fitted(&service, "gold 4");
    assert!(rows.while_settling.lock().unwrap().is_none());
    let metrics = service.metrics().unwrap();
    assert_eq!((metrics.leases_expired, metrics.shard_failures, shared.begun()), (0, 0, 4));
}

/// Blobs behind a slow link: storing and reading one takes longer than a lease lasts.
#[derive(Debug)]
struct SlowBlobs {
    blobs: Arc<dyn Blobs>,
    time: Duration,
    puts: AtomicUsize,
}

impl Blobs for SlowBlobs {
    fn delete(&self, digest: Digest) -> Result<(), StoreError> {
        self.blobs.delete(digest)
    }

    fn put(&self, bytes: &[u8]) -> Result<Digest, StoreError> {
        thread::sleep(self.time);
        self.puts.fetch_add(1, Ordering::Relaxed);
        self.blobs.put(bytes)
    }

    fn get(&self, digest: Digest) -> Result<Option<Vec<u8>>, StoreError> {
        self.blobs.get(digest)
    }

    fn contains(&self, digest: Digest) -> Result<bool, StoreError> {
        self.blobs.contains(digest)
    }

    fn list(&self) -> Result<Vec<BlobInfo>, StoreError> {
        self.blobs.list()
    }
}

/// Fits a table whose way to the store, and whose plan's from there, take longer than a lease; in the queue that
/// `queue` makes.
fn a_slow_store_is_only_slow(queue: impl FnOnce(&Config) -> Option<(Box<dyn Queue>, Arc<dyn Rows>)>) {
    let dir = tempfile::tempdir().unwrap();
    let lease_ttl = Duration::from_secs(1);
    let config = Config { lease_ttl, ..config(dir.path()) };
    let Some((queue, rows)) = queue(&config) else { return };
    let folder = Store::open(dir.path()).unwrap();
    let slow =
        Arc::new(SlowBlobs { blobs: Arc::clone(&folder.blobs), time: lease_ttl * 5 / 2, puts: AtomicUsize::new(0) });
    let shared = Arc::new(Shared::default());
    shared.set(|b| b.loading = lease_ttl * 5 / 2);
    let backend = Arc::new(FakeBackend(Arc::clone(&shared)));
    let store = Store::shared(Arc::clone(&slow) as _, rows);
    let service = Service::start(config, ServiceParts { queue, store, backend, works: true }).unwrap();
    fitted(&service, "gold 1");
    let metrics = service.metrics().unwrap();
    assert_eq!((metrics.leases_expired, metrics.shard_failures), (0, 0));
    assert_eq!((shared.begun(), slow.puts.load(Ordering::Relaxed)), (1, 1), "it was made once and stored once");
}

#[test]
fn a_lease_is_kept_while_the_store_is_slow() {
    a_slow_store_is_only_slow(|config| {
        let rows: Arc<dyn Rows> = Arc::new(MemoryRows::default());
        let queue = EmbeddedQueue::open(Arc::clone(&rows), limits(config), Clock::system()).unwrap();
        Some((Box::new(queue), rows))
    });
}

#[test]
fn a_lease_of_a_shared_queue_is_kept_while_the_store_is_slow() {
    a_slow_store_is_only_slow(|config| {
        let database = Database::open(&throwaway::empty_database()?).unwrap();
        let process = Process { name: "test".to_owned(), fitter: 1 };
        let queue = PostgresQueue::open(Arc::clone(&database), limits(config), process).unwrap();
        Some((Box::new(queue), Arc::new(PostgresRows::new(database))))
    });
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

/// A table from before has no manifest yet, and a damaged one is to leave the catalogue.
#[test]
fn a_full_disk_hides_no_manifest_and_no_damage() {
    let dir = tempfile::tempdir().unwrap();
    let rows = Arc::new(MemoryRows::default());
    let store = Store::with_rows(dir.path(), rows.clone());
    let service = Service::open_with(config(dir.path()), store, Arc::new(FakeBackend(Arc::default()))).unwrap();
    let table = fitted(&service, "gold 2");
    let mut none = Batch::default();
    none.remove(Tree::Manifests, *table.as_bytes());
    rows.commit(&none).unwrap();
    rows.full.store(true, Ordering::Relaxed);
    assert_eq!(service.manifest(table).unwrap().unwrap(), "of 16 bytes");
    let hex = table.hex();
    fs::write(dir.path().join("blobs").join(&hex[..2]).join(&hex), "noise").unwrap();
    assert!(matches!(service.table(table), Err(ServiceError::Corrupt { .. })));
    assert!(service.table(table).unwrap().is_none());
}

/// A store from which another process removes each blob once, before the row that makes it known.
#[derive(Debug)]
struct Swept {
    blobs: Arc<dyn Blobs>,
    kept: AtomicU64,
}

impl Blobs for Swept {
    fn delete(&self, digest: Digest) -> Result<(), StoreError> {
        self.blobs.delete(digest)
    }

    fn put(&self, bytes: &[u8]) -> Result<Digest, StoreError> {
        Ok(Digest::of(bytes))
    }

    fn get(&self, digest: Digest) -> Result<Option<Vec<u8>>, StoreError> {
        self.blobs.get(digest)
    }

    fn contains(&self, digest: Digest) -> Result<bool, StoreError> {
        self.blobs.contains(digest)
    }

    fn list(&self) -> Result<Vec<BlobInfo>, StoreError> {
        self.blobs.list()
    }

    fn keep(&self, digest: Digest, bytes: &[u8]) -> Result<(), StoreError> {
        self.kept.fetch_add(1, Ordering::Relaxed);
        assert_eq!(self.blobs.put(bytes)?, digest);
        Ok(())
    }
}

#[test]
fn a_table_that_is_swept_before_it_becomes_known_is_stored_again() {
    let dir = tempfile::tempdir().unwrap();
    let mut store = Store::open(dir.path()).unwrap();
    let blobs = Arc::new(Swept { blobs: Arc::clone(&store.blobs), kept: AtomicU64::new(0) });
    store.blobs = Arc::clone(&blobs) as Arc<dyn Blobs>;
    let service = Service::open_with(config(dir.path()), store, Arc::new(FakeBackend(Arc::default()))).unwrap();
    let table = fitted(&service, "gold 1");
    service.stop();
    assert_eq!(blobs.kept.load(Ordering::Relaxed), 2, "before its row is written and after");
    assert!(blobs.get(table).unwrap().is_some());
}

/// A lack of descriptors is no fault of the job's.
#[test]
fn a_job_outlasts_a_lack_of_descriptors() {
    let dir = tempfile::tempdir().unwrap();
    let shared = Arc::new(Shared::default());
    let rows = Arc::new(MemoryRows::default());
    let store = Store::with_rows(dir.path(), rows.clone());
    let service = Service::open_with(config(dir.path()), store, Arc::new(FakeBackend(Arc::clone(&shared)))).unwrap();
    shared.set(|b| b.held = true);
    let (id, _) = submit(&service, "gold 4");
    shared.wait_for_begun(2);
    rows.without_descriptors.store(true, Ordering::Relaxed);
    shared.set(|b| b.held = false);
    while rows.refused.load(Ordering::Relaxed) < 2 {
        thread::yield_now();
    }
    rows.without_descriptors.store(false, Ordering::Relaxed);
    assert!(matches!(end_of(&service, id), JobState::Done { .. }));
    assert_eq!(service.metrics().unwrap().shard_failures, 0);
    assert!(shared.behaviour.lock().unwrap().begun.values().all(|begun| *begun == 1), "a fitted shard was thrown away");
}

#[test]
fn a_lack_of_descriptors_costs_an_assembly_no_attempt() {
    let dir = tempfile::tempdir().unwrap();
    let shared = Arc::new(Shared::default());
    let rows = Arc::new(MemoryRows::default());
    let store = Store::with_rows(dir.path(), rows.clone());
    let service = Service::open_with(config(dir.path()), store, Arc::new(FakeBackend(Arc::clone(&shared)))).unwrap();
    shared.set(|b| b.endless_measure = Some("gold 1".to_owned()));
    let (id, _) = submit(&service, "gold 1");
    shared.wait_for_manifests(1);
    rows.without_descriptors.store(true, Ordering::Relaxed);
    shared.set(|b| b.endless_measure = None);
    while rows.refused.load(Ordering::Relaxed) < 1 {
        thread::yield_now();
    }
    rows.without_descriptors.store(false, Ordering::Relaxed);
    assert!(matches!(end_of(&service, id), JobState::Done { .. }));
    assert_eq!(service.metrics().unwrap().shard_failures, 0);
}

/// Its recipe can be submitted again: the table answers.
#[test]
fn a_job_that_is_forgotten_leaves_its_table() {
    let dir = tempfile::tempdir().unwrap();
    let shared = Arc::new(Shared::default());
    let table = fitted(&start(dir.path(), &shared), "gold 2");
    let config = Config { keep_ended: Some(Duration::ZERO), ..config(dir.path()) };
    let backend = Arc::new(FakeBackend(Arc::clone(&shared)));
    let service = Service::open_with(config, Store::open(dir.path()).unwrap(), backend).unwrap();
    assert!(service.job(JobId::of_recipe(&Digest::of(b"gold 2"))).unwrap().is_none());
    assert!(service.table(table).unwrap().is_some());
    let SubmitReply::Ready { table: again, .. } = service.submit(b"gold 2", None).unwrap() else {
        panic!("it is there")
    };
    assert_eq!((again, shared.begun()), (table, 2));
}
