//! The service on a database and a blob store that any number of processes share.

use std::{collections::HashMap, fmt, num::NonZeroUsize, str::FromStr, sync::Arc};

use super::{
    Config, OpenError, Service,
    backend::FitBackend,
    open::{ServiceParts, limits},
    state::ServiceState,
};
use crate::{
    queue::postgres::{PostgresQueue, Process},
    store::{Access, Database, DatabaseTimeouts, ObjectBlobs, PairError, PostgresRows, Store, pair},
};
use ltcforge_fit::FITTER_VERSION;

/// How often the jobs that clients follow are looked at.
const FOLLOW: std::time::Duration = std::time::Duration::from_millis(250);

/// The URL of a database, which may have a password and is never printed.
#[derive(Clone, PartialEq, Eq, serde::Deserialize)]
#[serde(transparent)]
pub struct DatabaseUrl(String);

impl FromStr for DatabaseUrl {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(Self(text.to_owned()))
    }
}

impl fmt::Debug for DatabaseUrl {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("DatabaseUrl(..)")
    }
}

/// The database and the store of blobs that the processes of a cluster share.
#[derive(Debug, Clone)]
pub struct Shared {
    /// The database of the queue and the catalogue.
    pub database: DatabaseUrl,
    /// The URL of the blob store.
    pub blobs: String,
    /// Bytes of blobs that this process keeps in its data folder; with 0 it has no such folder.
    pub cache_bytes: u64,
    /// Connections to the database, at most, beside one that listens.
    pub connections: NonZeroUsize,
    /// How long the database lets statements and transactions take.
    pub timeouts: DatabaseTimeouts,
}

impl Shared {
    /// The database and the store, which know each other. Where they are new to each other, a process that writes
    /// introduces them.
    pub(super) fn open(&self, config: &Config, access: Access) -> Result<(Arc<Database>, Arc<ObjectBlobs>), OpenError> {
        let (database, blobs) = self.connect(config, access)?;
        let new = process_name();
        match pair(&database, &blobs, (access == Access::Write).then_some(new.as_str())) {
            Err(PairError::Unpaired) | Ok(()) => Ok((database, blobs)),
            Err(error) => Err(error.into()),
        }
    }

    pub(super) fn connect(
        &self,
        config: &Config,
        access: Access,
    ) -> Result<(Arc<Database>, Arc<ObjectBlobs>), OpenError> {
        // First, so that the schema is not made if this URL is wrong.
        let blobs = self.connect_blobs(config, access)?;
        Ok((Database::open_with(&self.database.0, self.connections, self.timeouts)?, blobs))
    }

    /// As [`Self::connect`], for what only reads; a schema that is not up to date is an error.
    pub(super) fn connect_unchanged(&self, config: &Config) -> Result<(Arc<Database>, Arc<ObjectBlobs>), OpenError> {
        let blobs = self.connect_blobs(config, Access::Read)?;
        Ok((Database::open_unchanged(&self.database.0, self.connections, self.timeouts)?, blobs))
    }

    fn connect_blobs(&self, config: &Config, access: Access) -> Result<Arc<ObjectBlobs>, OpenError> {
        let cache = config.data_dir.join("cache");
        Ok(Arc::new(ObjectBlobs::open(&self.blobs, access, &cache, self.cache_bytes)?))
    }
}

impl Service {
    /// As [`Service::open`], on a shared database and blob store. Without `works` it only serves.
    ///
    /// # Errors
    /// When the database or the blob store cannot be used.
    pub fn open_shared(config: Config, shared: &Shared, works: bool) -> Result<Arc<Self>, OpenError> {
        let (database, blobs) = shared.open(&config, if works { Access::Write } else { Access::Read })?;
        let process = Process { name: process_name(), fitter: FITTER_VERSION };
        let queue = PostgresQueue::open(Arc::clone(&database), limits(&config), process).map_err(OpenError::Shared)?;
        let backend = Arc::new(FitBackend::new(Some(Arc::clone(&blobs) as _)));
        let store = Store::shared(blobs, Arc::new(PostgresRows::new(database)));
        let service = Self::start(config, ServiceParts { queue: Box::new(queue), store, backend, works })?;
        service
            .spawn("follow".to_owned(), ServiceState::follow)
            .map_err(|source| OpenError::Unusable { path: service.state.config.data_dir.clone(), source })?;
        Ok(service)
    }
}

