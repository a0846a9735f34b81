//! Connections to PostgreSQL.

use std::{
    fmt,
    future::poll_fn,
    num::NonZeroUsize,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

use deadpool_postgres::{
    ClientWrapper, Hook, HookError, Manager, ManagerConfig, Pool, PoolError, QueueMode, RecyclingMethod,
    Runtime as PoolRuntime, Timeouts,
};
use tokio::{
    io::{AsyncRead, AsyncWrite},
    runtime::{Builder, Runtime},
    time::{Instant, timeout_at},
};
use tokio_postgres::{
    AsyncMessage, Config, Connection, NoTls, Socket,
    config::{Host, SslMode},
    error::SqlState,
};
use tokio_postgres_rustls::MakeRustlsConnect;

use super::{
    failure::{self, DatabaseOpenError},
    migrations,
    room::Room,
    settings::{DatabaseTimeouts, REPLICA_CONNECTIONS},
};
use crate::store::{StoreError, certificates};

/// A connection of the pool.
pub(crate) type Client = deadpool_postgres::Client;

/// How long connecting may take, and how long the server may not respond.
const TIMEOUT: Duration = Duration::from_secs(5);

/// How long an operation may take, with waiting for a connection and all retries.
const LIMIT: Duration = Duration::from_secs(20);

/// How long a connection that nobody uses is kept.
const IDLE: Duration = Duration::from_secs(60);

/// How long an operation is retried after its connection was lost.
const RETRY: Duration = Duration::from_secs(5);

/// The first pause between two tries, and the longest.
const PAUSES: (Duration, Duration) = (Duration::from_millis(20), Duration::from_millis(500));

const STRAY_AT: &str = "in a user or a password, @ : / ? # are written as %40 %3A %2F %3F %23";

/// Whether a URL has an `@` that does not end the user and the password. Parsers would take a part of the password for
/// the host or the name, and errors would show it.
fn has_stray_at(url: &str) -> bool {
    let Some((_, rest)) = url.split_once("://") else { return false };
    let authority = rest.split(['/', '?', '#']).next().unwrap_or(rest);
    rest.matches('@').count() != authority.matches('@').count() || authority.matches('@').count() > 1
}

/// A PostgreSQL database with the schema of this program. Its methods block: do not call them in async tasks.
pub struct Database {
    /// Runs the connections. `None` once this is being dropped.
    runtime: Option<Runtime>,
    pool: Pool,
    config: Config,
    /// `None` if the URL disables TLS.
    tls: Option<MakeRustlsConnect>,
    /// Host, port and name.
    name: String,
    /// Whether an operation may take no longer than [`LIMIT`].
    is_limited: AtomicBool,
    room: Room,
}

/// Why a process cannot write, in words; NULL if it can.
const FAULT: &str = "
    SELECT CASE WHEN current_setting('transaction_read_only') = 'on' THEN 'its transactions are read-only' ELSE (
        SELECT 'the role ' || current_user || ' may not write ' || string_agg(relname, ', ' ORDER BY relname)
        FROM pg_catalog.pg_class WHERE relnamespace = 'ltcforge'::regnamespace AND (
            relkind = 'r' AND relname <> 'migrations' AND NOT (has_table_privilege(oid, 'SELECT')
                AND has_table_privilege(oid, 'INSERT') AND has_table_privilege(oid, 'UPDATE')
                AND has_table_privilege(oid, 'DELETE'))
            OR relkind = 'S' AND NOT has_sequence_privilege(oid, 'USAGE'))
    ) END";

impl fmt::Debug for Database {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Database").field("name", &self.name).finish_non_exhaustive()
    }
}

impl Drop for Database {
    fn drop(&mut self) {
        if let Some(runtime) = self.runtime.take() {
            runtime.shutdown_background();
        }
    }
}

impl Database {
    /// Connects to the database of `url` and brings its schema up to date. A server without room for a connection is waited for.
    ///
    /// # Errors
    /// See [`DatabaseOpenError`].
    pub fn open(url: &str) -> Result<Arc<Self>, DatabaseOpenError> {
        Self::open_with(url, REPLICA_CONNECTIONS, DatabaseTimeouts::default())
    }

