//! Tests with several processes of the binary, one PostgreSQL and one blob store, which is a folder.

#[path = "../../src/server/store/postgres/tests/throwaway.rs"]
pub(crate) mod throwaway;

mod errors;
pub(crate) mod faults;
mod kills;
mod links;
mod objects;
pub(crate) mod pgbouncer;
pub(crate) mod proxy;
pub(crate) mod s3;
mod watch;

use std::{
    io::{BufRead as _, BufReader},
    net::SocketAddr,
    path::Path,
    process::{Child, Command, Stdio},
};

use crate::common::{command::ltcforge, server::Server};

/// The database and the blob store that the processes of a test share.
#[derive(Clone)]
pub(crate) struct Shared {
    pub(crate) database: String,
    pub(crate) blobs: String,
    /// Additional environment variables for the processes.
    pub(crate) environment: Vec<(String, String)>,
}

impl Shared {
    /// Creates an empty database, and an empty folder in `folder`. Prints a message and returns `None` if PostgreSQL is
    /// not installed.
    pub(crate) fn new(folder: &Path) -> Option<Self> {
        let blobs = folder.join("store");
        std::fs::create_dir_all(&blobs).expect("a folder");
        let blobs = format!("file://{}", blobs.display());
        Some(Self { database: throwaway::empty_database()?, blobs, environment: vec![] })
    }

    /// The same database at another address, and the same store.
    pub(crate) fn by(&self, address: SocketAddr) -> Self {
        let database = format!("postgres://postgres@{address}/{}?sslmode=disable", self.name());
        Self { database, blobs: self.blobs.clone(), environment: self.environment.clone() }
    }

    /// The name of the database.
    pub(crate) fn name(&self) -> &str {
        let (_, name) = self.database.split_once("@/").expect("a URL of a throw-away server");
        name.split('?').next().unwrap_or(name)
    }

    /// A replica that only serves. `folder` is its data folder.
    pub(crate) fn replica(&self, folder: &Path) -> Server {
        let args: Vec<&str> = self.arguments().into_iter().chain(["--no-workers"]).collect();
        Server::start_in(folder, &args, &self.environment)
    }

    /// The arguments for the processes.
    pub(crate) fn arguments(&self) -> [&str; 4] {
        ["--database", &self.database, "--blobs", &self.blobs]
    }
}

/// A worker process. It is killed when dropped.
pub(crate) struct Worker(pub(crate) Child);

impl Worker {
    /// Starts a worker with one thread and leases of `lease_seconds`.
    pub(crate) fn start(shared: &Shared, folder: &Path, lease_seconds: &str) -> Self {
        Self::start_by(&[], shared, folder, lease_seconds).expect("a worker that connects")
    }

    /// Starts the worker through another command. `None` if the worker ended because it could not connect.
    pub(crate) fn start_by(by: &[&str], shared: &Shared, folder: &Path, lease_seconds: &str) -> Option<Self> {
        let own = ["--workers", "1", "--lease-seconds", lease_seconds];
        let mut command = ltcforge(folder, ["work"].iter().chain(&shared.arguments()).chain(&own));
        if let [program, arguments @ ..] = by {
            let mut other = Command::new(program);
            other.args(arguments).arg(command.get_program()).args(command.get_args()).current_dir(folder);
            command = other;
            command.stdin(Stdio::null()).stdout(Stdio::piped());
        }
        command.envs(shared.environment.iter().map(|(name, value)| (name, value)));
        let mut child = command.stderr(Stdio::null()).spawn().expect("the binary runs");
        let stdout = child.stdout.take().expect("a pipe");
        let worker = Self(child);
        let mut line = String::new();
        BufReader::new(stdout).read_line(&mut line).expect("a line on stdout or its end");
        assert!(line.is_empty() || line.starts_with("working"), "{line}");
        (!line.is_empty()).then_some(worker)
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        // The process may have ended already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}
