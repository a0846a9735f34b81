//! What the processes of a service are set to unless it is said otherwise.

use std::time::Duration;

use super::{CommandFailure, Exit};
use crate::args::cores;
use ltcforge_files::recipe_document::DEFAULT_ENTRY_LIMIT;
use ltcforge_server::service::{Config, PictureLimits};
use ltcforge_view::preview::Adapter;

pub(super) const DEFAULT_DATA: &str = "ltcforge-data";
pub(super) const DEFAULT_QUEUE_LIMIT: usize = 64;
/// A day.
pub(super) const DEFAULT_JOB_SECONDS: u64 = 86_400;
pub(super) const DEFAULT_JOB_DAYS: u32 = 90;
/// A worker renews its lease several times a second.
pub(super) const LEASE_TTL: Duration = Duration::from_secs(60);
pub(super) const MAX_ATTEMPTS: u32 = 3;
pub(super) const DEFAULT_EXPORT_BYTES: usize = 256 << 20;

/// The settings of a process that has no flags for them.
pub(super) fn default_config(data: Option<std::path::PathBuf>) -> Config {
    Config {
        data_dir: data.unwrap_or_else(|| DEFAULT_DATA.into()),
        workers: cores(),
        queue_limit: DEFAULT_QUEUE_LIMIT,
        entry_limit: DEFAULT_ENTRY_LIMIT,
        job_seconds: DEFAULT_JOB_SECONDS,
        keep_ended: None,
        lease_ttl: LEASE_TTL,
        max_attempts: MAX_ATTEMPTS,
        adapter: Adapter::Cpu,
        pictures: PictureLimits::default(),
        export_bytes: DEFAULT_EXPORT_BYTES,
    }
}

/// How long a lease lasts.
pub(super) fn lease_ttl(seconds: Option<std::num::NonZeroU64>) -> Duration {
    seconds.map_or(LEASE_TTL, |seconds| Duration::from_secs(seconds.get()))
}

pub(super) fn failed(error: impl std::fmt::Display) -> CommandFailure {
    CommandFailure::new(Exit::Failed, error.to_string())
}
