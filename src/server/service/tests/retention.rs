//! Pins, removals and the size of the store, in a data folder and in a store that processes share.

use std::{
    fs::File,
    path::{Path, PathBuf},
    sync::Arc,
    time::{Duration, SystemTime},
};

use jiff::Timestamp;

use super::{
    super::{
        RemovalReason,
        open::{ServiceParts, limits},
    },
    config,
    fake_backend::{FakeBackend, Shared},
    fitted,
};
use crate::{
    queue::postgres::{PostgresQueue, Process},
    service::{Config, DeleteTableError, Kept, KeptReason, PinError, PinName, Service},
    store::{Access, Database, ObjectBlobs, PostgresRows, Store, StoreOpenError, Tree, throwaway},
};
use ltcforge_files::{digest::Digest, tabulated::encode};
use ltcforge_fit::{BrdfKind, TabulatedAxes, TabulatedBrdf};

/// Where a service keeps its data.
enum Place {
    Folder,
    /// The URL of the database.
    Cluster(String),
}

impl Place {
    /// Both, as far as they are here.
    fn all() -> Vec<Self> {
        std::iter::once(Self::Folder).chain(throwaway::empty_database().map(Self::Cluster)).collect()
    }

    fn blobs(&self, dir: &Path) -> PathBuf {
        dir.join(if matches!(self, Self::Folder) { "blobs" } else { "store" })
    }

    fn store(&self, dir: &Path) -> Store {
        match self {
            // A process that another test starts has the lock's file too until it runs its own program.
            Self::Folder => loop {
                match Store::open(dir) {
                    Err(StoreOpenError::Locked) => std::thread::yield_now(),
                    opened => break opened.unwrap(),
                }
            },
            Self::Cluster(url) => {
                std::fs::create_dir_all(dir.join("store")).unwrap();
                let at = format!("file://{}", dir.join("store").display());
                let blobs = ObjectBlobs::open(&at, Access::Write, &dir.join("cache"), 1 << 20).unwrap();
                Store::shared(Arc::new(blobs), Arc::new(PostgresRows::new(Database::open(url).unwrap())))
            }
        }
    }

    /// Stops a service and starts the next on its data.
    fn restart(&self, service: Arc<Service>, config: Config) -> Arc<Service> {
        service.stop();
        drop(service);
        self.start(config)
    }

    fn start(&self, config: Config) -> Arc<Service> {
        let backend = Arc::new(FakeBackend(Arc::new(Shared::default())));
        let store = self.store(&config.data_dir);
        match self {
            Self::Folder => Service::open_with(config, store, backend).unwrap(),
            Self::Cluster(url) => {
                let process = Process { name: format!("test/{:?}", std::time::Instant::now()), fitter: 1 };
                let queue = PostgresQueue::open(Database::open(url).unwrap(), limits(&config), process).unwrap();
                Service::start(config, ServiceParts { queue: Box::new(queue), store, backend, works: true }).unwrap()
            }
        }
    }
}

/// The file of a stored blob.
fn file(blobs: &Path, digest: Digest) -> PathBuf {
    let hex = digest.hex();
    blobs.join(&hex[..2]).join(hex)
}

/// As if a file had been stored, and used, so many seconds ago.
fn age(service: &Service, file: &Path, digest: Digest, seconds: u64) {
    let then = SystemTime::now() - Duration::from_secs(seconds);
    File::options().write(true).open(file).unwrap().set_modified(then).unwrap();
    let row = super::super::uses::UseRow { used_at: Timestamp::try_from(then).unwrap(), removed: None };
    let mut batch = crate::store::Batch::default();
    row.put(&mut batch, digest).unwrap();
    service.state.tables.store.rows.commit(&batch).unwrap();
}

fn name(text: &str) -> PinName {
    text.parse().unwrap()
}

fn why(service: &Service, table: Digest) -> Option<RemovalReason> {
    service.removed_table(table).unwrap().map(|removed| removed.why)
}

