//! A PostgreSQL server for tests. It is started on first use, and removed when the process ends.
#![allow(dead_code, unreachable_pub, reason = "the tests of the library and of the binary use different parts")]

use std::{
    env, fs,
    io::Write as _,
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    sync::{
        LazyLock,
        atomic::{AtomicU32, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

/// Makes a database cluster in `$1` with the programs in `$2`, or copies the cluster whose socket is in `$4`. Runs the
/// server with the arguments `$3` until standard input ends, then removes the cluster. PostgreSQL does not run as root,
/// so root runs it as `nobody`.
const SCRIPT: &str = r#"
as=''; if [ "$(id -u)" = 0 ]; then as='setpriv --reuid=65534 --regid=65534 --clear-groups'; chown 65534:65534 "$1"; fi
cd "$1"
if [ -n "$4" ]; then
    $as "$2/pg_basebackup" -h "$4" -U postgres -D "$1/data" -R -X stream -c fast --no-sync >"$1/copy.log" 2>&1 || exit 1
else
    $as "$2/initdb" -D "$1/data" -U postgres -A trust -E UTF8 --locale=C --no-sync >"$1/initdb.log" 2>&1 || exit 1
fi
$as "$2/postgres" -D "$1/data" -k "$1" -c listen_addresses= -c max_connections=300 $3 >"$1/log" 2>&1 </dev/null &
server=$!
cat >/dev/null
kill -QUIT "$(head -1 "$1/data/postmaster.pid" 2>/dev/null)" 2>/dev/null; wait $server 2>/dev/null; rm -rf "$1"
"#;

/// Runs a program as the server's user.
const AS_SERVER: &str = r#"
as=''; if [ "$(id -u)" = 0 ]; then as='setpriv --reuid=65534 --regid=65534 --clear-groups'; fi
exec $as "$@"
"#;

/// Time limit for starting the server.
const DEADLINE: Duration = Duration::from_secs(60);

/// A running server. Its shell stops it when this process ends, even if it is killed.
pub struct Server {
    folder: PathBuf,
    programs: PathBuf,
    arguments: String,
    shell: Child,
    databases: AtomicU32,
}

/// The server that the tests of this process share. fsync is off, because its data need not survive.
static SHARED: LazyLock<Option<Server>> = LazyLock::new(|| Server::start("-c fsync=off"));

/// The URL of an empty database on the shared server. Prints a message and returns `None` without PostgreSQL.
pub fn empty_database() -> Option<String> {
    SHARED.as_ref().map(Server::empty_database)
}

/// The server of [`empty_database`]. Prints a message and returns `None` without PostgreSQL.
pub fn shared() -> Option<&'static Server> {
    SHARED.as_ref()
}

impl Server {
    /// Starts a server with more arguments. Prints a message and returns `None` without PostgreSQL.
    pub fn start(arguments: &str) -> Option<Self> {
        Self::start_as(arguments, None)
    }

    /// Starts a standby, which follows this server until it is promoted.
    pub fn standby(&self) -> Option<Self> {
        Self::start_as(&self.arguments, Some(&self.folder))
    }

    fn start_as(arguments: &str, copy_of: Option<&Path>) -> Option<Self> {
        static SERVERS: AtomicU32 = AtomicU32::new(0);
        let Some(programs) = programs() else {
            print_skipped("there is no PostgreSQL server here; `make cluster` installs it");
            return None;
        };
        let number = SERVERS.fetch_add(1, Ordering::Relaxed);
        let folder = env::temp_dir().join(format!("ltcforge-pg-{}-{number}", std::process::id()));
        fs::create_dir_all(&folder).expect("a folder for the cluster");
        let mut shell = Command::new("sh");
        shell.args(["-c", SCRIPT, "sh"]).arg(&folder).arg(&programs).arg(arguments).args(copy_of);
        let shell = shell.stdin(Stdio::piped()).spawn().expect("a shell");
        let server = Self { folder, programs, arguments: arguments.to_owned(), shell, databases: AtomicU32::new(0) };
        server.wait_until_ready();
        Some(server)
    }

    fn wait_until_ready(&self) {
        let start = Instant::now();
        while !self.is_ready() {
            assert!(start.elapsed() < DEADLINE, "PostgreSQL did not start: see {}", self.folder.display());
            thread::sleep(Duration::from_millis(10));
        }
    }

    /// Stops the server at once. Connections end, and committed data stays.
    pub fn stop(&self) {
        self.control(&["-m", "immediate", "stop"]);
    }

    /// Starts the server again.
    pub fn start_again(&self) {
        let options =
            format!("-k {} -c listen_addresses= -c max_connections=300 {}", self.folder.display(), self.arguments);
        let log = self.folder.join("data/log-again");
        self.control(&["-o", &options, "-l", log.to_str().expect("a path in UTF-8"), "start"]);
        self.wait_until_ready();
    }

    fn control(&self, arguments: &[&str]) {
        let mut command = Command::new("sh");
        command.args(["-c", AS_SERVER, "sh"]).arg(self.programs.join("pg_ctl")).arg("-D").arg(self.folder.join("data"));
        command
            .args(arguments)
            .current_dir(&self.folder)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        assert!(command.status().expect("pg_ctl").success(), "pg_ctl {arguments:?}");
    }

    /// Whether the server responds.
    pub fn is_ready(&self) -> bool {
        let mut command = self.client("pg_isready");
        command.stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok_and(|status| status.success())
    }

    /// The URL of an empty database.
    pub fn empty_database(&self) -> String {
        let name = format!("test{}", self.databases.fetch_add(1, Ordering::Relaxed));
        let made = self.client("createdb").arg(&name).status().expect("createdb");
        assert!(made.success(), "createdb {name}");
        self.url(&name)
    }

    /// The URL of a database.
    pub fn url(&self, name: &str) -> String {
        format!("postgres://postgres@/{name}?host={}&sslmode=disable", self.folder.display())
    }

    /// The socket of the server.
    pub fn socket(&self) -> PathBuf {
        self.folder.join(".s.PGSQL.5432")
    }

    /// The folder of the server, which contains its socket.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// A program of PostgreSQL, with arguments that connect to this server.
    pub fn client(&self, program: &str) -> Command {
        let mut command = Command::new(self.programs.join(program));
        command.arg("-h").arg(&self.folder).args(["-U", "postgres"]);
        command
    }

    /// Runs statements in a database and returns their output.
    pub fn psql(&self, database: &str, statements: &str) -> String {
        let mut command = self.client("psql");
        let output = command.args(["-XAtq", "-v", "ON_ERROR_STOP=1", "-d", database, "-c", statements]).output();
        let output = output.expect("psql");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8_lossy(&output.stdout).trim().to_owned()
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        drop(self.shell.stdin.take());
        let _ = self.shell.wait();
    }
}

/// The folder of PostgreSQL's programs: Debian's folder, or a folder in `PATH`.
fn programs() -> Option<PathBuf> {
    let on_path = env::split_paths(&env::var_os("PATH")?).collect::<Vec<_>>();
    let mut debian: Vec<PathBuf> = fs::read_dir("/usr/lib/postgresql")
        .map(|versions| versions.filter_map(|version| Some(version.ok()?.path().join("bin"))).collect())
        .unwrap_or_default();
    debian.sort();
    debian.reverse();
    let has_all = |folder: &PathBuf| {
        ["initdb", "postgres", "pg_basebackup", "pg_ctl", "pg_isready", "createdb", "psql"]
            .iter()
            .all(|name| folder.join(name).is_file())
    };
    debian.into_iter().chain(on_path).find(has_all)
}

/// Prints why the running test is skipped, directly to the terminal, because the test harness would hide it.
fn print_skipped(reason: &str) {
    let name = thread::current().name().unwrap_or_default().to_owned();
    // A test does not fail because of this message.
    let _ = std::io::stderr().write_all(format!("\n*** SKIPPED: {name}: {reason}\n\n").as_bytes());
}
