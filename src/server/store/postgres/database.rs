//! Connections to PostgreSQL.

use std::{fmt, sync::Arc, time::Duration};

use deadpool_postgres::{Manager, ManagerConfig, Pool, PoolError, RecyclingMethod, Runtime as PoolRuntime, Timeouts};
use tokio::runtime::{Builder, Runtime};
use tokio_postgres::{
    AsyncMessage, Config, Connection, NoTls, Socket,
    config::{Host, SslMode},
    error::SqlState,
    tls::MakeTlsConnect,
};
use tokio_postgres_rustls::MakeRustlsConnect;

use super::{
    failure::{self, DatabaseOpenError},
    migrations,
};
use crate::store::StoreError;

/// A connection of the pool.
pub(crate) type Client = deadpool_postgres::Client;

/// Connections of one process, at most. Callers of the service share them; workers need two or three.
const CONNECTIONS: usize = 16;

/// Settings of every connection.
const PLANS: &str = "-c jit=off -c enable_seqscan=off -c enable_bitmapscan=off -c enable_hashjoin=off \
    -c enable_mergejoin=off -c plan_cache_mode=force_generic_plan";

/// How long a connection may take to be made, and how long it may stay unanswered.
const PATIENCE: Duration = Duration::from_secs(5);

/// How long an operation is tried again after its connection was lost.
const RECOVERY: Duration = Duration::from_secs(5);

/// How long an operation waits before it is tried again, at first and at most.
const PAUSES: (Duration, Duration) = (Duration::from_millis(20), Duration::from_millis(500));

const STRAY_AT: &str = "a user or a password with one of @ : / ? # has to have it encoded, as %40 %3A %2F %3F %23";

/// Whether a URL has an `@` that does not end the user and the password: parsers then take a piece of the password for the
/// host or the name, and errors would show it.
fn has_stray_at(url: &str) -> bool {
    let Some((_, rest)) = url.split_once("://") else { return false };
    let authority = rest.split(['/', '?', '#']).next().unwrap_or(rest);
    rest.matches('@').count() != authority.matches('@').count() || authority.matches('@').count() > 1
}

