//! `work`: fits shards from a shared queue.

use std::{
    net::SocketAddr,
    num::{NonZeroU64, NonZeroUsize},
    path::PathBuf,
    sync::Arc,
};

use clap::Args;
use serde_json::json;

use super::{
    CommandFailure, Context, Exit, failed,
    replica::{lease_ttl, unless_interrupted},
    serve::listen,
    settings::ServeSettings,
};
use crate::values::ThreadCount;
use ltcforge_server::{
    http,
    service::{Config, DatabaseUrl, Service, Shared},
};
use ltcforge_view::preview::Adapter;

/// Database connections of a worker.
const WORKER_CONNECTIONS: NonZeroUsize = NonZeroUsize::new(3).unwrap();

/// `work`.
#[derive(Debug, Args)]
pub struct WorkArgs {
    /// PostgreSQL database of the queue
    #[arg(long, env = "LTCFORGE_DATABASE", hide_env_values = true, value_name = "URL")]
    pub database: DatabaseUrl,
    /// Object store: `s3://BUCKET/PREFIX`, `gs://`, `az://` or `file:///`
    #[arg(long, env = "LTCFORGE_BLOBS", value_name = "URL")]
    pub blobs: String,
    /// Shards to fit at the same time, 1 to 512 [default: one per core]
    #[arg(long, env = "LTCFORGE_WORKERS", value_name = "N")]
    pub workers: Option<ThreadCount>,
    /// Seconds until another worker takes over a silent worker's shard
    #[arg(long, env = "LTCFORGE_LEASE_SECONDS", value_name = "N")]
    pub lease_seconds: Option<NonZeroU64>,
    /// Address for /healthz, /readyz, /metrics and /version
    #[arg(long, env = "LTCFORGE_WORK_LISTEN", value_name = "ADDRESS")]
    pub listen: Option<SocketAddr>,
    /// Token file; requests to the --listen address need a token
    #[arg(long, env = "LTCFORGE_TOKENS", value_name = "FILE", requires = "listen")]
    pub tokens: Option<PathBuf>,
    /// Answer other machines without tokens
    #[arg(long, requires = "listen")]
    pub allow_anyone: bool,
}

/// Fits the shards of a shared queue until it is interrupted.
pub(super) fn work(args: WorkArgs, file: &ServeSettings, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let WorkArgs { database, blobs, workers, lease_seconds, listen: address, tokens, allow_anyone } = args;
    let config = file.config();
    let config = Config {
        workers: workers.map_or(config.workers, |workers| workers.count().get()),
        lease_ttl: lease_ttl(lease_seconds, &config),
        keep_ended: None,
        store_bytes: None,
        adapter: Adapter::Cpu,
        ..config
    };
    let http = address.map(|listen| {
        let allow_anyone = allow_anyone.then_some(true).or(file.allow_anyone);
        let tokens = tokens.or_else(|| file.tokens.clone());
        let (tls_certificate, tls_key) = (None, None);
        let settings = ServeSettings { listen, tokens, allow_anyone, tls_certificate, tls_key, ..file.clone() };
        Ok::<_, CommandFailure>((listen, http::Options { only_operations: true, ..settings.http()? }))
    });
    let http = http.transpose()?;
    let (workers, runtime) = (config.workers, context.runtime.clone());
    let shared = Shared { database, store: blobs, connections: WORKER_CONNECTIONS };
    runtime.block_on(async {
        let listening = match http {
            Some((address, options)) => Some((listen(address).await?, options)),
            None => None,
        };
        let opening = tokio::task::spawn_blocking(move || Service::open_shared(config, &shared));
        let Some(opened) = unless_interrupted(opening, context).await else { return Ok(Exit::Ok) };
        let service = opened.map_err(failed)?.map_err(failed)?;
        let text = format!("working with {workers} threads");
        let interrupt = context.interrupt.clone().wait();
        match listening {
            None => {
                context.print(&json!({ "working": workers }), &text)?;
                interrupt.await;
            }
            Some(((listener, address), options)) => {
                let url = format!("http://{address}");
                let answer = json!({ "working": workers, "listening": url });
                context.print(&answer, &format!("{text}, listening on {url}"))?;
                http::serve(listener, Arc::clone(&service), options, interrupt).await.map_err(failed)?;
            }
        }
        tokio::task::spawn_blocking(move || service.stop()).await.map_err(failed)?;
        Ok(Exit::Ok)
    })
}