#[test]
fn what_was_used_longest_ago_goes_first_and_what_is_pinned_stays() {
    for place in Place::all() {
        let dir = tempfile::tempdir().unwrap();
        let blobs = place.blobs(dir.path());
        let config = Config { queue_limit: 9, unused_for: Duration::from_secs(600), ..config(dir.path()) };
        let service = place.start(config.clone());
        let tables = ["gold 1", "silver 1", "copper 1", "lead 1"].map(|recipe| fitted(&service, recipe));
        let bytes: u64 = tables.iter().map(|table| file(&blobs, *table).metadata().unwrap().len()).sum();
        service.state.write_uses().unwrap();
        let [oldest, pinned, asked, new] = tables;
        age(&service, &file(&blobs, pinned), pinned, 9000);
        age(&service, &file(&blobs, oldest), oldest, 8000);
        age(&service, &file(&blobs, asked), asked, 7000);
        service.pin(pinned, &name("film"), Some("farm")).unwrap();
        assert!(service.table(asked).unwrap().is_some());
        service.state.write_uses().unwrap();
        let later = service.state.queue.now().checked_add(jiff::SignedDuration::from_hours(1)).unwrap();
        let plan = service.state.tables.plan(service.state.queue.as_ref(), Some(1), later, vec![]).unwrap();
        assert_eq!(plan.going.iter().map(|going| going.digest).collect::<Vec<_>>(), [oldest, new, asked]);
        let of_pinned = file(&blobs, pinned).metadata().unwrap().len();
        assert_eq!(plan.kept, [Kept { reason: KeptReason::Pin, files: 1, bytes: of_pinned }]);
        // A byte more than all is no reason to tell why anything stays.
        let plan = |most| service.state.tables.plan(service.state.queue.as_ref(), Some(most), later, vec![]).unwrap();
        assert_eq!((plan(bytes).kept, plan(bytes - 1).kept, plan(of_pinned).kept), (vec![], vec![], vec![]));

        // One byte less than all: one table is enough.
        let bounded = |store_bytes| Config { store_bytes: Some(store_bytes), ..config.clone() };
        let service = place.restart(service, bounded(bytes - 1));
        service.state.look().unwrap();
        assert_eq!(tables.map(|table| why(&service, table)), [Some(RemovalReason::StoreBytes), None, None, None]);
        assert!(!file(&blobs, oldest).exists() && service.table(oldest).unwrap().is_none());
        assert_eq!(service.recipe(Digest::of(b"gold 1")).unwrap(), Some(("gold 1".to_owned(), None)));
        assert!(service.removed_table(oldest).unwrap().unwrap().recipe == "gold 1");

        // What was used within ten minutes stays, however small the store is to be.
        let service = place.restart(service, bounded(1));
        service.state.look().unwrap();
        assert!([pinned, asked, new].iter().all(|table| service.table(*table).unwrap().is_some()));

        // The same recipe gives the same table, which is not a removed one any more.
        assert_eq!(fitted(&service, "gold 1"), oldest);
        assert_eq!(why(&service, oldest), None);
        assert!(service.table(oldest).unwrap().is_some());
        let service = place.restart(service, Config { unused_for: Duration::ZERO, ..bounded(1) });
        service.state.look().unwrap();
        let left = tables.map(|table| file(&blobs, table).exists());
        assert_eq!(left, [false, true, false, false], "but for the pin all of them go");
        assert!(service.unpin(pinned, &name("film")).unwrap() && !service.unpin(pinned, &name("film")).unwrap());
        service.state.look().unwrap();
        assert!(!file(&blobs, pinned).exists());
        assert!(matches!(service.pin(pinned, &name("film"), None), Err(PinError::Unknown(_))));
        service.stop();
    }
}