/// A PostgreSQL database with the schema of this program. Its methods block, and must not be called by tasks of tokio.
pub struct Database {
    /// Drives the connections.
    runtime: Option<Runtime>,
    pool: Pool,
    config: Config,
    /// Host, port and name.
    name: String,
}

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
    /// Connects to the database of `url` and brings its schema up to date.
    ///
    /// # Errors
    /// See [`DatabaseOpenError`].
    pub fn open(url: &str) -> Result<Arc<Self>, DatabaseOpenError> {
        if has_stray_at(url) {
            return Err(DatabaseOpenError::BadUrl(STRAY_AT.to_owned()));
        }
        let mut config: Config = url.parse().map_err(|error: tokio_postgres::Error| {
            // The text names a parameter, never its value.
            DatabaseOpenError::BadUrl(failure::text(&error))
        })?;
        if config.get_hosts().is_empty() {
            return Err(DatabaseOpenError::BadUrl("it names no host".to_owned()));
        }
        config.connect_timeout(PATIENCE).keepalives_idle(PATIENCE).tcp_user_timeout(2 * PATIENCE);
        // Each statement is meant to go by an index, whatever the statistics and its arguments say: it is planned once for a
        // connection, and none is worth compiling.
        let options = config.get_options().unwrap_or_default();
        config.options(format!("{options} {PLANS}"));
        if config.get_application_name().is_none() {
            config.application_name("ltcforge");
        }
        let name = name(&config);
        let failed = |error: &dyn fmt::Display| DatabaseOpenError::Failed(error.to_string());
        let runtime = Builder::new_multi_thread().worker_threads(1).thread_name("database").enable_all().build();
        let runtime = runtime.map_err(|error| failed(&error))?;
        let manager_config = ManagerConfig { recycling_method: RecyclingMethod::Fast };
        let manager = match config.get_ssl_mode() {
            SslMode::Disable => Manager::from_config(config.clone(), NoTls, manager_config),
            _ => Manager::from_config(config.clone(), tls()?, manager_config),
        };
        let timeouts = Timeouts { wait: Some(6 * PATIENCE), create: Some(2 * PATIENCE), recycle: Some(PATIENCE) };
        let pool = Pool::builder(manager).max_size(CONNECTIONS).timeouts(timeouts).runtime(PoolRuntime::Tokio1).build();
        let pool = pool.map_err(|error| failed(&error))?;
        let database = Self { runtime: Some(runtime), pool, config, name };
        database.block_on(async {
            let mut client = database.pool.get().await.map_err(|error| database.refusal(&error))?;
            migrations::apply(&mut client, migrations::ALL).await
        })?;
        Ok(Arc::new(database))
    }

    fn refusal(&self, error: &PoolError) -> DatabaseOpenError {
        let database = self.name.clone();
        let PoolError::Backend(error) = error else {
            return DatabaseOpenError::Unreachable { database, reason: error.to_string() };
        };
        let reason = failure::text(error);
        match error.code() {
            // The server's rules have no entry for a connection without TLS.
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

    /// What runs tasks beside the callers.
    pub(crate) fn runtime(&self) -> &Runtime {
        // It is taken out when this is dropped, and nothing is called then.
        self.runtime.as_ref().unwrap_or_else(|| unreachable!("a database that is being dropped was used"))
    }

    /// A connection.
    pub(crate) async fn client(&self) -> Result<Client, StoreError> {
        self.pool.get().await.map_err(|error| match &error {
            PoolError::Backend(error) => failure::store_error(error),
            other => StoreError::Unavailable(other.to_string()),
        })
    }

    /// Runs `work` on a connection; again, for some seconds, if the connection was lost or the transaction was in another's
    /// way. `work` has to bear that it was committed before.
    ///
    /// # Errors
    /// [`StoreError::Unavailable`] if it may succeed later, or the database's error.
    pub(crate) fn run<T>(
        &self,
        work: impl AsyncFn(&mut Client) -> Result<T, tokio_postgres::Error>,
    ) -> Result<T, StoreError> {
        self.block_on(self.retry(work))
    }

    async fn retry<T>(
        &self,
        work: impl AsyncFn(&mut Client) -> Result<T, tokio_postgres::Error>,
    ) -> Result<T, StoreError> {
        let until = tokio::time::Instant::now() + RECOVERY;
        let mut pause = PAUSES.0;
        loop {
            let done = async {
                let mut client = self.client().await?;
                work(&mut client).await.map_err(|error| failure::store_error(&error))
            };
            match done.await {
                Err(StoreError::Unavailable(_)) if tokio::time::Instant::now() + pause < until => {
                    tokio::time::sleep(pause).await;
                    pause = (2 * pause).min(PAUSES.1);
                }
                done => return done,
            }
        }
    }

    /// Whether it answers.
    pub(crate) fn is_reachable(&self) -> bool {
        let asked = async { self.client().await.ok()?.query_one("SELECT 1", &[]).await.ok() };
        self.block_on(async { tokio::time::timeout(PATIENCE, asked).await }).is_ok_and(|answer| answer.is_some())
    }

    /// A connection of its own, whose messages `on_message` gets. Returns once the connection ends.
    pub(crate) async fn listen(
        &self,
        statement: &str,
        on_message: impl FnMut(AsyncMessage) + Send + 'static,
    ) -> Result<(), String> {
        match self.config.get_ssl_mode() {
            SslMode::Disable => listen(&self.config, NoTls, statement, on_message).await,
            _ => listen(&self.config, tls().map_err(|error| error.to_string())?, statement, on_message).await,
        }
    }
}

async fn listen<T>(
    config: &Config,
    tls: T,
    statement: &str,
    on_message: impl FnMut(AsyncMessage) + Send + 'static,
) -> Result<(), String>
where
    T: MakeTlsConnect<Socket>,
    T::Stream: Send + 'static,
{
    let text = |error: tokio_postgres::Error| failure::text(&error);
    let (client, connection) = config.connect(tls).await.map_err(text)?;
    let driven = tokio::spawn(drive(connection, on_message));
    client.batch_execute(statement).await.map_err(text)?;
    // It ends with the connection; the client is kept until then.
    driven.await.map_err(|error| error.to_string())?.map_err(text)?;
    drop(client);
    Ok(())
}

async fn drive<S>(
    mut connection: Connection<Socket, S>,
    mut on_message: impl FnMut(AsyncMessage),
) -> Result<(), tokio_postgres::Error>
where
    S: tokio::io::AsyncRead + tokio::io::AsyncWrite + Unpin,
{
    while let Some(message) = std::future::poll_fn(|context| connection.poll_message(context)).await {
        on_message(message?);
    }
    Ok(())
}

/// TLS with the system's certificates, or those of `SSL_CERT_FILE`.
fn tls() -> Result<MakeRustlsConnect, DatabaseOpenError> {
    let mut roots = rustls::RootCertStore::empty();
    roots.add_parsable_certificates(rustls_native_certs::load_native_certs().certs);
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
mod tests {
    use super::*;

    #[test]
    fn a_url_whose_password_would_show_is_refused() {
        for url in ["://me:a@b@host/name", "://me:a/b@host/name", "://me:a?b@host/name", "://me:a#b@host/name"] {
            assert!(has_stray_at(&format!("postgres{url}")), "{url}");
        }
        for url in ["postgres://me:a%40b@host/name?sslmode=disable", "postgres://host/name", "host=h user=a@b"] {
            assert!(!has_stray_at(url), "{url}");
        }
        let error = Database::open("postgres://me:hunter2@more@host/name").unwrap_err().to_string();
        assert!(error.contains("%40") && !error.contains("more"), "{error}");
    }
}
