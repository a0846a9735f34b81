//! A replica and a worker that connect to the database through pgbouncer.

use std::{
    env, fs,
    net::{SocketAddr, TcpListener, TcpStream},
    path::PathBuf,
    process::{Child, Command, Stdio},
    time::Instant,
};

use crate::{
    Shared, Worker,
    common::{command::run_with_stdin, eventually, report_skipped, seeded, server::text},
    throwaway,
};

/// The first version that keeps prepared statements in transaction mode.
const WITH_PREPARED: (u32, u32) = (1, 21);

/// Jobs in each mode: first at the same time, then one by one.
const JOBS: u32 = 8;

/// Runs pgbouncer as another user, because it rejects root.
const AS_NOBODY: &str = r#"
as=''; if [ "$(id -u)" = 0 ]; then as='setpriv --reuid=65534 --regid=65534 --clear-groups'; fi
exec $as "$@"
"#;

/// A running pgbouncer. It is killed when dropped.
pub(crate) struct Pooler {
    child: Child,
    pub(crate) address: SocketAddr,
}

impl Drop for Pooler {
    fn drop(&mut self) {
        // The process may have ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Pooler {
    /// Starts `program` in front of a database called `name`, with additional lines for its sections `[databases]` and
    /// `[pgbouncer]`.
    pub(crate) fn start(
        program: &PathBuf,
        database: &throwaway::Server,
        name: &str,
        of_database: &str,
        of_all: &str,
    ) -> Self {
        let free = TcpListener::bind("127.0.0.1:0").and_then(|listener| listener.local_addr()).expect("a free port");
        let folder = database.folder();
        let settings = format!(
            "[databases]\n{name} = host={} user=postgres {of_database}\n[pgbouncer]\nlisten_addr = 127.0.0.1\n\
             listen_port = {}\nunix_socket_dir =\nauth_type = any\nmax_client_conn = 300\n{of_all}\n",
            folder.display(),
            free.port()
        );
        let file = folder.join(format!("pgbouncer-{}.ini", free.port()));
        fs::write(&file, settings).expect("a file");
        let mut command = Command::new("sh");
        command.args(["-c", AS_NOBODY, "sh"]).arg(program).arg("-q").arg(&file).current_dir(folder);
        let child = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("a shell");
        let pooler = Self { child, address: free };
        eventually("pgbouncer", || TcpStream::connect(pooler.address).ok());
        pooler
    }
}

/// The program and its version. Prints a message and returns `None` if it is not installed.
pub(crate) fn pgbouncer() -> Option<(PathBuf, (u32, u32))> {
    let named = env::var_os("LTCFORGE_TEST_PGBOUNCER").map(PathBuf::from);
    for program in named.map_or_else(|| vec!["pgbouncer".into(), "/usr/sbin/pgbouncer".into()], |named| vec![named]) {
        let Ok(output) = Command::new(&program).arg("--version").output() else { continue };
        let output = String::from_utf8_lossy(&output.stdout).into_owned();
        let mut numbers = output.trim_start_matches("PgBouncer ").split(|c: char| !c.is_ascii_digit()).map(str::parse);
        if let (Some(Ok(major)), Some(Ok(minor))) = (numbers.next(), numbers.next()) {
            return Some((program, (major, minor)));
        }
    }
    report_skipped("there is no pgbouncer here; `make cluster` installs it");
    None
}

/// The settings for transaction mode in docs/operations.md: for the database, and for pgbouncer.
fn documented() -> (String, String) {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/operations.md");
    let document = fs::read_to_string(file).expect("the document");
    let block =
        document.split("```ini\n").nth(1).and_then(|rest| rest.split("```").next()).expect("a block of settings");
    let (of_database, of_all) = block.split_once("[pgbouncer]\n").expect("two sections");
    let (_, query) = of_database.split_once("connect_query=").expect("settings of connections");
    (format!("connect_query={}", query.trim()), of_all.to_owned())
}

#[test]
fn no_job_is_lost_through_pgbouncer() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some((program, version)) = pgbouncer() else { return };
    let Some(shared) = Shared::new(folder.path()) else { return };
    let Some(database) = throwaway::Server::start("-c fsync=off") else { return };
    let mut modes = vec![("session", (String::new(), "pool_mode = session".to_owned()))];
    if version >= WITH_PREPARED {
        modes.push(("transaction", documented()));
    } else {
        report_skipped(&format!(
            "transaction mode: pgbouncer {}.{} keeps no prepared statements in it",
            version.0, version.1
        ));
    }
    for (mode, (of_database, of_all)) in modes {
        // Each mode has its own database and store.
        let folder = folder.path().join(mode);
        let blobs = folder.join("store");
        fs::create_dir_all(&blobs).expect("a folder");
        let url = database.empty_database();
        let name = url.split(['/', '?']).nth(3).expect("a name").to_owned();
        let pooler = Pooler::start(&program, &database, &name, &of_database, &of_all);
        let direct = Shared { database: url, blobs: format!("file://{}", blobs.display()), ..shared.clone() };
        let through = direct.by(pooler.address);
        let replica = through.replica(&folder.join("replica"));
        let _workers = [(); 2].map(|()| Worker::start(&through, &folder, "60"));
        let ids: Vec<String> = (0..JOBS)
            .map(|seed| text(&replica.submit(&seeded(seed)).with_status(202).json()["id"]).to_owned())
            .collect();
        for (seed, id) in (0..).zip(&ids) {
            let job = replica.finished(id);
            assert_eq!(job["state"], "done", "{mode}: {job:#}");
            let expected = run_with_stdin(&folder, ["fit", "-", "-o", "fitted"], &seeded(seed)).exited(0);
            assert_eq!(job["table"], expected.last_line(), "{mode}");
        }
        replica.get("/readyz").with_status(200);
        let table = text(&replica.finished(&ids[0])["table"]).to_owned();
        replica.request("DELETE", &format!("/v1/tables/{table}"), &[], None).with_status(204);
        let begun = Instant::now();
        (JOBS..2 * JOBS).for_each(|seed| drop(replica.fit(&seeded(seed))));
        println!("{mode} mode of pgbouncer {version:?}: {:.2} s for a job", (begun.elapsed() / JOBS).as_secs_f64());
        if mode == "transaction" {
            let mut psql = Command::new("psql");
            psql.args([
                "-XAtq",
                "-h",
                "127.0.0.1",
                "-p",
                &pooler.address.port().to_string(),
                "-U",
                "postgres",
                "-d",
                &name,
            ]);
            let output = psql.args(["-c", "SHOW enable_seqscan; SHOW statement_timeout"]).output().expect("psql");
            assert_eq!(String::from_utf8_lossy(&output.stdout), "off\n30s\n", "every connection has the settings");
        }
    }
}
