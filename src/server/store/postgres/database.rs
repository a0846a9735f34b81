//! Connections to PostgreSQL.

use std::{fmt, num::NonZeroUsize, sync::Arc, time::Duration};

use deadpool_postgres::{
    ClientWrapper, Hook, HookError, Manager, ManagerConfig, Pool, PoolError, QueueMode, RecyclingMethod,
    Runtime as PoolRuntime, Timeouts,
};
use tokio::time::{Instant, timeout_at};
use tokio_postgres::{
    Config, NoTls,
    config::{Host, SslMode},
    error::SqlState,
};
use tokio_postgres_rustls::MakeRustlsConnect;

use super::{failure, migrations};
use crate::store::{ConnectError, StoreError, certificates, threads::Threads};

/// A connection of the pool.
pub(crate) type Client = deadpool_postgres::Client;

/// Time limit for connecting, and for a server that does not respond.
const TIMEOUT: Duration = Duration::from_secs(5);

/// Time limit for an operation, including waiting for a connection and all retries.
const LIMIT: Duration = Duration::from_secs(20);

/// How long an unused connection is kept.
const IDLE: Duration = Duration::from_secs(60);

/// How long an operation is retried after its connection was lost.
const RETRY: Duration = Duration::from_secs(5);

/// The first and the longest pause between two attempts.
const PAUSES: (Duration, Duration) = (Duration::from_millis(20), Duration::from_millis(500));

/// Settings of every connection. They make every statement use indexes, independently of statistics and arguments. A
/// statement is planned once per connection. JIT is off, because compiling a statement takes longer than running it.
/// The timeouts end statements and transactions of dead processes.
const SETTINGS: &str = "SET jit = off; SET enable_seqscan = off; SET enable_bitmapscan = off; SET enable_hashjoin = off; \
    SET enable_mergejoin = off; SET plan_cache_mode = force_generic_plan; SET client_connection_check_interval = 5000; \
    SET statement_timeout = 30000; SET idle_in_transaction_session_timeout = 60000";

/// Selects the reason why the process cannot write, or NULL if it can write.
const FAULT: &str = "
    SELECT CASE WHEN current_setting('transaction_read_only') = 'on' THEN 'its transactions are read-only' ELSE (
        SELECT 'the role ' || current_user || ' may not write ' || string_agg(relname, ', ' ORDER BY relname)
        FROM pg_catalog.pg_class WHERE relnamespace = 'ltcforge'::regnamespace AND (
            relkind = 'r' AND relname <> 'migrations' AND NOT (has_table_privilege(oid, 'SELECT')
                AND has_table_privilege(oid, 'INSERT') AND has_table_privilege(oid, 'UPDATE')
                AND has_table_privilege(oid, 'DELETE'))
            OR relkind = 'S' AND NOT has_sequence_privilege(oid, 'USAGE'))
    ) END";

const STRAY_AT: &str = "in the user and the password, write @ : / ? # as %40 %3A %2F %3F %23";

/// Whether a URL has an `@` other than the `@` after the password. Parsers would take a part of the password for the
/// host or the database name, and errors would show it.
fn has_stray_at(url: &str) -> bool {
    let Some((_, rest)) = url.split_once("://") else { return false };
    let authority = rest.split(['/', '?', '#']).next().unwrap_or(rest);
    rest.matches('@').count() != authority.matches('@').count() || authority.matches('@').count() > 1
}

/// A PostgreSQL database with the schema of this program. Its methods block: do not call them in async tasks.
pub struct Database {
    /// The threads that run the connections.
    threads: Threads,
    pool: Pool,
    /// The name, host and port of the database, for messages.
    name: String,
}

impl fmt::Debug for Database {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Database").field("name", &self.name).finish_non_exhaustive()
    }
}

impl Database {
    /// The default maximum number of connections of a process.
    pub const CONNECTIONS: NonZeroUsize = NonZeroUsize::new(16).unwrap();

