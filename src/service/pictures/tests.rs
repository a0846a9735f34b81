use std::{num::NonZeroUsize, path::Path};

use super::*;
use crate::{
    plots::Plot,
    preview::Adapter,
    service::{Config, ServiceError},
};

/// A service that has one blob, which is no table.
fn start(folder: &Path, picture_limit: Duration) -> (Arc<Service>, Digest) {
    let service = Service::open(Config {
        data_dir: folder.to_owned(),
        workers: NonZeroUsize::MIN,
        queue_limit: 1,
        entry_limit: 100,
        lease_ttl: Duration::from_secs(60),
        max_attempts: 1,
        adapter: Adapter::Cpu,
        picture_limit,
    });
    let service = service.expect("a service");
    let digest = service.core.store.blobs.put(b"no table").expect("a blob");
    (service, digest)
}

fn draw(service: &Service, table: Digest) -> PictureError {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_time().build().expect("a runtime");
    let ordered = service.picture(Some(table), Subject::Plot(Plot::Matrix), |_| false).expect("an order");
    let Ordered::Waiting(wait) = ordered else { panic!("it was never drawn: {ordered:?}") };
    runtime.block_on(wait.file()).expect_err("no picture")
}

#[test]
fn a_picture_that_is_not_there_in_time_is_given_up() {
    let folder = tempfile::tempdir().expect("a folder");
    let (service, digest) = start(folder.path(), Duration::ZERO);
    let error = draw(&service, digest);
    assert!(matches!(error, PictureError::TooSlow { limit: Duration::ZERO, retry_after: RETRY_SLOW }), "{error:?}");
    service.stop();
    let closed = service.picture(Some(digest), Subject::Plot(Plot::Matrix), |_| false);
    assert!(matches!(closed, Err(PictureError::Stopping)), "{closed:?}");
}

#[test]
fn a_blob_that_is_no_table_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let (service, digest) = start(folder.path(), Duration::from_secs(60));
    let error = draw(&service, digest);
    assert!(matches!(error, PictureError::Store(ServiceError::Storage(_))), "{error:?}");
    assert!(error.to_string().contains(&digest.to_string()), "{error}");
}
