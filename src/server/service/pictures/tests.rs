use std::{
    num::NonZeroUsize,
    ops::ControlFlow,
    path::Path,
    sync::Arc,
    time::{Duration, Instant},
};

use tokio::sync::oneshot::error::TryRecvError;

use super::{
    queue::PictureQueue,
    rate::Took,
    rates::RendererKind,
    request::{PictureRequest, Receipt, Reply},
    *,
};
use crate::service::{Config, PictureLimits, Service, ServiceError};
use ltcforge_files::{container, digest::Digest, recipe_document};
use ltcforge_fit::{Plan, assemble, fit_shard};
use ltcforge_view::{
    plots::Plot,
    preview::{Adapter, Mode, Scene},
};

const MINUTE: Duration = Duration::from_secs(60);

/// A service with one blob, which is not a table.
fn start(folder: &Path, time: Duration) -> (Arc<Service>, Digest) {
    let service = Service::open(Config {
        data_dir: folder.to_owned(),
        workers: NonZeroUsize::MIN,
        queue_limit: 1,
        entry_limit: 100,
        job_seconds: 86_400,
        keep_ended: None,
        lease_ttl: Duration::from_secs(60),
        max_attempts: 1,
        adapter: Adapter::Cpu,
        pictures: PictureLimits { time, ..PictureLimits::default() },
        export_bytes: 0,
    });
    let service = service.expect("a service");
    let digest = service.state.tables.store.blobs.put(b"no table").expect("a blob");
    (service, digest)
}

/// A service with a table.
fn start_with_table(folder: &Path, time: Duration) -> (Arc<Service>, Digest) {
    let (service, _) = start(folder, time);
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

fn block_on<T>(future: impl Future<Output = T>) -> T {
    tokio::runtime::Builder::new_current_thread().enable_time().build().expect("a runtime").block_on(future)
}

/// Requests a picture that is not in memory.
fn pending(service: &Service, table: Digest, subject: Subject) -> PendingPicture {
    let reply = service.picture(Some(table), subject, |_| false).expect("a reply");
    let PictureReply::Pending(pending) = reply else { panic!("it was rendered before: {reply:?}") };
    pending
}

/// A reference on so many pixels a side, with so many samples a pixel.
fn reference(size: u32, spp: u32) -> Subject {
    Subject::Scene(Box::new(Scene { mode: Mode::Reference, size, spp, ..Scene::default() }))
}

#[test]
fn no_thread_runs_before_the_first_picture_and_none_is_rendered_twice() {
    let folder = tempfile::tempdir().expect("a folder");
    let (service, table) = start_with_table(folder.path(), MINUTE);
    assert!(!service.state.pictures.queue().thread_runs(), "no picture was requested");
    let scene = || Subject::Scene(Box::new(Scene { size: 64, ..Scene::default() }));
    let request = |is_known: bool| service.picture(Some(table), scene(), |_| is_known).expect("a reply");

    let PictureReply::Pending(pending) = request(false) else { panic!("it was never rendered") };
    let first = block_on(pending.file()).expect("a picture");
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
    let (service, table) = start_with_table(folder.path(), MINUTE);
    let long_ago = Instant::now().checked_sub(Duration::from_secs(60)).expect("a machine that is up for a minute");
    service.state.pictures.queue().simulate_rendering(Some(long_ago));
    let scene = Subject::Scene(Box::new(Scene { size: 64, ..Scene::default() }));
    let PictureReply::Pending(pending) = service.picture(Some(table), scene, |_| false).expect("a reply") else {
        panic!("it was never rendered")
    };
    block_on(pending.file()).expect("a picture");
    let counts = service.state.pictures.counts();
    assert_eq!((counts.done, counts.given_up), (1, 1));
}

#[test]
fn equal_requests_take_one_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let (service, table) = start_with_table(folder.path(), MINUTE);
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
    block_on(pending(service, table, Subject::Plot(Plot::Matrix)).file()).expect_err("no picture")
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
    let (service, digest) = start(folder.path(), MINUTE);
    let error = draw(&service, digest);
    assert!(matches!(error, PictureError::Store(ServiceError::Storage(_))), "{error:?}");
    assert!(error.to_string().contains(&digest.to_string()), "{error}");
}

