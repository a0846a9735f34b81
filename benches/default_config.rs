//! The configuration of a service in a bench.

use std::{path::Path, time::Duration};

use ltcforge::{files::recipe_document::DEFAULT_ENTRY_LIMIT, server::service::Config, view::preview::Adapter};

/// A service in `folder` with `workers` workers. Benches do not reach its limits.
pub fn config(folder: &Path, workers: usize) -> Config {
    Config {
        data_dir: folder.to_owned(),
        workers,
        queue_limit: 64,
        entry_limit: DEFAULT_ENTRY_LIMIT,
        job_seconds: 86_400,
        keep_ended: None,
        store_bytes: None,
        lease_ttl: Duration::from_secs(60),
        adapter: Adapter::Cpu,
        picture_time: Duration::from_secs(30),
        brdf_limit: 16,
    }
}
