//! `work`, `gc` and `migrate`: what processes do that share a database and a store of tables.

use std::num::NonZeroU64;

use serde_json::json;

use super::{
    CommandFailure, Context, Exit,
    args::{GcArgs, MigrateArgs, ReplicaArgs, SharedArgs, WorkArgs},
    config_file::ServeSection,
    print,
    service_settings::{default_config, failed, lease_ttl},
};
use ltcforge_server::service::{self, Config, Service, Shared};

/// Megabytes of tables kept on disk, unless it is said.
const DEFAULT_CACHE_MB: u64 = 4096;

fn shared(args: SharedArgs) -> Shared {
    let cache_bytes = args.cache_mb.map_or(DEFAULT_CACHE_MB, NonZeroU64::get).saturating_mul(1 << 20);
    Shared { database: args.database, blobs: args.blobs, cache_bytes }
}

/// What a replica shares; `None` for a service on a folder of its own.
pub(super) fn replica(args: &ReplicaArgs) -> Option<Shared> {
    let (database, blobs) = (args.database.clone()?, args.blobs.clone()?);
    Some(shared(SharedArgs { database, blobs, cache_mb: args.cache_mb }))
}

/// The configuration of a process that shares.
pub(super) fn shared_config(config: Config, lease_seconds: Option<NonZeroU64>) -> Config {
    Config { lease_ttl: lease_ttl(lease_seconds), ..config }
}

/// Fits what the queue has until it is interrupted.
pub(super) fn work(
    args: WorkArgs,
    file: &ServeSection,
    json: bool,
    context: &mut Context<'_>,
) -> Result<Exit, CommandFailure> {
    let mut config = default_config(args.data.or_else(|| file.data.clone()));
    config.workers = args.workers.or(file.workers).unwrap_or(config.workers);
    let config = shared_config(config, args.lease_seconds);
    let (workers, runtime, shared) = (config.workers, context.runtime.clone(), shared(args.shared));
    runtime.block_on(async {
        let opened = tokio::task::spawn_blocking(move || Service::open_shared(config, &shared, true)).await;
        let service = opened.map_err(failed)?.map_err(failed)?;
        print(context.stdout, json, &json!({ "working": workers }), &format!("working with {workers} threads"))?;
        context.interrupt.clone().wait().await;
        tokio::task::spawn_blocking(move || service.stop()).await.map_err(failed)?;
        Ok(Exit::Ok)
    })
}

/// Removes tables that no job has made known for a day.
pub(super) fn gc(
    args: GcArgs,
    file: &ServeSection,
    json: bool,
    context: &mut Context<'_>,
) -> Result<Exit, CommandFailure> {
    let config = default_config(args.data.or_else(|| file.data.clone()));
    let removed = service::sweep(&config, &shared(args.shared)).map_err(failed)?;
    print(context.stdout, json, &json!({ "removed": removed }), &format!("{removed} orphans were removed"))?;
    Ok(Exit::Ok)
}

/// Takes a data folder's tables and jobs along.
pub(super) fn migrate(
    args: MigrateArgs,
    file: &ServeSection,
    json: bool,
    context: &mut Context<'_>,
) -> Result<Exit, CommandFailure> {
    let config = default_config(args.data.or_else(|| file.data.clone()));
    let shared = shared(SharedArgs { database: args.to, blobs: args.blobs, cache_mb: None });
    let done = service::migrate(&config, &shared).map_err(failed)?;
    let service::Migrated { tables, missing, jobs, shards } = done;
    let text = format!(
        "{tables} tables and {jobs} jobs with {shards} finished shards were taken along; {missing} tables have no sound file"
    );
    print(context.stdout, json, &json!(done), &text)?;
    Ok(if missing == 0 { Exit::Ok } else { Exit::Mismatch })
}