/// A request for a picture of its own, and what its caller waits for.
fn request(size: u32, limit: Duration) -> (PictureRequest, Receipt) {
    let (reply, receipt) = Reply::new();
    let key = Digest::of(&size.to_le_bytes());
    (PictureRequest { key, table: None, subject: reference(size, 1), limit, replies: vec![reply] }, receipt)
}

#[test]
fn cheap_pictures_are_first_and_the_time_of_each_counts_from_its_start() {
    let queue = PictureQueue::new(Adapter::Cpu, PictureLimits::default());
    let receipts = [300, 100, 200].map(|size| {
        let (request, receipt) = request(size, MINUTE);
        queue.add(request, |_| Ok(())).expect("room");
        (size, receipt)
    });
    let [dear, cheap, middle] = receipts;
    for (size, mut receipt) in [cheap, middle, dear] {
        assert_eq!(receipt.started.try_recv(), Err(TryRecvError::Empty), "{size} has not started");
        let before = Instant::now();
        let (request, deadline) = queue.next(0).expect("a request");
        assert_eq!(request.subject, reference(size, 1));
        assert!(deadline >= before + MINUTE, "{size}");
        assert_eq!(receipt.started.try_recv(), Ok(deadline), "{size}");
    }
}

#[test]
fn a_waiting_picture_is_not_given_up() {
    let folder = tempfile::tempdir().expect("a folder");
    let (service, table) = start(folder.path(), Duration::ZERO);
    let queue = service.state.pictures.queue();
    queue.simulate_rendering(Some(Instant::now() + MINUTE));
    let waiting = pending(&service, table, Subject::Plot(Plot::Matrix));
    block_on(async {
        let mut file = std::pin::pin!(waiting.file());
        let waited = tokio::time::timeout(Duration::ZERO, &mut file).await;
        assert!(waited.is_err(), "its time had not begun: {waited:?}");
        // It starts, and has no time at all.
        let _rendering = queue.next(0).expect("the request");
        let error = file.await.expect_err("no picture");
        assert!(matches!(error, PictureError::TooSlow { .. }), "{error:?}");
    });
    queue.simulate_rendering(None);
}

/// No other request comes that would notice.
#[test]
fn who_waits_behind_a_thread_that_hangs_has_it_replaced() {
    let folder = tempfile::tempdir().expect("a folder");
    let (service, table) = start_with_table(folder.path(), MINUTE);
    let queue = service.state.pictures.queue();
    queue.simulate_rendering(Some(Instant::now() + MINUTE));
    let waiting = pending(&service, table, reference(64, 1));
    queue.simulate_rendering(Instant::now().checked_sub(MINUTE));
    block_on(waiting.file()).expect("a picture");
    let counts = service.state.pictures.counts();
    assert_eq!((counts.done, counts.given_up), (1, 1));
}

#[test]
fn a_picture_that_would_take_too_long_is_refused_at_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let (service, table) = start_with_table(folder.path(), MINUTE);
    let queue = service.state.pictures.queue();
    queue.learn(RendererKind::Cpu, 1e9, Took::Finished(Duration::from_secs(1000)));
    let refused = service.picture(Some(table), reference(2048, 64), |_| false).expect_err("a refusal");
    // 2.7e8 samples of a microsecond.
    let PictureError::TooExpensive { predicted, limit: MINUTE } = refused else { panic!("{refused:?}") };
    assert!((250.0..=270.0).contains(&predicted), "{predicted}");
    let text = refused.to_string();
    assert!(
        text.contains("predicted to take 26") && text.contains("may take 60 s; ") && text.contains("--picture-seconds"),
        "{text}"
    );
    assert!(!queue.thread_runs());
    assert_eq!(service.state.pictures.counts().refused, 1);
    // What the caller has is not rendered, so it is not refused either.
    queue.set_adapter(&"cpu".into());
    let known = service.picture(Some(table), reference(2048, 64), |_| true);
    assert!(matches!(known, Ok(PictureReply::Known { .. })), "{known:?}");
    block_on(pending(&service, table, reference(64, 4)).file()).expect("a small picture");
}