    /// As [`Self::open`], with at most `connections` beside one that [listens](Self::listen), and time limits of one's own. One
    /// is enough: no operation needs another while it has one.
    ///
    /// # Errors
    /// See [`DatabaseOpenError`].
    pub fn open_with(
        url: &str,
        connections: NonZeroUsize,
        limits: DatabaseTimeouts,
    ) -> Result<Arc<Self>, DatabaseOpenError> {
        let database = Self::connect(url, connections, limits)?;
        database.block_on(async { migrations::apply(&mut database.first_client().await?, migrations::ALL).await })?;
        Ok(Arc::new(database))
    }

    /// As [`Self::open_with`], but a schema that is not up to date is an error.
    ///
    /// # Errors
    /// See [`DatabaseOpenError`].
    pub fn open_unchanged(
        url: &str,
        connections: NonZeroUsize,
        limits: DatabaseTimeouts,
    ) -> Result<Arc<Self>, DatabaseOpenError> {
        let database = Self::connect(url, connections, limits)?;
        database.block_on(async { migrations::require(&database.first_client().await?, migrations::ALL).await })?;
        Ok(Arc::new(database))
    }

    fn connect(url: &str, connections: NonZeroUsize, limits: DatabaseTimeouts) -> Result<Self, DatabaseOpenError> {
        if has_stray_at(url) {
            return Err(DatabaseOpenError::BadUrl(STRAY_AT.to_owned()));
        }
        let mut config: Config = url.parse().map_err(|error: tokio_postgres::Error| {
            // The text has the name of a parameter, never its value.
            DatabaseOpenError::BadUrl(failure::text(&error))
        })?;
        if config.get_hosts().is_empty() {
            return Err(DatabaseOpenError::BadUrl("it has no host".to_owned()));
        }
        config.connect_timeout(TIMEOUT).keepalives_idle(TIMEOUT).tcp_user_timeout(2 * TIMEOUT);
        if config.get_application_name().is_none() {
            config.application_name("ltcforge");
        }
        let name = name(&config);
        let failed = |error: &dyn fmt::Display| DatabaseOpenError::Failed(error.to_string());
        let runtime = Builder::new_multi_thread().worker_threads(1).thread_name("database").enable_all().build();
        let runtime = runtime.map_err(|error| failed(&error))?;
        let manager_config = ManagerConfig { recycling_method: RecyclingMethod::Fast };
        let tls = if config.get_ssl_mode() == SslMode::Disable { None } else { Some(tls()?) };
        let manager = match &tls {
            None => Manager::from_config(config.clone(), NoTls, manager_config),
            Some(tls) => Manager::from_config(config.clone(), tls.clone(), manager_config),
        };
        let timeouts = Timeouts { wait: Some(6 * TIMEOUT), create: Some(2 * TIMEOUT), recycle: Some(TIMEOUT) };
        let pool = Pool::builder(manager).max_size(connections.get()).timeouts(timeouts).runtime(PoolRuntime::Tokio1);
        // Not among the startup parameters, of which a pooler in between knows only some.
        let settings: Arc<str> = limits.statements().into();
        let pool = pool.post_create(Hook::async_fn(move |client: &mut ClientWrapper, _| {
            let settings = Arc::clone(&settings);
            Box::pin(async move { client.batch_execute(&settings).await.map_err(HookError::Backend) })
        }));
        // The last one used is used next, so that the others are idle.
        let pool = pool.queue_mode(QueueMode::Lifo).build().map_err(|error| failed(&error))?;
        let idle = pool.clone();
        runtime.spawn(async move {
            loop {
                tokio::time::sleep(IDLE / 2).await;
                end_idle(&idle, IDLE);
            }
        });
        let (is_limited, room) = (AtomicBool::new(true), Room::default());
        Ok(Self { runtime: Some(runtime), pool, config, tls, name, is_limited, room })
    }

