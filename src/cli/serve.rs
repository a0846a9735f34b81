//! `serve`: open the store, listen, stop gracefully.

use std::{
    io,
    net::SocketAddr,
    num::{NonZeroU64, NonZeroUsize},
    sync::Arc,
    time::Duration,
};

use serde_json::json;
use tokio::net::TcpListener;

use super::{
    CommandFailure, Context, Exit,
    args::{PictureLimitArgs, ServeArgs, WaitSeconds, cores},
    config_file::ServeSection,
    connections, print,
    service_settings::{
        DEFAULT_DATA, DEFAULT_EXPORT_BYTES, DEFAULT_JOB_DAYS, DEFAULT_JOB_SECONDS, DEFAULT_QUEUE_LIMIT, LEASE_TTL,
        MAX_ATTEMPTS, failed,
    },
};
use ltcforge_files::recipe_document::DEFAULT_ENTRY_LIMIT;
use ltcforge_server::{
    http,
    service::{Config, PictureLimits, Service},
};
use ltcforge_view::preview::Adapter;

const DEFAULT_LISTEN: SocketAddr = SocketAddr::new(std::net::IpAddr::V4(std::net::Ipv4Addr::LOCALHOST), 8317);

/// Runs the service until it is interrupted.
pub(super) fn run(
    args: ServeArgs,
    file: ServeSection,
    json: bool,
    context: &mut Context<'_>,
) -> Result<Exit, CommandFailure> {
    let options = connections::settle(args.connections.clone(), &file, connections::raise_descriptor_limit());
    let (options, open) = {
        let replica = &args.replica;
        let (shared, works, seconds) = (super::cluster::replica(replica), !replica.no_workers, replica.lease_seconds);
        let open = move |config| match &shared {
            Some(shared) => Service::open_shared(super::cluster::shared_config(config, seconds), shared, works),
            None => Service::open(config),
        };
        (http::Options { redirects: replica.redirect, ..options }, open)
    };
    let (listen, config) = settle(args, file);
    let runtime = context.runtime.clone();
    runtime.block_on(async {
        let listener = TcpListener::bind(listen).await.map_err(|error| cannot_listen(listen, &error))?;
        let address = listener.local_addr().map_err(|error| cannot_listen(listen, &error))?;
        let opened = tokio::task::spawn_blocking(move || open(config)).await;
        let service = opened.map_err(failed)?.map_err(failed)?;
        let url = format!("http://{address}");
        print(context.stdout, json, &json!({ "listening": url }), &format!("listening on {url}"))?;
        http::serve(listener, Arc::clone(&service), options, context.interrupt.clone().wait()).await;
        tokio::task::spawn_blocking(move || service.stop()).await.map_err(failed)?;
        Ok(Exit::Ok)
    })
}

/// The settings: flags and environment go before the file, that before the defaults.
fn settle(args: ServeArgs, file: ServeSection) -> (SocketAddr, Config) {
    let pictures = pictures(&args.pictures, &file);
    let config = Config {
        data_dir: args.data.or(file.data).unwrap_or_else(|| DEFAULT_DATA.into()),
        workers: args.workers.or(file.workers).unwrap_or_else(cores),
        queue_limit: args.queue_limit.or(file.queue_limit).map_or(DEFAULT_QUEUE_LIMIT, NonZeroUsize::get),
        entry_limit: args.entry_limit.or(file.entry_limit).map_or(DEFAULT_ENTRY_LIMIT, NonZeroU64::get),
        job_seconds: args.job_seconds.or(file.job_seconds).map_or(DEFAULT_JOB_SECONDS, NonZeroU64::get),
        keep_ended: keep_ended(args.job_days.or(file.job_days).unwrap_or(DEFAULT_JOB_DAYS)),
        lease_ttl: LEASE_TTL,
        max_attempts: MAX_ATTEMPTS,
        adapter: args.adapter.or(file.adapter).map_or(Adapter::Any, |name| name.0),
        pictures,
        export_bytes: args.export_bytes.or(file.export_bytes).unwrap_or(DEFAULT_EXPORT_BYTES),
    };
    (args.listen.or(file.listen).unwrap_or(DEFAULT_LISTEN), config)
}