#[test]
fn a_use_that_is_not_written_yet_keeps_a_table() {
    for place in Place::all() {
        let dir = tempfile::tempdir().unwrap();
        let blobs = place.blobs(dir.path());
        let service = place.start(config(dir.path()));
        let table = fitted(&service, "gold 1");
        age(&service, &file(&blobs, table), table, 9000);
        let plan = service
            .state
            .tables
            .plan(service.state.queue.as_ref(), Some(1), service.state.queue.now(), vec![])
            .unwrap();
        assert_eq!(plan.going.len(), 1);
        assert!(service.table(table).unwrap().is_some());
        assert!(service.state.tables.uses.has(table));
        assert!(!service.state.remove_unless_used(&plan.going[0], service.state.queue.now()).unwrap());
        service.stop();
        drop(service);
        let row = place.store(dir.path()).rows.get(Tree::Uses, table.as_bytes()).unwrap().unwrap();
        assert!(!String::from_utf8(row).unwrap().contains("removed"), "the end of a process writes uses");
    }
}

/// As a process that is killed between the two steps leaves it: the rows are gone, the file is not.
#[test]
fn a_removal_that_was_interrupted_is_completed_by_the_next_start() {
    for place in Place::all() {
        let dir = tempfile::tempdir().unwrap();
        let blobs = place.blobs(dir.path());
        let config = config(dir.path());
        let service = place.start(config.clone());
        let table = fitted(&service, "gold 1");
        let bytes = std::fs::read(file(&blobs, table)).unwrap();
        service.delete_table(table, Some("root")).unwrap();
        assert!(!file(&blobs, table).exists());
        let mut row = service.state.tables.use_of(table).unwrap().unwrap();
        row.removed.as_mut().unwrap().has_file = true;
        let mut batch = crate::store::Batch::default();
        row.put(&mut batch, table).unwrap();
        service.state.tables.store.rows.commit(&batch).unwrap();
        service.stop();
        drop(service);
        std::fs::write(file(&blobs, table), bytes).unwrap();

        let service = place.start(config.clone());
        assert_eq!(service.tables(None, 9).unwrap().items, [], "it is not listed again");
        while file(&blobs, table).exists() {
            std::thread::yield_now();
        }
        assert_eq!(why(&service, table), Some(RemovalReason::Deleted(Some("root".to_owned()))));
        assert_eq!(fitted(&service, "gold 1"), table);
        service.state.look().unwrap();
        assert!(service.table(table).unwrap().is_some(), "a table that was fitted again is left alone");
        service.stop();
    }
}

#[test]
fn a_pinned_table_is_not_deleted_and_its_pins_are_told() {
    for place in Place::all() {
        let dir = tempfile::tempdir().unwrap();
        let service = place.start(config(dir.path()));
        let table = fitted(&service, "gold 1");
        for pin in ["film", "game"] {
            assert!(!service.pin(table, &name(pin), Some("farm")).unwrap().1);
            assert!(service.pin(table, &name(pin), None).unwrap().1, "it stays as it was");
        }
        let Err(DeleteTableError::Pinned { pins, .. }) = service.delete_table(table, None) else { panic!("it went") };
        assert_eq!(pins.iter().map(|pin| pin.name.to_string()).collect::<Vec<_>>(), ["film", "game"]);
        assert!(pins.iter().all(|pin| pin.created_by.as_deref() == Some("farm")));
        // Pins outlive the process, and in a data folder the database.
        service.stop();
        drop(service);
        if matches!(place, Place::Folder) {
            std::fs::remove_dir_all(dir.path().join("db")).unwrap();
        }
        let service = place.start(config(dir.path()));
        assert_eq!(service.pins(table).unwrap().unwrap(), pins);
        assert!(service.unpin(table, &name("film")).unwrap() && service.unpin(table, &name("game")).unwrap());
        service.delete_table(table, None).unwrap();
        assert!(matches!(service.delete_table(table, None), Err(DeleteTableError::Unknown(_))));
        assert_eq!(service.pins(table).unwrap(), None);
        service.stop();
    }
}

