//! The configuration of a service that a bench starts.

use std::{num::NonZeroUsize, path::Path, time::Duration};

use ltcforge::{
    files::recipe_document::DEFAULT_ENTRY_LIMIT,
    server::service::{Config, PictureLimits},
    view::preview::Adapter,
};

/// A service in a folder with so many workers; nothing of it ends within the bench.
pub fn config(folder: &Path, workers: NonZeroUsize) -> Config {
    Config {
        data_dir: folder.to_owned(),
        workers,
        queue_limit: 64,
        entry_limit: DEFAULT_ENTRY_LIMIT,
        job_seconds: 86_400,
        keep_ended: None,
        most_ended: None,
        store_bytes: None,
        unused_for: Duration::from_secs(600),
        lease_ttl: Duration::from_secs(60),
        max_attempts: 3,
        adapter: Adapter::Cpu,
        export_bytes: 0,
        brdf_limit: 16,
        light_texture_limit: 16,
        pictures: PictureLimits::default(),
    }
}