    /// Connects to the database at `url` and updates its schema.
    ///
    /// # Errors
    /// The reason, as a text.
    pub fn open(url: &str) -> Result<Arc<Self>, ConnectError> {
        Self::open_with(url, Self::CONNECTIONS)
    }

    /// Like [`Self::open`], but with at most `connections` connections. One connection is enough, because no operation
    /// needs two at the same time.
    ///
    /// # Errors
    /// The reason, as a text.
    pub fn open_with(url: &str, connections: NonZeroUsize) -> Result<Arc<Self>, ConnectError> {
        let database = Self::connect(url, connections)?;
        database.block_on(async {
            let mut client = database.pool.get().await.map_err(|error| database.refusal(&error))?;
            migrations::apply(&mut client, migrations::ALL).await
        })?;
        Ok(Arc::new(database))
    }

    fn connect(url: &str, connections: NonZeroUsize) -> Result<Self, ConnectError> {
        if has_stray_at(url) {
            return Err(bad_url(STRAY_AT));
        }
        // The parser's error contains names of parameters, but never their values.
        let mut config: Config = url.parse().map_err(|error: tokio_postgres::Error| bad_url(&failure::text(&error)))?;
        if config.get_hosts().is_empty() {
            return Err(bad_url("the host is missing"));
        }
        config.connect_timeout(TIMEOUT).keepalives_idle(TIMEOUT).tcp_user_timeout(2 * TIMEOUT);
        if config.get_application_name().is_none() {
            config.application_name("ltcforge");
        }
        let name = name(&config);
        let threads = Threads::start("database").map_err(failed)?;
        let manager_config = ManagerConfig { recycling_method: RecyclingMethod::Fast };
        let manager = match config.get_ssl_mode() {
            SslMode::Disable => Manager::from_config(config, NoTls, manager_config),
            _ => Manager::from_config(config, tls()?, manager_config),
        };
        let timeouts = Timeouts { wait: Some(6 * TIMEOUT), create: Some(2 * TIMEOUT), recycle: Some(TIMEOUT) };
        let pool = Pool::builder(manager).max_size(connections.get()).timeouts(timeouts).runtime(PoolRuntime::Tokio1);
        // The settings are not startup parameters, because a pooler may reject some of them.
        let pool = pool.post_create(Hook::async_fn(|client: &mut ClientWrapper, _| {
            Box::pin(async { client.batch_execute(SETTINGS).await.map_err(HookError::Backend) })
        }));
        // The most recently used connection is used first, so that the others become idle and are closed.
        let pool = pool.queue_mode(QueueMode::Lifo).build().map_err(failed)?;
        let idle = pool.clone();
        let close_idle = async move {
            loop {
                tokio::time::sleep(IDLE / 2).await;
                idle.retain(|_, metrics| metrics.last_used() < IDLE);
            }
        };
        threads.block_on(async { drop(tokio::spawn(close_idle)) });
        Ok(Self { threads, pool, name })
    }

    fn refusal(&self, error: &PoolError) -> ConnectError {
        let database = &self.name;
        let unreachable = |reason: &str| ConnectError(format!("{database} cannot be reached: {reason}"));
        let (PoolError::Backend(error) | PoolError::PostCreateHook(HookError::Backend(error))) = error else {
            return unreachable(&error.to_string());
        };
        let reason = failure::text(error);
        let is = |state: &SqlState| error.code() == Some(state);
        let is_role = is(&SqlState::INVALID_AUTHORIZATION_SPECIFICATION);
        // pg_hba.conf does not allow connections without TLS.
        let needs_tls = is_role && reason.contains("no encryption");
        let is_unanswered = error.code().is_none();
        if needs_tls || is_unanswered && (reason.contains("TLS") || reason.contains("certificate")) {
            ConnectError(format!(
                "{database}: {reason}; `sslmode` must be `disable`, `prefer` or `require`; certificates are always verified"
            ))
        } else if is_role || is(&SqlState::INVALID_PASSWORD) || is_unanswered && reason.contains("password") {
            ConnectError(format!("{database} refuses the user or the password: {reason}"))
        } else {
            unreachable(&reason)
        }
    }