/// Host name, process id and start time: no other process has this name.
fn process_name() -> String {
    let machine = std::fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    let machine: String = machine.trim().chars().take(64).collect();
    format!("{machine}/{}/{}", std::process::id(), jiff::Timestamp::now().as_nanosecond())
}

impl ServiceState {
    /// Notifies clients of changes that other processes make to the jobs that the clients follow.
    fn follow(&self) {
        let mut last = HashMap::new();
        while !self.is_stopping() {
            self.publish_changes();
            let watched = self.hub.watched();
            last.retain(|id, _| watched.contains(id));
            for id in watched {
                let Ok(Some(job)) = self.queue.job(id) else { continue };
                let now = (job.state.name(), job.entries_done);
                if last.insert(id, now) != Some(now) {
                    self.publish(id);
                }
            }
            self.queue.pause(FOLLOW);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::{
        fs::{self, File},
        path::{Path, PathBuf},
        time::{Duration, SystemTime},
    };

    use super::*;
    use crate::{
        service::{Kept, KeptReason, Removal, Swept, WORKER_CONNECTIONS, sweep, tests::config},
        store::{Blobs as _, throwaway},
    };
    use ltcforge_files::{digest::Digest, tabulated::encode};
    use ltcforge_fit::{BrdfKind, TabulatedAxes, TabulatedBrdf};

    #[test]
    fn an_old_brdf_is_kept_once_a_job_that_names_it_is_submitted() {
        let Some(url) = throwaway::empty_database() else { return };
        let dir = tempfile::tempdir().unwrap();
        let (store, config) = (dir.path().join("store"), config(&dir.path().join("data")));
        fs::create_dir_all(&store).unwrap();
        let shared = Shared {
            database: url.parse().unwrap(),
            blobs: format!("file://{}", store.display()),
            cache_bytes: 1 << 20,
            connections: WORKER_CONNECTIONS,
            timeouts: DatabaseTimeouts::default(),
        };
        let unpaired = sweep(&config, &shared, Removal::Nothing).unwrap_err().to_string();
        assert!(unpaired.contains("start `ltcforge serve`"), "{unpaired}");
        shared.open(&config, Access::Write).unwrap();
        let service = Service::open_shared(config.clone(), &shared, false).unwrap();
        let [named, other] = [0.2, 0.3].map(|alpha| {
            let axes = TabulatedAxes::spread(vec![alpha, 1.0], 48, 32);
            let bytes = encode(&TabulatedBrdf::tabulate(BrdfKind::OrenNayar, axes).unwrap()).unwrap();
            let (stored, _) = service.store_brdf(&bytes).unwrap();
            let hex = stored.digest.hex();
            (stored.digest, store.join(&hex[..2]).join(hex.as_str()))
        });
        let long_ago = SystemTime::now() - Duration::from_secs(200_000);
        let age = |file: &PathBuf| File::options().write(true).open(file).unwrap().set_modified(long_ago).unwrap();
        age(&named.1);
        age(&other.1);
        let recipe =
            format!(r#"{{"brdf": "tabulated", "tabulated": "{}", "resolution": {{"alpha": 2, "theta": 3}}}}"#, named.0);
        service.submit(recipe.as_bytes(), None).unwrap();
        let stored_at = |file| fs::metadata(file).unwrap().modified().unwrap();
        assert!(stored_at(&named.1) > stored_at(&other.1), "it is put again once the job is known");
        age(&named.1);
        let swept = |removal| sweep(&config, &shared, removal);
        let told = swept(Removal::Nothing).unwrap();
        assert_eq!((told.files, told.removed), (2, 0));
        assert_eq!(told.going.iter().map(|going| going.digest).collect::<Vec<_>>(), [other.0]);
        let small = sweep(&Config { store_bytes: Some(1), ..config.clone() }, &shared, Removal::Nothing).unwrap();
        let bytes = fs::metadata(&named.1).unwrap().len();
        assert_eq!(small.kept, [Kept { reason: KeptReason::Job, files: 1, bytes }]);
        assert!(named.1.exists() && other.1.exists());
        assert_eq!(swept(Removal::Going).unwrap(), Swept { removed: 1, ..told });
        assert!(named.1.exists() && !other.1.exists());
        service.stop();
    }

    /// Two databases and two stores.
    fn pairs(dir: &Path) -> Option<[Shared; 2]> {
        let shared = |name: &str| {
            let store = dir.join(name);
            fs::create_dir_all(&store).unwrap();
            let database = throwaway::empty_database()?.parse().unwrap();
            Some(Shared {
                database,
                blobs: format!("file://{}", store.display()),
                cache_bytes: 1 << 20,
                connections: WORKER_CONNECTIONS,
                timeouts: DatabaseTimeouts::default(),
            })
        };
        Some([shared("a")?, shared("b")?])
    }

    fn old_blob(dir: &Path, name: &str) -> PathBuf {
        let hex = Digest::of(name.as_bytes()).hex();
        let file = dir.join(&hex[..2]).join(&hex);
        fs::create_dir_all(file.parent().unwrap()).unwrap();
        fs::write(&file, name).unwrap();
        let long_ago = SystemTime::now() - Duration::from_secs(200_000);
        File::options().write(true).open(&file).unwrap().set_modified(long_ago).unwrap();
        file
    }

    #[test]
    fn a_database_and_a_store_that_do_not_know_each_other_are_refused() {
        let dir = tempfile::tempdir().unwrap();
        let Some([a, b]) = pairs(dir.path()) else { return };
        let config = config(&dir.path().join("data"));
        let refused = |database: &Shared, store: &Shared| {
            let strangers = Shared { database: database.database.clone(), ..store.clone() };
            for access in [Access::Write, Access::Read] {
                let error = strangers.open(&config, access).unwrap_err().to_string();
                assert!(error.contains("do not belong together"), "{error}");
            }
            let works = Service::open_shared(config.clone(), &strangers, true).unwrap_err();
            assert!(matches!(works, OpenError::Pair(PairError::Strangers { .. })), "{works}");
            for removal in [Removal::Nothing, Removal::EvenMost] {
                assert!(matches!(sweep(&config, &strangers, removal), Err(OpenError::Pair(_))));
            }
        };
        let kept = old_blob(&dir.path().join("a"), "a table");
        a.open(&config, Access::Read).unwrap();
        a.open(&config, Access::Write).unwrap();
        // One that is new to an old store, and one that is old to a new store.
        refused(&b, &a);
        refused(&a, &b);
        b.open(&config, Access::Write).unwrap();
        refused(&b, &a);
        refused(&a, &b);
        for shared in [&a, &b] {
            shared.open(&config, Access::Write).unwrap();
        }
        assert!(kept.exists());
    }

    #[test]
    fn of_many_that_start_at_once_one_introduces_database_and_store() {
        let dir = tempfile::tempdir().unwrap();
        let Some([a, _]) = pairs(dir.path()) else { return };
        let config = config(&dir.path().join("data"));
        std::thread::scope(|scope| {
            let open = || a.open(&config, Access::Write).map(drop).unwrap();
            let threads: Vec<_> = (0..4).map(|_| scope.spawn(open)).collect();
            for thread in threads {
                thread.join().unwrap();
            }
        });
    }

    #[test]
    fn most_of_a_store_is_removed_only_on_demand() {
        let dir = tempfile::tempdir().unwrap();
        let Some([a, _]) = pairs(dir.path()) else { return };
        let config = config(&dir.path().join("data"));
        let (_, blobs) = a.open(&config, Access::Write).unwrap();
        let old = ["x", "y", "z"].map(|name| old_blob(&dir.path().join("a"), name));
        for young in [b"1", b"2"] {
            blobs.put(young).unwrap();
        }
        let refused = sweep(&config, &a, Removal::Going).unwrap_err().to_string();
        assert!(refused.contains("3 of the store's 5 blobs"), "{refused}");
        assert!(old.iter().all(|file| file.exists()));
        assert_eq!(sweep(&config, &a, Removal::EvenMost).unwrap().removed, 3);
        assert!(!old.iter().any(|file| file.exists()));
        let left = Swept { files: 2, bytes: 2, going: vec![], kept: vec![], removed: 0 };
        assert_eq!(sweep(&config, &a, Removal::Going).unwrap(), left);
    }

    #[test]
    fn the_url_of_a_database_is_not_printed() {
        let url: DatabaseUrl = "postgres://user:hunter2@host/name".parse().unwrap();
        let shared = Shared {
            database: url,
            blobs: "s3://bucket/x".to_owned(),
            cache_bytes: 1,
            connections: WORKER_CONNECTIONS,
            timeouts: DatabaseTimeouts::default(),
        };
        assert!(!format!("{shared:?}").contains("hunter2"));
    }
}