    /// The first connection, which tells whether there can be any; it waits for room.
    async fn first_client(&self) -> Result<Client, DatabaseOpenError> {
        loop {
            match self.connected().await {
                Err(error) if backend(&error).is_some_and(failure::is_without_room) => {}
                done => return done.map_err(|error| self.refusal(&error)),
            }
        }
    }

    fn refusal(&self, error: &PoolError) -> DatabaseOpenError {
        let database = self.name.clone();
        let Some(error) = backend(error) else {
            return DatabaseOpenError::Unreachable { database, reason: error.to_string() };
        };
        let reason = failure::text(error);
        match error.code() {
            // pg_hba.conf has no entry for a connection without TLS.
            Some(code)
                if *code == SqlState::INVALID_AUTHORIZATION_SPECIFICATION && reason.contains("no encryption") =>
            {
                DatabaseOpenError::Tls { database, reason }
            }
            Some(code)
                if *code == SqlState::INVALID_PASSWORD || *code == SqlState::INVALID_AUTHORIZATION_SPECIFICATION =>
            {
                DatabaseOpenError::Refused { database, reason }
            }
            None if reason.contains("TLS") || reason.contains("certificate") => {
                DatabaseOpenError::Tls { database, reason }
            }
            None if reason.contains("password") => DatabaseOpenError::Refused { database, reason },
            _ => DatabaseOpenError::Unreachable { database, reason },
        }
    }

    /// Runs `work` to its end on this thread.
    pub(crate) fn block_on<T>(&self, work: impl Future<Output = T>) -> T {
        self.runtime().block_on(work)
    }

    /// The runtime for background tasks.
    pub(crate) fn runtime(&self) -> &Runtime {
        // Only `drop` takes it out.
        self.runtime.as_ref().unwrap_or_else(|| unreachable!("a database that is being dropped was used"))
    }

    /// A connection of the pool. Where the server had no room a moment ago, one that comes back is waited for before it is asked
    /// again.
    async fn connected(&self) -> Result<Client, PoolError> {
        self.room.wait(|| self.pool.status().available > 0).await;
        self.pool.get().await.inspect_err(|error| backend(error).into_iter().for_each(|error| self.note(error)))
    }

    /// Tells of a server without room.
    fn note(&self, error: &tokio_postgres::Error) {
        if failure::is_without_room(error) {
            self.room.refused(&self.name, self.pool.status().max_size, &failure::text(error));
        }
    }

    /// A connection.
    pub(crate) async fn client(&self) -> Result<Client, StoreError> {
        self.connected().await.map_err(|error| match error {
            PoolError::Backend(error) | PoolError::PostCreateHook(HookError::Backend(error)) => error.into(),
            other => StoreError::Unavailable(other.to_string()),
        })
    }

    /// Lets operations take as long as they take, for a command that copies or looks at all there is.
    pub(crate) fn without_limit(&self) {
        self.is_limited.store(false, Ordering::Relaxed);
    }

    /// Runs `work` on a connection. If the connection is lost, or a transaction conflicts with another, `work` is
    /// retried for some seconds. Its transaction may have been committed the first time.
    ///
    /// # Errors
    /// [`StoreError::Unavailable`] if it may succeed later, or the database's error.
    #[expect(clippy::needless_pass_by_value, reason = "callers pass closures")]
    pub(crate) fn run<T>(&self, work: impl AsyncFn(&mut Client) -> Result<T, StoreError>) -> Result<T, StoreError> {
        self.block_on(async {
            let began = Instant::now();
            let limit = self.is_limited.load(Ordering::Relaxed).then_some(LIMIT);
            let mut pause = PAUSES.0;
            loop {
                match self.tried(limit.map(|limit| began + limit), &work).await {
                    Err(StoreError::Unavailable(_)) if began.elapsed() + pause < RETRY => {
                        tokio::time::sleep(pause).await;
                        pause = (2 * pause).min(PAUSES.1);
                    }
                    done => return done,
                }
            }
        })
    }

