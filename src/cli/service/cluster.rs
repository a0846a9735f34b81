//! `work`, `gc` and `migrate`: commands on a database and a store of tables that several processes share.

use std::{
    net::SocketAddr,
    num::{NonZeroU64, NonZeroUsize},
    path::PathBuf,
    sync::Arc,
    time::Duration,
};

use serde_json::json;

use super::{
    CommandFailure, Context, Exit,
    args::{GcArgs, MigrateArgs, ReplicaArgs, SharedArgs, TimeoutArgs, WorkArgs},
    descriptors::raise_descriptor_limit,
    print,
    serve::failed,
    settings::ServeSettings,
};
use crate::args::threads::{ThreadCount, UpTo};
use ltcforge_server::{
    http,
    service::{
        self, Config, DatabaseTimeouts, DatabaseUrl, Going, REPLICA_CONNECTIONS, Removal, Service, Shared, Swept,
        WORKER_CONNECTIONS,
    },
};
use ltcforge_view::preview::Adapter;

/// Megabytes of tables that are kept on disk by default.
const DEFAULT_CACHE_MB: u64 = 4096;

fn shared(
    database: DatabaseUrl,
    blobs: String,
    cache_mb: Option<NonZeroU64>,
    connections: NonZeroUsize,
    timeouts: DatabaseTimeouts,
) -> Shared {
    let cache_bytes = cache_mb.map_or(DEFAULT_CACHE_MB, NonZeroU64::get).saturating_mul(1 << 20);
    Shared { database, blobs, cache_bytes, connections, timeouts }
}

/// The database and store of a command that looks at all rows and blobs, without time limits.
pub(super) fn shared_for_all(database: DatabaseUrl, blobs: String) -> Shared {
    shared(database, blobs, None, WORKER_CONNECTIONS, DatabaseTimeouts::NONE)
}

impl TimeoutArgs {
    fn timeouts(&self) -> DatabaseTimeouts {
        let default = DatabaseTimeouts::default();
        let of = |seconds: Option<u32>, default| match seconds {
            Some(0) => None,
            Some(seconds) => Some(Duration::from_secs(seconds.into())),
            None => default,
        };
        DatabaseTimeouts {
            statement: of(self.statement_seconds, default.statement),
            idle_in_transaction: of(self.idle_transaction_seconds, default.idle_in_transaction),
        }
    }
}

/// The database and store that a replica shares; `None` for a service on a folder of its own.
pub(super) fn replica(args: &ReplicaArgs) -> Option<Shared> {
    let connections = args.database_connections.map_or(REPLICA_CONNECTIONS, UpTo::count);
    Some(shared(args.database.clone()?, args.blobs.clone()?, args.cache_mb, connections, args.timeouts.timeouts()))
}

/// The result of `opening`, which waits where the database has no room; `None` if the process is interrupted meanwhile.
pub(super) async fn unless_interrupted<T>(opening: impl Future<Output = T>, context: &Context<'_>) -> Option<T> {
    tokio::select! {
        opened = opening => Some(opened),
        () = context.interrupt.clone().wait() => None,
    }
}

/// The configuration of a process that shares.
pub(super) fn shared_config(config: Config, lease_seconds: Option<NonZeroU64>) -> Config {
    let lease_ttl = lease_seconds.map_or(config.lease_ttl, |seconds| Duration::from_secs(seconds.get()));
    Config { lease_ttl, ..config }
}

/// The configuration of a process without HTTP, which neither renders nor forgets jobs.
pub(super) fn without_http(data: Option<PathBuf>, file: &ServeSettings) -> Config {
    let config = file.config();
    Config {
        data_dir: data.unwrap_or(config.data_dir),
        keep_ended: None,
        most_ended: None,
        store_bytes: None,
        adapter: Adapter::Cpu,
        ..config
    }
}

/// What a worker answers at `listen`.
fn worker_http(
    listen: SocketAddr,
    args: &WorkArgs,
    file: &ServeSettings,
) -> Result<(SocketAddr, http::Options), CommandFailure> {
    let tokens = args.tokens.clone().or_else(|| file.tokens.clone());
    let allow_anyone = args.allow_anyone.then_some(true).or(file.allow_anyone);
    let token_list = args.token_list.clone().or_else(|| file.token_list.clone());
    let settings = ServeSettings { listen, tokens, token_list, allow_anyone, ..file.clone() };
    raise_descriptor_limit();
    let tokens = settings.tokens()?;
    Ok((listen, http::Options { tokens, only_operations: true, ..http::Options::default() }))
}

/// Fits the shards of the queue until it is interrupted.
pub(super) fn work(
    args: WorkArgs,
    file: &ServeSettings,
    json: bool,
    context: &mut Context<'_>,
) -> Result<Exit, CommandFailure> {
    let options = args.listen.map(|listen| worker_http(listen, &args, file)).transpose()?;
    let SharedArgs { database, blobs, cache_mb, data, database_connections, timeouts } = args.shared;
    let connections = database_connections.map_or(WORKER_CONNECTIONS, UpTo::count);
    let mut config = shared_config(without_http(data, file), args.lease_seconds);
    config.workers = args.workers.map_or(config.workers, ThreadCount::count);
    let (workers, runtime, shared) =
        (config.workers, context.runtime.clone(), shared(database, blobs, cache_mb, connections, timeouts.timeouts()));
    runtime.block_on(async {
        let listening = match options {
            Some((listen, options)) => Some((super::serve::listen(listen).await?, options)),
            None => None,
        };
        let opening = tokio::task::spawn_blocking(move || Service::open_shared(config, &shared, true));
        let Some(opened) = unless_interrupted(opening, context).await else { return Ok(Exit::Ok) };
        let service = opened.map_err(failed)?.map_err(failed)?;
        let text = format!("working with {workers} threads");
        let interrupt = context.interrupt.clone().wait();
        match listening {
            None => {
                print(context.stdout, json, &json!({ "working": workers }), &text)?;
                interrupt.await;
            }
            Some(((listener, address), options)) => {
                let url = format!("http://{address}");
                let said = json!({ "working": workers, "listening": url });
                print(context.stdout, json, &said, &format!("{text}, listening on {url}"))?;
                http::serve(listener, Arc::clone(&service), options, interrupt).await.map_err(failed)?;
            }
        }
        tokio::task::spawn_blocking(move || service.stop()).await.map_err(failed)?;
        Ok(Exit::Ok)
    })
}