#[test]
fn a_waiting_picture_is_refused_once_it_is_known_to_take_too_long() {
    let folder = tempfile::tempdir().expect("a folder");
    let (service, table) = start_with_table(folder.path(), MINUTE);
    let queue = service.state.pictures.queue();
    queue.simulate_rendering(Some(Instant::now() + MINUTE));
    let dear = pending(&service, table, reference(2048, 64));
    queue.learn(RendererKind::Cpu, 1e9, Took::Finished(Duration::from_secs(1000)));
    queue.simulate_rendering(None);
    let cheap = pending(&service, table, reference(64, 1));
    block_on(cheap.file()).expect("a picture");
    let error = block_on(dear.file()).expect_err("no picture");
    assert!(matches!(error, PictureError::TooExpensive { .. }), "{error:?}");
}

#[test]
fn pictures_that_are_rendered_tell_how_fast_they_are() {
    let folder = tempfile::tempdir().expect("a folder");
    let (service, table) = start_with_table(folder.path(), MINUTE);
    let queue = service.state.pictures.queue();
    // Twelve microseconds a sample, which none takes.
    queue.learn(RendererKind::Cpu, 1e9, Took::Finished(Duration::from_secs(12_000)));
    let predicted = || match service.picture(Some(table), reference(2048, 64), |_| false) {
        Err(PictureError::TooExpensive { predicted, .. }) => predicted,
        other => panic!("{other:?}"),
    };
    let before = predicted();
    block_on(pending(&service, table, reference(256, 64)).file()).expect("a picture");
    let after = predicted();
    assert!(after < 0.97 * before, "{before} {after}");
}

#[test]
fn a_picture_that_was_given_up_is_refused_the_next_time() {
    let folder = tempfile::tempdir().expect("a folder");
    let (service, table) = start_with_table(folder.path(), Duration::from_millis(50));
    // So fast that nothing is refused.
    service.state.pictures.queue().learn(RendererKind::Cpu, 1e30, Took::Finished(Duration::ZERO));
    let error = block_on(pending(&service, table, reference(2048, 256)).file()).expect_err("no picture");
    assert!(matches!(error, PictureError::TooSlow { .. }), "{error:?}");
    // The caller may know before the render thread. It is done when the next picture is.
    let _ = block_on(pending(&service, table, Subject::Plot(Plot::Matrix)).file());
    let refused = service.picture(Some(table), reference(2048, 256), |_| false);
    assert!(matches!(refused, Err(PictureError::TooExpensive { .. })), "{refused:?}");
}

/// Nothing is known of its speed, so it is accepted; the probe before it tells.
#[test]
fn the_first_picture_is_refused_by_what_a_probe_measures() {
    let folder = tempfile::tempdir().expect("a folder");
    // No processor renders the dearest picture, of 1.7e10 samples, in so short a time, and none takes so long for the probe.
    let (service, table) = start_with_table(folder.path(), Duration::from_secs(20));
    let queue = service.state.pictures.queue();
    let dearest = || Subject::Scene(Box::new(Scene { mode: Mode::Strip, size: 2048, spp: 4096, ..Scene::default() }));
    let error = match service.picture(Some(table), dearest(), |_| false) {
        Ok(PictureReply::Pending(pending)) => block_on(pending.file()).expect_err("no picture"),
        other => panic!("{other:?}"),
    };
    assert!(matches!(error, PictureError::TooExpensive { .. }), "{error:?}");
    assert_eq!(queue.adapter().as_deref(), Some("cpu"));
    // From now on it is refused at once.
    let refused = service.picture(Some(table), dearest(), |_| false).expect_err("a refusal");
    let PictureError::TooExpensive { predicted, .. } = refused else { panic!("{refused:?}") };
    assert!(predicted > 20.0, "{predicted}");
    let counts = service.state.pictures.counts();
    assert_eq!((counts.refused, counts.failed, counts.given_up), (2, 0, 0));
}