/// Two processes on one store, each with a cache of its own.
#[test]
fn a_table_that_another_process_removed_leaves_the_cache_once_it_was_asked_for() {
    let Some(url) = throwaway::empty_database() else { return };
    let (place, dir) = (Place::Cluster(url), tempfile::tempdir().unwrap());
    let folders = ["a", "b"].map(|name| dir.path().join(name));
    for folder in &folders {
        std::fs::create_dir(folder).unwrap();
    }
    std::fs::create_dir(folders[0].join("store")).unwrap();
    std::os::unix::fs::symlink(folders[0].join("store"), folders[1].join("store")).unwrap();
    let a = place.start(config(&folders[0]));
    let table = fitted(&a, "gold 1");
    let b = place.start(config(&folders[1]));
    b.pin(table, &name("film"), None).unwrap();
    assert!(matches!(a.delete_table(table, None), Err(DeleteTableError::Pinned { .. })));
    assert!(b.table(table).unwrap().is_some() && b.unpin(table, &name("film")).unwrap());
    a.delete_table(table, None).unwrap();
    assert!(b.table(table).unwrap().is_some(), "it is in its cache");
    b.state.write_uses().unwrap();
    assert!(b.table(table).unwrap().is_none());
    assert_eq!(why(&b, table), Some(RemovalReason::Deleted(None)));
    a.stop();
    b.stop();
}

#[test]
fn a_file_that_is_sent_again_counts_as_used() {
    let dir = tempfile::tempdir().unwrap();
    let service = Place::Folder.start(config(dir.path()));
    let axes = TabulatedAxes::spread(vec![0.2, 1.0], 48, 32);
    let bytes = encode(&TabulatedBrdf::tabulate(BrdfKind::OrenNayar, axes).unwrap()).unwrap();
    for was_there in [false, true] {
        let (stored, was) = service.store_brdf(&bytes).unwrap();
        assert_eq!(was, was_there);
        assert!(service.state.tables.uses.has(stored.digest));
        service.state.write_uses().unwrap();
        assert!(!service.state.tables.uses.has(stored.digest));
    }
    service.stop();
}

/// A BRDF stays as long as the recipe of a table names it, though it was used before the table, and then goes.
#[test]
fn a_brdf_stays_while_the_recipe_of_a_table_names_it() {
    for place in Place::all() {
        let dir = tempfile::tempdir().unwrap();
        let store = place.store(dir.path());
        let (rows, blobs) = (Arc::clone(&store.rows), Arc::clone(&store.blobs));
        let brdf = blobs.put(b"a brdf").unwrap();
        let table = blobs.put(b"TABLE of a brdf").unwrap();
        let created_at = Timestamp::from_second(1_000_000).unwrap();
        let row = super::TableRow { digest: table, recipe_digest: Digest::of(b"recipe"), bytes: 15, created_at };
        let recipe = format!(r#"{{"tabulated":"{brdf}"}}"#);
        rows.commit(&crate::store::Catalogue::entry(&row, &recipe).unwrap()).unwrap();
        drop((rows, blobs, store));
        let service = place.start(config(dir.path()));
        age(&service, &file(&place.blobs(dir.path()), brdf), brdf, 9000);
        age(&service, &file(&place.blobs(dir.path()), table), table, 8000);
        let plan = |most| {
            let state = &service.state;
            let plan = state.tables.plan(state.queue.as_ref(), Some(most), state.queue.now(), vec![]).unwrap();
            (plan.going.iter().map(|going| going.digest).collect::<Vec<_>>(), plan.kept)
        };
        assert_eq!(plan(20), (vec![table], vec![]), "the BRDF is older, and needed");
        assert_eq!(plan(1), (vec![table, brdf], vec![]));
        service.pin(table, &name("film"), None).unwrap();
        let kept =
            [(KeptReason::Pin, 15), (KeptReason::Table, 6)].map(|(reason, bytes)| Kept { reason, files: 1, bytes });
        assert_eq!(plan(1), (vec![], kept.to_vec()));
        service.stop();
    }
}