/// Tells the files that go from a store, and removes them if it is told to.
pub(super) fn gc(
    args: GcArgs,
    file: &ServeSettings,
    json: bool,
    context: &mut Context<'_>,
) -> Result<Exit, CommandFailure> {
    let GcArgs { database, blobs, data, store_bytes, delete, even_most, dry_run: _ } = args;
    let removal = match (delete, even_most) {
        (false, _) => Removal::Nothing,
        (true, false) => Removal::Going,
        (true, true) => Removal::EvenMost,
    };
    let store_bytes = store_bytes.or(file.store_bytes).map(NonZeroU64::get);
    let config = Config { store_bytes, ..without_http(data, file) };
    let swept = match database.zip(blobs) {
        Some((database, blobs)) => service::sweep(&config, &shared_for_all(database, blobs), removal),
        None => service::sweep_folder(&config, removal),
    };
    let swept = swept.map_err(failed)?;
    let Swept { files, bytes, going, kept, removed } = &swept;
    let line = |going: &Going| {
        format!("{} {} bytes, last used {}: {}", going.digest, going.bytes, going.used_at, going.reason.text())
    };
    let mut lines: Vec<String> = going.iter().map(line).collect();
    let (count, gone) = (going.len(), going.iter().map(|going| going.bytes).sum::<u64>());
    lines.push(match removal {
        Removal::Nothing if count == 0 => format!("none of {files} files, {bytes} bytes, would go"),
        Removal::Nothing => {
            format!("{count} of {files} files, {gone} of {bytes} bytes, would go; `--delete` removes them")
        }
        Removal::Going | Removal::EvenMost => format!("{removed} of {count} files that were to go were removed"),
    });
    if let (Some(limit), false) = (store_bytes, kept.is_empty()) {
        lines.push(format!(
            "the store stays larger than --store-bytes, by {} bytes",
            (bytes - gone).saturating_sub(limit)
        ));
        lines.extend(kept.iter().map(ToString::to_string));
    }
    print(context.stdout, json, &json!(swept), &lines.join("\n"))?;
    Ok(Exit::Ok)
}

/// Copies the tables and jobs of a data folder.
pub(super) fn migrate(
    args: MigrateArgs,
    file: &ServeSettings,
    json: bool,
    context: &mut Context<'_>,
) -> Result<Exit, CommandFailure> {
    let done =
        service::migrate(&without_http(args.data, file), &shared_for_all(args.to, args.blobs)).map_err(failed)?;
    let service::Migrated { tables, missing, jobs, shards } = done;
    let text = format!(
        "{tables} tables and {jobs} jobs with {shards} finished shards were taken along; \
         {missing} tables have no sound file"
    );
    print(context.stdout, json, &json!(done), &text)?;
    Ok(if missing == 0 { Exit::Ok } else { Exit::Mismatch })
}

#[cfg(test)]
mod tests {
    use super::DEFAULT_CACHE_MB;

    /// The first number behind `key`.
    fn number(text: &str, key: &str) -> Option<u64> {
        let digits = text.split_once(key)?.1.trim_start_matches(|c: char| !c.is_ascii_digit());
        digits.split(|c: char| !c.is_ascii_digit()).next()?.parse().ok()
    }

    /// A file of `deploy/`.
    fn read(name: &str) -> String {
        let path = format!("{}/../../deploy/{name}", env!("CARGO_MANIFEST_DIR"));
        std::fs::read_to_string(path).expect("a file of the project")
    }

    /// Neither a copy that is made at the start, nor a variable, nor a mount of the file alone.
    #[test]
    fn deploy_hands_tokens_over_as_a_file_that_follows_changes() {
        let unit = read("systemd/ltcforge.service");
        assert!(unit.contains("\nEnvironment=LTCFORGE_TOKENS=/etc/ltcforge/tokens\n"));
        assert!(unit.contains("\nSupplementaryGroups=") && !unit.contains("\nLoadCredential"));
        let pods = read("kubernetes/ltcforge.yaml");
        assert!(pods.contains("LTCFORGE_TOKENS: /etc/ltcforge/tokens"));
        let mounted = pods.matches("{ name: tokens, mountPath: /etc/ltcforge, readOnly: true }").count();
        assert_eq!((mounted, pods.matches("subPath:").count(), pods.matches("LTCFORGE_TOKEN_LIST").count()), (2, 0, 0));
    }

    /// An eighth stays free for files that are being written.
    #[test]
    fn the_caches_of_deploy_fit_their_disks() {
        for (file, size) in [("compose.yaml", "/data:uid=10001,size="), ("kubernetes/ltcforge.yaml", "sizeLimit:")] {
            let text = read(file);
            let gib = number(&text, size).expect("the size of the folder in GiB");
            assert!(["g", "Gi"].iter().any(|unit| text.contains(&format!("{gib}{unit}"))), "{file}");
            let cache_mb = number(&text, "LTCFORGE_CACHE_MB").unwrap_or(DEFAULT_CACHE_MB);
            assert!(cache_mb * 8 <= gib * 1024 * 7, "{file}: {cache_mb} of {gib} GiB");
        }
    }
}