/// The limits of pictures, likewise.
fn pictures(args: &PictureLimitArgs, file: &ServeSection) -> PictureLimits {
    let default = PictureLimits::default();
    let memory_mib = args.picture_memory.or(file.picture_memory);
    PictureLimits {
        time: args.picture_seconds.or(file.picture_seconds).map_or(default.time, WaitSeconds::duration),
        queue: args.picture_queue.or(file.picture_queue).unwrap_or(default.queue),
        memory_bytes: memory_mib.map_or(default.memory_bytes, |mib| (mib as usize).saturating_mul(1 << 20)),
    }
}

fn keep_ended(days: u32) -> Option<Duration> {
    (days > 0).then(|| Duration::from_secs(u64::from(days) * 86_400))
}

fn cannot_listen(listen: SocketAddr, error: &io::Error) -> CommandFailure {
    let reason = match error.kind() {
        io::ErrorKind::AddrInUse => "the port is taken".to_owned(),
        _ => error.to_string(),
    };
    CommandFailure::new(Exit::Failed, format!("cannot listen on {listen}: {reason}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{args::ConnectionArgs, preview_names::AdapterName};

    fn nothing() -> ServeArgs {
        ServeArgs {
            listen: None,
            data: None,
            workers: None,
            queue_limit: None,
            entry_limit: None,
            job_seconds: None,
            job_days: None,
            export_bytes: None,
            adapter: None,
            pictures: PictureLimitArgs::default(),
            connections: ConnectionArgs::default(),
            replica: crate::args::ReplicaArgs::default(),
        }
    }

    #[test]
    fn a_flag_goes_before_the_file_and_that_before_the_default() {
        let adapter = Some(AdapterName(Adapter::Cpu));
        let (data, queue_limit) = (Some("file".into()), NonZeroUsize::new(5));
        let file = ServeSection { data, queue_limit, adapter, ..Default::default() };
        let flags = ServeArgs { data: Some("flag".into()), ..nothing() };
        let (listen, config) = settle(flags, file);
        assert_eq!(config.data_dir.to_str(), Some("flag"));
        assert_eq!(config.queue_limit, 5);
        assert_eq!(config.adapter, Adapter::Cpu);
        assert_eq!(config.keep_ended, Some(Duration::from_secs(90 * 86_400)));
        assert_eq!(config.entry_limit, DEFAULT_ENTRY_LIMIT);
        assert_eq!(listen, DEFAULT_LISTEN);
    }

    #[test]
    fn pictures_have_limits_that_flags_and_the_file_set() {
        assert_eq!(settle(nothing(), ServeSection::default()).1.pictures, PictureLimits::default());
        let file = ServeSection {
            picture_seconds: "60".parse().ok(),
            picture_queue: NonZeroUsize::new(3),
            picture_memory: Some(0),
            ..Default::default()
        };
        let flags = PictureLimitArgs { picture_seconds: "5".parse().ok(), ..PictureLimitArgs::default() };
        let set = settle(ServeArgs { pictures: flags, ..nothing() }, file).1.pictures;
        assert_eq!((set.time, set.queue.get(), set.memory_bytes), (Duration::from_secs(5), 3, 0));
    }

    #[test]
    fn zero_days_keep_jobs_for_good() {
        let file = ServeSection { job_days: Some(7), ..Default::default() };
        assert_eq!(settle(nothing(), file.clone()).1.keep_ended, Some(Duration::from_secs(7 * 86_400)));
        assert_eq!(settle(ServeArgs { job_days: Some(0), ..nothing() }, file).1.keep_ended, None);
    }

    #[test]
    fn a_taken_port_is_named() {
        let refused = cannot_listen(DEFAULT_LISTEN, &io::ErrorKind::AddrInUse.into());
        assert_eq!(refused.message, "cannot listen on 127.0.0.1:8317: the port is taken");
    }
}