    /// Runs `work` to completion and blocks the calling thread until then.
    pub(crate) fn block_on<T>(&self, work: impl Future<Output = T>) -> T {
        self.threads.block_on(work)
    }

    /// A connection of the pool.
    pub(crate) async fn client(&self) -> Result<Client, StoreError> {
        self.pool.get().await.map_err(|error| match error {
            PoolError::Backend(error) | PoolError::PostCreateHook(HookError::Backend(error)) => error.into(),
            other => StoreError::Unavailable(other.to_string()),
        })
    }

    /// Runs `work` on a connection. If the connection is lost or transactions conflict, `work` is retried for some
    /// seconds. The first attempt may already have committed its transaction.
    ///
    /// # Errors
    /// [`StoreError::Unavailable`] if `work` may succeed later, or the database's error.
    #[expect(clippy::needless_pass_by_value, reason = "callers pass closures")]
    pub(crate) fn run<T>(&self, work: impl AsyncFn(&mut Client) -> Result<T, StoreError>) -> Result<T, StoreError> {
        self.block_on(async {
            let began = Instant::now();
            let mut pause = PAUSES.0;
            loop {
                match self.tried(began + LIMIT, &work).await {
                    Err(StoreError::Unavailable(_)) if began.elapsed() + pause < RETRY => {
                        tokio::time::sleep(pause).await;
                        pause = (2 * pause).min(PAUSES.1);
                    }
                    done => return done,
                }
            }
        })
    }

    /// Runs `work` once. If a connection does not respond in time, it is dropped, so that the pool does not reuse it.
    async fn tried<T>(
        &self,
        until: Instant,
        work: &impl AsyncFn(&mut Client) -> Result<T, StoreError>,
    ) -> Result<T, StoreError> {
        let late = |_| StoreError::Unavailable(format!("{} does not respond in time", self.name));
        let mut client = timeout_at(until, self.client()).await.map_err(late)??;
        let done = timeout_at(until, work(&mut client)).await;
        if done.is_err() {
            drop(Client::take(client));
        }
        done.map_err(late)?
    }

    /// The reason why the database cannot be used now, for example because it does not respond or cannot be written.
    /// `None` if it can be used.
    pub(crate) fn fault(&self) -> Option<String> {
        let ask = async |client: &mut Client| {
            Ok(client.query_one(&client.prepare_cached(FAULT).await?, &[]).await?.get::<_, Option<String>>(0))
        };
        match self.block_on(self.tried(Instant::now() + TIMEOUT, &ask)) {
            Ok(fault) => fault.map(|fault| format!("nothing can be written to {}: {fault}", self.name)),
            Err(error) => Some(error.to_string()),
        }
    }
}

fn bad_url(reason: &str) -> ConnectError {
    let form = "use postgres://USER:PASSWORD@HOST:PORT/NAME?sslmode=MODE";
    ConnectError(format!("the database URL is invalid: {reason}; {form}"))
}

fn failed(error: impl fmt::Display) -> ConnectError {
    ConnectError(format!("the database: {error}"))
}

/// TLS with the certificates of the system or of `SSL_CERT_FILE`.
fn tls() -> Result<MakeRustlsConnect, ConnectError> {
    let mut roots = rustls::RootCertStore::empty();
    roots.add_parsable_certificates(certificates::load().map_err(failed)?);
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    let config = rustls::ClientConfig::builder_with_provider(provider).with_safe_default_protocol_versions();
    let config = config.map_err(failed)?;
    Ok(MakeRustlsConnect::new(config.with_root_certificates(roots).with_no_client_auth()))
}

/// The name of a database for messages: name, host and port, without user and password.
fn name(config: &Config) -> String {
    let host = match config.get_hosts().first() {
        Some(Host::Tcp(host)) => host.clone(),
        Some(Host::Unix(folder)) => folder.display().to_string(),
        None => String::new(),
    };
    let port = config.get_ports().first().copied().unwrap_or(5432);
    format!("the database {} on {host}:{port}", config.get_dbname().or(config.get_user()).unwrap_or_default())
}
