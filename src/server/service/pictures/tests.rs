use std::{
    num::NonZeroUsize,
    ops::ControlFlow,
    path::Path,
    sync::Arc,
    time::{Duration, Instant},
};

use super::*;
use crate::{
    files::{container, digest::Digest, recipe_document},
    fit::{Plan, assemble, fit_shard},
    server::service::{Config, Service, ServiceError},
    view::{
        plots::Plot,
        preview::{Adapter, Scene},
    },
};

/// A service with one blob, which is not a table.
fn start(folder: &Path, picture_limit: Duration) -> (Arc<Service>, Digest) {
    let service = Service::open(Config {
        data_dir: folder.to_owned(),
        workers: NonZeroUsize::MIN,
        queue_limit: 1,
        entry_limit: 100,
        job_seconds: 86_400,
        lease_ttl: Duration::from_secs(60),
        max_attempts: 1,
        adapter: Adapter::Cpu,
        picture_limit,
    });
    let service = service.expect("a service");
    let digest = service.state.tables.store.blobs.put(b"no table").expect("a blob");
    (service, digest)
}

/// A service with a table.
fn start_with_table(folder: &Path) -> (Arc<Service>, Digest) {
    let (service, _) = start(folder, Duration::from_secs(60));
    let recipe = r#"{"preset": "draft", "resolution": {"alpha": 2, "ratio": 2, "theta": 2, "phi": 2},
        "fit": {"samples": 64, "directions": 4, "steps": 1}}"#;
    let recipe = recipe_document::parse(recipe.as_bytes(), 100).expect("a recipe");
    let plan = Plan::new(&recipe);
    let go_on = &mut |_: u64| ControlFlow::Continue(());
    let entries = fit_shard(&plan, 0, go_on).expect("not interrupted");
    let file = container::encode(&recipe, &assemble(&plan, &entries)).expect("a file");
    let digest = service.state.tables.store.blobs.put(&file).expect("a blob");
    (service, digest)
}

#[test]
fn no_thread_runs_before_the_first_picture_and_none_is_rendered_twice() {
    let folder = tempfile::tempdir().expect("a folder");
    let (service, table) = start_with_table(folder.path());
    assert!(!service.state.pictures.queue().thread_runs(), "no picture was requested");
    let scene = || Subject::Scene(Box::new(Scene { size: 64, ..Scene::default() }));
    let request = |is_known: bool| service.picture(Some(table), scene(), |_| is_known).expect("a reply");

    let PictureReply::Pending(pending) = request(false) else { panic!("it was never rendered") };
    let runtime = tokio::runtime::Builder::new_current_thread().enable_time().build().expect("a runtime");
    let first = runtime.block_on(pending.file()).expect("a picture");
    assert!(service.state.pictures.queue().thread_runs());
    let PictureReply::Ready(again) = request(false) else { panic!("it is in memory") };
    assert!(Arc::ptr_eq(&again.png, &first.png) && again.tag == first.tag);
    let PictureReply::Known { tag, .. } = request(true) else { panic!("the caller has it") };
    assert_eq!(tag, first.tag);
    // The caller has a picture that is not in memory. The adapter is known by now, so its tag is too.
    let other = Subject::Scene(Box::new(Scene { size: 65, ..Scene::default() }));
    let other = service.picture(Some(table), other, |_| true).expect("a reply");
    assert!(matches!(other, PictureReply::Known { .. }), "{other:?}");
    assert_eq!(service.state.pictures.counts().done, 1);
}

#[test]
fn a_render_thread_that_hangs_is_replaced() {
    let folder = tempfile::tempdir().expect("a folder");
    let (service, table) = start_with_table(folder.path());
    let long_ago = Instant::now().checked_sub(Duration::from_secs(60)).expect("a machine that is up for a minute");
    service.state.pictures.queue().simulate_rendering(Some(long_ago));
    let scene = Subject::Scene(Box::new(Scene { size: 64, ..Scene::default() }));
    let PictureReply::Pending(pending) = service.picture(Some(table), scene, |_| false).expect("a reply") else {
        panic!("it was never rendered")
    };
    let runtime = tokio::runtime::Builder::new_current_thread().enable_time().build().expect("a runtime");
    runtime.block_on(pending.file()).expect("a picture");
    let counts = service.state.pictures.counts();
    assert_eq!((counts.done, counts.given_up), (1, 1));
}

#[test]
fn equal_requests_take_one_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let (service, table) = start_with_table(folder.path());
    service.state.pictures.queue().simulate_rendering(Some(Instant::now() + Duration::from_secs(60)));
    let request = |size: u32| {
        let scene = Subject::Scene(Box::new(Scene { size, ..Scene::default() }));
        service.picture(Some(table), scene, |_| false)
    };
    // One is rendered and eight may wait.
    let same: Vec<_> = (0..20).map(|_| request(64)).collect();
    assert!(same.iter().all(Result::is_ok), "{same:?}");
    let others: Vec<_> = (65..72).map(request).collect();
    assert!(others.iter().all(Result::is_ok), "{others:?}");
    assert!(matches!(request(72), Err(PictureError::QueueFull { .. })));
    assert!(request(64).is_ok());

    // All but the last of them withdraw: the picture is still wanted.
    let last = same.into_iter().last();
    assert!(matches!(request(73), Err(PictureError::QueueFull { .. })));
    drop(last);
    assert!(request(74).is_ok());
    // The end of the service would wait for a running thread.
    service.state.pictures.queue().simulate_rendering(None);
}

fn draw(service: &Service, table: Digest) -> PictureError {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_time().build().expect("a runtime");
    let reply = service.picture(Some(table), Subject::Plot(Plot::Matrix), |_| false).expect("a reply");
    let PictureReply::Pending(pending) = reply else { panic!("it was never drawn: {reply:?}") };
    runtime.block_on(pending.file()).expect_err("no picture")
}

#[test]
fn a_picture_that_is_not_ready_in_time_is_given_up() {
    let folder = tempfile::tempdir().expect("a folder");
    let (service, digest) = start(folder.path(), Duration::ZERO);
    let error = draw(&service, digest);
    assert!(matches!(error, PictureError::TooSlow { limit: Duration::ZERO, .. }), "{error:?}");
    service.stop();
    let closed = service.picture(Some(digest), Subject::Plot(Plot::Matrix), |_| false);
    assert!(matches!(closed, Err(PictureError::Stopping)), "{closed:?}");
}

#[test]
fn a_blob_that_is_not_a_table_is_an_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let (service, digest) = start(folder.path(), Duration::from_secs(60));
    let error = draw(&service, digest);
    assert!(matches!(error, PictureError::Store(ServiceError::Storage(_))), "{error:?}");
    assert!(error.to_string().contains(&digest.to_string()), "{error}");
}