    /// Runs `work` once. A connection that does not answer in time is given up: it may never answer, and others would
    /// wait for it too.
    async fn tried<T>(
        &self,
        until: Option<Instant>,
        work: &impl AsyncFn(&mut Client) -> Result<T, StoreError>,
    ) -> Result<T, StoreError> {
        let Some(until) = until else { return work(&mut self.client().await?).await };
        let late = |_| StoreError::Unavailable(format!("{} does not answer in time", self.name));
        let mut client = timeout_at(until, self.client()).await.map_err(late)??;
        let done = timeout_at(until, work(&mut client)).await;
        if done.is_err() {
            drop(Client::take(client));
        }
        done.map_err(late)?
    }

    /// Why it cannot be used now, in words: it does not answer, or nothing can be written.
    pub(crate) fn fault(&self) -> Option<String> {
        let ask = async |client: &mut Client| {
            Ok(client.query_one(&client.prepare_cached(FAULT).await?, &[]).await?.get::<_, Option<String>>(0))
        };
        match self.block_on(self.tried(Some(Instant::now() + TIMEOUT), &ask)) {
            Ok(fault) => fault.map(|fault| format!("nothing can be written to {}: {fault}", self.name)),
            Err(error) => Some(error.to_string()),
        }
    }

    /// Opens another connection, runs `statement`, and passes all messages to `on_message`. Returns when the connection
    /// ends.
    pub(crate) async fn listen(&self, statement: &str, on_message: impl FnMut(AsyncMessage)) -> Result<(), StoreError> {
        self.room.wait(|| false).await;
        let listened = async {
            match &self.tls {
                None => listen(self.config.connect(NoTls).await?, statement, on_message).await,
                Some(tls) => listen(self.config.connect(tls.clone()).await?, statement, on_message).await,
            }
        };
        Ok(listened.await.inspect_err(|error| self.note(error))?)
    }
}

/// The error of the server or its connection.
fn backend(error: &PoolError) -> Option<&tokio_postgres::Error> {
    match error {
        PoolError::Backend(error) | PoolError::PostCreateHook(HookError::Backend(error)) => Some(error),
        _ => None,
    }
}

/// Ends the connections of `pool` that nobody has used for so long.
fn end_idle(pool: &Pool, idle: Duration) {
    pool.retain(|_, metrics| metrics.last_used() < idle);
}

async fn listen<S: AsyncRead + AsyncWrite + Unpin>(
    (client, mut connection): (tokio_postgres::Client, Connection<Socket, S>),
    statement: &str,
    mut on_message: impl FnMut(AsyncMessage),
) -> Result<(), tokio_postgres::Error> {
    let messages = async {
        while let Some(message) = poll_fn(|context| connection.poll_message(context)).await {
            on_message(message?);
        }
        Ok(())
    };
    // The client is alive until the connection ends.
    tokio::try_join!(client.batch_execute(statement), messages).map(drop)
}

/// TLS with the system's certificates, or those of `SSL_CERT_FILE`.
fn tls() -> Result<MakeRustlsConnect, DatabaseOpenError> {
    let mut roots = rustls::RootCertStore::empty();
    roots.add_parsable_certificates(certificates::load().map_err(DatabaseOpenError::Failed)?);
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    let config = rustls::ClientConfig::builder_with_provider(provider).with_safe_default_protocol_versions();
    let config = config.map_err(|error| DatabaseOpenError::Failed(error.to_string()))?;
    Ok(MakeRustlsConnect::new(config.with_root_certificates(roots).with_no_client_auth()))
}

/// Host, port and name of a database, without user and password.
fn name(config: &Config) -> String {
    let host = match config.get_hosts().first() {
        Some(Host::Tcp(host)) => host.clone(),
        Some(Host::Unix(folder)) => folder.display().to_string(),
        None => String::new(),
    };
    let port = config.get_ports().first().copied().unwrap_or(5432);
    format!("the database {} on {host}:{port}", config.get_dbname().or(config.get_user()).unwrap_or_default())
}

#[cfg(test)]
mod tests;
