//! Several processes of the binary on one PostgreSQL and one store of tables: a folder, which outlives them all.
#![cfg(feature = "cluster")]

#[path = "../common/mod.rs"]
mod common;
#[path = "../../src/server/store/postgres/throwaway.rs"]
mod throwaway;

mod errors;
mod faults;
mod migration;

use std::{
    io::{BufRead as _, BufReader},
    path::Path,
    process::Child,
};

use common::command::ltcforge;

/// What the processes of a test share.
pub(crate) struct Shared {
    pub(crate) database: String,
    pub(crate) blobs: String,
}

impl Shared {
    /// An empty database and an empty folder in `folder`; `None`, told loudly, where PostgreSQL is not installed.
    pub(crate) fn new(folder: &Path) -> Option<Self> {
        let blobs = folder.join("store");
        std::fs::create_dir_all(&blobs).expect("a folder");
        Some(Self { database: throwaway::empty_database()?, blobs: format!("file://{}", blobs.display()) })
    }

    /// Their arguments.
    pub(crate) fn arguments(&self) -> [&str; 4] {
        ["--database", &self.database, "--blobs", &self.blobs]
    }
}

/// A process that works. Killed when dropped.
pub(crate) struct Worker(Child);

impl Worker {
    /// Starts one thread of work, with leases of `lease_seconds`.
    pub(crate) fn start(shared: &Shared, folder: &Path, lease_seconds: &str) -> Self {
        let data = folder.join("worker");
        let data = data.to_str().expect("a path in UTF-8");
        let own = ["--workers", "1", "--lease-seconds", lease_seconds, "--data", data];
        let mut command = ltcforge(folder, ["work"].iter().chain(&shared.arguments()).chain(&own));
        let mut child = command.stderr(std::process::Stdio::null()).spawn().expect("the binary runs");
        let mut line = String::new();
        BufReader::new(child.stdout.take().expect("a pipe")).read_line(&mut line).expect("a line on stdout");
        assert!(line.starts_with("working"), "{line}");
        Self(child)
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}
