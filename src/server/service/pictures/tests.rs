use std::{num::NonZeroUsize, ops::ControlFlow, path::Path};

use super::*;
use crate::{
    files::{export, recipe},
    fit::{Plan, assemble, fit_shard},
    server::service::{Config, ServiceError},
    view::{
        plots::Plot,
        preview::{Adapter, Scene},
    },
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

/// A service that has a table.
fn start_with_table(folder: &Path) -> (Arc<Service>, Digest) {
    let (service, _) = start(folder, Duration::from_secs(60));
    let recipe = r#"{"preset": "draft", "resolution": {"alpha": 2, "ratio": 2, "theta": 2, "phi": 2},
        "fit": {"samples": 64, "directions": 4, "steps": 1}}"#;
    let recipe = recipe::parse(recipe.as_bytes(), 100).expect("a recipe");
    let plan = Plan::new(&recipe);
    let go_on = &mut |_: u64| ControlFlow::Continue(());
    let entries = fit_shard(&plan, 0, go_on).expect("not interrupted");
    let file = export::encode(&recipe, &assemble(&plan, &entries)).expect("a file");
    let digest = service.core.store.blobs.put(&file).expect("a blob");
    (service, digest)
}

#[test]
fn nothing_is_opened_before_the_first_picture_and_none_is_made_twice() {
    let folder = tempfile::tempdir().expect("a folder");
    let (service, table) = start_with_table(folder.path());
    assert!(service.core.desk.is_at_rest(), "no picture was ordered");
    let scene = || Subject::Scene(Box::new(Scene { size: 64, ..Scene::default() }));
    let order = |is_known: bool| service.picture(Some(table), scene(), |_| is_known).expect("an order");

    let Ordered::Waiting(wait) = order(false) else { panic!("it was never rendered") };
    let runtime = tokio::runtime::Builder::new_current_thread().enable_time().build().expect("a runtime");
    let first = runtime.block_on(wait.file()).expect("a picture");
    assert!(!service.core.desk.is_at_rest());
    let Ordered::Ready(again) = order(false) else { panic!("it was kept") };
    assert!(Arc::ptr_eq(&again.png, &first.png) && again.tag == first.tag);
    let Ordered::Known { tag, .. } = order(true) else { panic!("the caller has it") };
    assert_eq!(tag, first.tag);
    // A picture that was not kept but that the caller has, too: what renders is known by now.
    let other = Subject::Scene(Box::new(Scene { size: 65, ..Scene::default() }));
    let other = service.picture(Some(table), other, |_| true).expect("an order");
    assert!(matches!(other, Ordered::Known { .. }), "{other:?}");
    assert_eq!(service.core.desk.counts().done, 1);
}

#[test]
fn a_thread_that_does_not_come_back_is_replaced() {
    let folder = tempfile::tempdir().expect("a folder");
    let (service, table) = start_with_table(folder.path());
    let long_ago = Instant::now().checked_sub(Duration::from_secs(60)).expect("a machine that is up for a minute");
    service.core.desk.pretend_to_render(Some(long_ago));
    let scene = Subject::Scene(Box::new(Scene { size: 64, ..Scene::default() }));
    let Ordered::Waiting(wait) = service.picture(Some(table), scene, |_| false).expect("an order") else {
        panic!("it was never rendered")
    };
    let runtime = tokio::runtime::Builder::new_current_thread().enable_time().build().expect("a runtime");
    runtime.block_on(wait.file()).expect("a picture");
    let counts = service.core.desk.counts();
    assert_eq!((counts.done, counts.given_up), (1, 1));
}

#[test]
fn those_who_wait_for_the_same_picture_take_one_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let (service, table) = start_with_table(folder.path());
    service.core.desk.pretend_to_render(Some(Instant::now() + Duration::from_secs(60)));
    let order = |size: u32| {
        let scene = Subject::Scene(Box::new(Scene { size, ..Scene::default() }));
        service.picture(Some(table), scene, |_| false)
    };
    // One is rendered and eight may wait.
    let same: Vec<_> = (0..20).map(|_| order(64)).collect();
    assert!(same.iter().all(Result::is_ok), "{same:?}");
    let others: Vec<_> = (65..72).map(order).collect();
    assert!(others.iter().all(Result::is_ok), "{others:?}");
    assert!(matches!(order(72), Err(PictureError::QueueFull { .. })));
    assert!(order(64).is_ok());

    // All but the last of them go: the picture is still waited for.
    let last = same.into_iter().last();
    assert!(matches!(order(73), Err(PictureError::QueueFull { .. })));
    drop(last);
    assert!(order(74).is_ok());
    // The end of the service waits for a thread that runs.
    service.core.desk.pretend_to_render(None);
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
